// The parallel port of one image sensor: from its pixel clock to a stream in the core clock domain.
//
// Formula   A pixel is the value of data_i at a rising pixclk_i with frame_valid_i and line_valid_i
//           high. sof marks the first pixel after a clock with frame_valid_i low, eol a pixel that
//           no other follows in the next clock, eof the last pixel before frame_valid_i falls.
// C++ twin  SensorPort in test/rtl/link/sensor_port.hpp, the other end
// Schedule  pixclk 1  the pins' flip-flops
//           pixclk 2  the pixel waits until the next one comes or frame_valid_i falls; the last
//                     pixel of a line therefore waits for the next line
//           pixclk 3  fs_async_fifo; 3 or 4 clocks of clk_i later it is at the output
// Latency   as above
// Handshake Stream (fs_stream_fifo.sv) out. The sensor cannot wait: if a pixel finds no room, it
//           and the rest of its frame are lost. overrun_o: a pulse for each such frame.
// Limits    Depth pixels may come while the stream waits. Nothing is output before the first clock
//           with frame_valid_i low. pixclk_i may stop at any time, clk_i may not.
module fs_camera #(
  parameter int Depth = 64
) (
  // The pins.
  input  logic       pixclk_i,
  input  logic       frame_valid_i,
  input  logic       line_valid_i,
  input  logic [7:0] data_i,
  // The stream.
  input  logic       clk_i,
  input  logic       rst_ni,
  output logic       valid_o,
  input  logic       ready_i,
  output logic       sof_o,
  output logic       eol_o,
  output logic       eof_o,
  output logic [7:0] data_o,
  output logic       overrun_o
);
  logic pixel_rst_n;
  fs_sync u_reset (.clk_i(pixclk_i), .d_i(rst_ni), .q_o(pixel_rst_n));

  // Registers at the pins.
  logic frame_q, pixel_q;
  logic [7:0] data_q;
  always_ff @(posedge pixclk_i) begin
    frame_q <= frame_valid_i;
    pixel_q <= frame_valid_i & line_valid_i;
    data_q <= data_i;
  end

  // The pixel that waits for the next one.
  logic seen_q, first_q;  // frame_valid_i was low; the next pixel is the first of its frame
  logic held_q, held_sof_q, held_eol_q, moves;
  logic [7:0] held_data_q;
  assign moves = pixel_q | ~frame_q;
  always_ff @(posedge pixclk_i) begin
    if (!pixel_rst_n) begin
      seen_q <= 1'b0;
      first_q <= 1'b0;
      held_q <= 1'b0;
    end else begin
      if (!frame_q) seen_q <= 1'b1;
      if (!frame_q) first_q <= 1'b1;
      else if (pixel_q) first_q <= 1'b0;
      if (moves) held_q <= pixel_q & seen_q;
    end
    held_eol_q <= ~pixel_q;
    if (pixel_q) begin
      held_sof_q <= first_q;
      held_data_q <= data_q;
    end
  end

  // Lost pixels. overrun_q is a level that toggles for each such frame, so that it can cross
  // clocks.
  logic room, keeps, lost_q, overrun_q, overrun_seen, overrun_seen_q;
  assign keeps = held_q & moves & (held_sof_q | ~lost_q);
  always_ff @(posedge pixclk_i) begin
    if (!pixel_rst_n) lost_q <= 1'b0;
    else if (keeps) lost_q <= ~room;
    if (pixel_rst_n & keeps & ~room) overrun_q <= ~overrun_q;
  end
  fs_sync u_overrun (.clk_i, .d_i(overrun_q), .q_o(overrun_seen));
  always_ff @(posedge clk_i) begin
    overrun_seen_q <= overrun_seen;
    overrun_o <= rst_ni & (overrun_seen ^ overrun_seen_q);
  end

  fs_async_fifo #(.Bits(11), .Depth(Depth)) u_fifo (
    .wr_clk_i(pixclk_i), .wr_rst_ni(pixel_rst_n), .wr_valid_i(keeps), .wr_ready_o(room),
    .wr_data_i({held_sof_q, held_eol_q | ~frame_q, ~frame_q, held_data_q}), .rd_clk_i(clk_i),
    .rd_rst_ni(rst_ni), .rd_valid_o(valid_o), .rd_ready_i(ready_i),
    .rd_data_o({sof_o, eol_o, eof_o, data_o})
  );
endmodule
