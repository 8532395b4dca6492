// What the board shows on eight LEDs.
//
//   sw_i   led_o
//   0      [6:0] frames that have come out, in 64s
//          [7]   something is wrong, until the reset: a bit of ERRORS is set (registers.md), a frame
//                came out bad, or a frame did not give the same disparities as the one before it, as
//                it must with a pattern that does not change
//   1..7   a byte of the signature of stage sw_i - 1 (rectify .. spike); which one: fire_i
//
// Schedule  reads in turn ERRORS, the signature of spike, the one to be shown; a read_i that is low
//           costs the turn a clock
// Handshake data_i is there two clocks behind read_i (fs_top). eof_i is a pulse per frame.
module panel (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        read_i,
  output logic [7:0]  address_o,
  input  logic [31:0] data_i,
  input  logic        eof_i,
  input  logic        bad_i,   // with eof_i
  input  logic [2:0]  sw_i,    // these two by hand, not synchronous
  input  logic [1:0]  fire_i,
  output logic [7:0]  led_o
);
  logic [4:0] hand_q, hand_sync_q;
  always_ff @(posedge clk_i) begin
    hand_sync_q <= {fire_i, sw_i};
    hand_q <= hand_sync_q;
  end
  logic [2:0] stage;
  assign stage = hand_q[2:0] - 3'd1;

  logic [2:0] turn_q, asking_q, asked_q;  // ERRORS, spike, to be shown; answers 2 clocks behind
  assign address_o = turn_q[0] ? fs_pkg::RegErrors
                     : turn_q[1] ? fs_pkg::RegSignatureSpike
                     : fs_pkg::RegSignatureRectify + 8'(stage);
  logic error_q;
  logic [31:0] spike_q, before_q;
  logic [7:0] byte_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      turn_q <= 3'b001;
      asking_q <= '0;
      asked_q <= '0;
      error_q <= 1'b0;
    end else begin
      if (read_i) turn_q <= {turn_q[1:0], turn_q[2]};
      asking_q <= read_i ? turn_q : '0;
      asked_q <= asking_q;
      if (asked_q[0]) error_q <= |data_i;
    end
    if (asked_q[1]) spike_q <= data_i;
    if (asked_q[2]) byte_q <= data_i[8*hand_q[4:3]+:8];
  end

  // At the end of a frame spike_q is the signature of this frame or of the one before it.
  logic [12:0] frames_q;
  logic two_q, differs_q, bad_q;
  always_ff @(posedge clk_i) begin
    if (eof_i) before_q <= spike_q;
    if (!rst_ni) begin
      frames_q <= '0;
      two_q <= 1'b0;
      differs_q <= 1'b0;
      bad_q <= 1'b0;
    end else if (eof_i) begin
      frames_q <= frames_q + 13'd1;
      if (frames_q == 13'd1) two_q <= 1'b1;
      if (two_q && spike_q != before_q) differs_q <= 1'b1;
      if (bad_i) bad_q <= 1'b1;
    end
  end

  always_ff @(posedge clk_i) begin
    led_o <= hand_q[2:0] == '0 ? {error_q | bad_q | differs_q, frames_q[12:6]} : byte_q;
  end
endmodule
