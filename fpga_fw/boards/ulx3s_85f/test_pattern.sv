// Generates a stereo pair without cameras: noise in the right image, and the same noise shifted by
// a disparity in the left image. A square in the middle is nearer than the rest. All frames are
// equal.
//
// Formula   bits      s(n) = s(n - 31) ^ s(n - 28); s(-31) .. s(-1) are Seed, from its highest
//                     bit
//           pixel k   of the frame, in raster order: right = s(8 k) .. s(8 k + 7), the highest bit
//                     first
//           left      right of pixel k - d, 0 if k < d; d = Near where W4 <= x < 3 W4 and
//                     H4 <= y < 3 H4 with W4 = floor(W / 4), H4 = floor(H / 4), else Far
// Schedule  step 1: position of a pixel; step 2: its right value, and where the left one is in the
//           memory; step 3: the pixel. All advance when a pixel is taken, but at most rate_i times a
//           second.
// Handshake stream (fpga_fw/rtl/fs_stream_fifo.sv).
// Limits    Far and Near 2 to 63; width_i, W, 16 to 1280; height_i, H, 4 or more: smaller images
//           have no square. A frame during which they change has neither size. The first d pixels
//           of a left row are the last of the row above.
module test_pattern #(
  parameter int ClockHz = 100000000,
  parameter int RateBits = $clog2(ClockHz + 1),
  parameter int Far = 6,
  parameter int Near = 12,
  parameter logic [30:0] Seed = 31'h2C9F_51B3
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [RateBits-1:0] rate_i,  // pixels a second, up to ClockHz
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o
);
  // Position of the next pixel.
  logic [11:0] x_q, y_q;
  logic middle_x_q, middle_y_q;
  logic move, last_x_q, last_y_q;
  logic begins_q;  // the next pixel is the first of a frame
  logic tick;
  fs_baud #(.ClockHz(ClockHz), .StepBits(RateBits)) u_rate (
    .clk_i, .restart_i(~rst_ni), .step_i(rate_i), .tick_o(tick)
  );
  assign move = (~valid_o | ready_i) & tick;
  // Registered, because they are constant: the last column and the one before it; the columns before
  // the square and before its end. Rows likewise.
  logic [11:0] last_column_q, before_last_column_q, last_row_q, before_last_row_q;
  logic [9:0] width_4_q, height_4_q;
  logic [11:0] before_near_x_q, before_far_x_q, before_near_y_q, before_far_y_q;
  always_ff @(posedge clk_i) begin
    last_column_q <= width_i - 12'd1;
    before_last_column_q <= width_i - 12'd2;
    last_row_q <= height_i - 12'd1;
    before_last_row_q <= height_i - 12'd2;
    width_4_q <= width_i[11:2];
    height_4_q <= height_i[11:2];
    before_near_x_q <= 12'(width_4_q) - 12'd1;
    before_far_x_q <= 12'(width_4_q) + {1'b0, width_4_q, 1'b0} - 12'd1;
    before_near_y_q <= 12'(height_4_q) - 12'd1;
    before_far_y_q <= 12'(height_4_q) + {1'b0, height_4_q, 1'b0} - 12'd1;
  end
  always_ff @(posedge clk_i) begin
    // >= instead of ==, because the size may have shrunk.
    last_x_q <= move ? ~last_x_q & x_q >= before_last_column_q : x_q >= last_column_q;
    last_y_q <= move & last_x_q ? ~last_y_q & y_q >= before_last_row_q : y_q >= last_row_q;
    if (!rst_ni) begin
      x_q <= '0;
      y_q <= '0;
      last_x_q <= 1'b0;
      last_y_q <= 1'b0;
      middle_x_q <= 1'b0;
      middle_y_q <= 1'b0;
      begins_q <= 1'b1;
    end else if (move) begin
      begins_q <= last_x_q & last_y_q;
      x_q <= last_x_q ? '0 : x_q + 12'd1;
      if (x_q == before_near_x_q) middle_x_q <= 1'b1;
      if (last_x_q | x_q == before_far_x_q) middle_x_q <= 1'b0;
      if (last_x_q) begin
        y_q <= last_y_q ? '0 : y_q + 12'd1;
        if (y_q == before_near_y_q) middle_y_q <= 1'b1;
        if (last_y_q | y_q == before_far_y_q) middle_y_q <= 1'b0;
      end
    end
  end

  // The pixel. The memory holds the last 64 pixels of the right image.
  (* ram_style = "distributed" *) logic [7:0] memory[0:63];
  logic [5:0] at_q, at, distance, from_q;
  logic many_q;  // 64 or more pixels of the frame have passed
  logic valid_q, inside_q, sof_q, eol_q;  // step 2; inside_q: the left pixel is in the frame
  logic [30:0] bits_q, bits;
  logic [7:0] right, right_q;
  assign at = begins_q ? '0 : at_q;
  assign distance = middle_x_q & middle_y_q ? 6'(Near) : 6'(Far);
  assign bits = begins_q ? Seed : bits_q;
  assign right = bits[30:23] ^ bits[27:20];
  always_ff @(posedge clk_i) begin
    if (!rst_ni) valid_o <= 1'b0;
    else if (move) valid_o <= valid_q;
    else if (ready_i) valid_o <= 1'b0;
    if (!rst_ni) valid_q <= 1'b0;
    else if (move) valid_q <= 1'b1;
    if (move) begin
      at_q <= at + 6'd1;
      many_q <= ~begins_q & (many_q | (&at));
      bits_q <= {bits[22:0], right};
      memory[at] <= right;
      right_q <= right;
      from_q <= at - distance;
      inside_q <= (many_q & ~begins_q) || at >= distance;
      sof_q <= begins_q;
      eol_q <= last_x_q;
      // The oldest place is overwritten by the pixel behind, in this step.
      right_o <= right_q;
      left_o <= inside_q ? memory[from_q] : '0;
      sof_o <= sof_q;
      eol_o <= eol_q;
    end
  end
endmodule
