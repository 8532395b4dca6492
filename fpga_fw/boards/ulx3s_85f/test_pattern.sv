// A stereo pair without cameras: noise in the right image, and the same noise moved by a disparity in
// the left one; a square in the middle is nearer than the rest. All frames are alike.
//
// Formula   bits      s(n) = s(n - 31) ^ s(n - 28); s(-31) .. s(-1) are Seed, from its highest bit
//           pixel k   of the frame, in raster order: right = s(8 k) .. s(8 k + 7), the first the
//                     highest bit
//           left      right of pixel k - d, 0 if k < d; d = Near where Width / 4 <= x < 3 Width / 4 and
//                     Height / 4 <= y < 3 Height / 4, else Far
// Schedule  clock 1 the place of a pixel, clock 2 the pixel; both move on as a pixel is taken
// Handshake stream (fpga_fw/rtl/fs_stream_fifo.sv).
// Limits    Far and Near 2 to 63. The first d pixels of a left row are the last of the row above.
module test_pattern #(
  parameter int Width = 640,
  parameter int Height = 480,
  parameter int Far = 6,
  parameter int Near = 12,
  parameter logic [30:0] Seed = 31'h2C9F_51B3
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  output logic       valid_o,
  input  logic       ready_i,
  output logic       sof_o,
  output logic       eol_o,
  output logic [7:0] left_o,
  output logic [7:0] right_o
);
  // The place of the next pixel.
  logic [11:0] x_q, y_q;
  logic middle_x_q, middle_y_q;
  logic move, last_x, last_y;
  logic begins_q;  // a frame
  assign move = ~valid_o | ready_i;
  assign last_x = x_q == 12'(Width - 1);
  assign last_y = y_q == 12'(Height - 1);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      x_q <= '0;
      y_q <= '0;
      middle_x_q <= 1'b0;
      middle_y_q <= 1'b0;
      begins_q <= 1'b1;
    end else if (move) begin
      begins_q <= last_x & last_y;
      x_q <= last_x ? '0 : x_q + 12'd1;
      if (x_q == 12'(Width / 4 - 1)) middle_x_q <= 1'b1;
      if (x_q == 12'(3 * Width / 4 - 1)) middle_x_q <= 1'b0;
      if (last_x) begin
        y_q <= last_y ? '0 : y_q + 12'd1;
        if (y_q == 12'(Height / 4 - 1)) middle_y_q <= 1'b1;
        if (y_q == 12'(3 * Height / 4 - 1)) middle_y_q <= 1'b0;
      end
    end
  end

  // The pixel. The last 64 right ones are kept.
  (* ram_style = "distributed" *) logic [7:0] memory[0:63];
  logic [5:0] at_q, at, distance;
  logic many_q;  // 64 pixels of the frame or more
  logic [30:0] bits_q, bits;
  logic [7:0] right;
  assign at = begins_q ? '0 : at_q;
  assign distance = middle_x_q & middle_y_q ? 6'(Near) : 6'(Far);
  assign bits = begins_q ? Seed : bits_q;
  assign right = bits[30:23] ^ bits[27:20];
  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_o <= 1'b0;
    else if (move) valid_o <= 1'b1;
    if (move) begin
      at_q <= at + 6'd1;
      many_q <= ~begins_q & (many_q | (&at));
      bits_q <= {bits[22:0], right};
      memory[at] <= right;
      right_o <= right;
      left_o <= (many_q & ~begins_q) || at >= distance ? memory[at-distance] : '0;
      sof_o <= begins_q;
      eol_o <= last_x;
    end
  end
endmodule
