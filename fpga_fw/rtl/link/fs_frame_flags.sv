// Collects flags of the frames in flight, per frame.
//
// Formula   flag f of frame n is set if told_i[f] was high between the began_i of frame n and the
//           next one.
// C++ twin  none
// Schedule  The flags of the newest frame are registers; those of older frames are in a small
//           memory.
// Latency   2 clocks from number_i, and from told_i, to flags_o.
// Limits    MaxFrames as in fs_input.
module fs_frame_flags #(
  parameter int MaxFrames = 64,
  parameter int Flags = 2,
  parameter int Readers = 5,
  localparam int FrameBits = $clog2(MaxFrames)
) (
  input  logic                         clk_i,
  input  logic                         rst_ni,
  input  logic                         began_i,
  input  logic [Flags-1:0]             told_i,
  input  logic [Readers*FrameBits-1:0] number_i,
  output logic [Readers*Flags-1:0]     flags_o
);
  logic [FrameBits-1:0] newest_q;
  logic [Flags-1:0] newest_flags_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      newest_q <= '1;
      newest_flags_q <= '0;
    end else begin
      if (began_i) newest_q <= newest_q + 1'b1;
      newest_flags_q <= told_i | (newest_flags_q & {Flags{~began_i}});
    end
  end
  for (genvar k = 0; k < Readers; k++) begin : g_reader
    (* ram_style = "distributed" *) logic [Flags-1:0] older[0:MaxFrames-1];
    logic was_newest_q;
    logic [Flags-1:0] was_flags_q, was_older_q;
    always_ff @(posedge clk_i) begin
      if (began_i) older[newest_q] <= newest_flags_q;
      was_newest_q <= number_i[FrameBits*k+:FrameBits] == newest_q;
      was_flags_q <= newest_flags_q;
      was_older_q <= older[number_i[FrameBits*k+:FrameBits]];
      flags_o[Flags*k+:Flags] <= was_newest_q ? was_flags_q : was_older_q;
    end
  end
endmodule
