// Combines the pixels of two sensors with a common clock into one stream of pairs, cropped to the
// pipeline's size.
//
// Formula   The middle of the sensors' images: columns from floor((SensorWidth - width_i) / 2) on,
//           rows from floor((SensorHeight - height_i) / 2) on; the rest is dropped.
// C++ twin  test/rtl/link/camera_test.cpp
// Schedule  clock 1: both words are present, are as expected, and move; where the next pair is in
//           the window is decided; clock 2: the pair
// Latency   1 clock after fs_camera
// Handshake Streams. Each sensor must give frames of exactly SensorHeight lines of exactly
//           SensorWidth pixels. The first of a pair waits up to MaxSkew clocks for the other.
//           Within a frame both must not stay silent for MaxSilence clocks, as they do when
//           fs_camera has no room for the rest of a frame. Anything else is an error: error_o for a
//           clock, and both are dropped until their frames begin within MaxSkew clocks.
//           The last two pixels of a frame are output only after both sensors' frames have arrived
//           complete and correct. A frame with an error, even one below its last row, is cut.
//           Its missing lines are filled in at once, each with one black pixel with eol, which
//           fs_input pads and flags. This is done long before the sensors' next frame comes;
//           otherwise fs_input would do it while that frame waits, which no FIFO here could hold.
//           At least one pixel of the last line is then missing, so the frame cannot look complete.
// Limits    MaxSkew: less than the time of a line; MaxSilence: more than the blanking of a line.
//           width_i, height_i are read when a frame begins. If they exceed the sensor's, all frames
//           are cut.
module fs_camera_pair #(
  parameter int SensorWidth = 752,
  parameter int SensorHeight = 480,
  parameter int MaxSkew = 128,
  parameter int MaxSilence = 16383
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  // From fs_camera: {left, right}.
  input  logic [1:0]  valid_i,
  output logic [1:0]  ready_o,
  input  logic [1:0]  sof_i,
  input  logic [1:0]  eol_i,
  input  logic [1:0]  eof_i,
  input  logic [15:0] data_i,
  output logic        error_o,
  output logic        frame_o,  // pulse: a frame was complete
  // The pairs.
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o
);
  localparam int SkewBits = $clog2(MaxSkew + 1);
  localparam int SilenceBits = $clog2(MaxSilence + 1);
  if (SensorWidth < 16 || SensorWidth > 2048 || SensorHeight < 1 || SensorHeight > 2048)
    initial $fatal(1, "fs_camera_pair: the sensor is %0d x %0d, allowed: 16 x 1 to 2048 x 2048",
                   SensorWidth, SensorHeight);

  // Position of the next pair, and the window.
  logic synced_q;  // the present words are of one frame, or begin the next
  logic first_q, last_x_q, last_y_q;
  logic [11:0] x_q, y_q;
  // The window: first column and row, and the ones behind the last.
  logic [11:0] left_q, top_q, end_x_q, end_y_q, lines_in_q;
  always_ff @(posedge clk_i) begin
    left_q <= width_i > 12'(SensorWidth) ? '0 : (12'(SensorWidth) - width_i) >> 1;
    top_q <= height_i > 12'(SensorHeight) ? '0 : (12'(SensorHeight) - height_i) >> 1;
    end_x_q <= left_q + width_i;
    end_y_q <= top_q + height_i;
    lines_in_q <= height_i;
  end
  // What the position is compared with, constant within a frame: the column before the left one and
  // so on. No column or row precedes 0; the flags left_is_0_q, top_is_0_q and bottom_is_0_q say so.
  logic [11:0] before_left_q, right_q, before_right_q, near_right_q, before_top_q, bottom_q,
      before_bottom_q, height_q;
  logic left_is_0_q, top_is_0_q, bottom_is_0_q;
  always_ff @(posedge clk_i) begin
    if (first_q) begin
      left_is_0_q <= left_q == '0;
      before_left_q <= left_q - 12'd1;
      right_q <= end_x_q - 12'd1;
      before_right_q <= end_x_q - 12'd2;
      near_right_q <= end_x_q - 12'd3;
      top_is_0_q <= top_q == '0;
      before_top_q <= top_q - 12'd1;
      bottom_q <= end_y_q - 12'd1;
      bottom_is_0_q <= end_y_q == 12'd1;
      before_bottom_q <= end_y_q - 12'd2;
      height_q <= lines_in_q;
    end
  end

  // Classifies the two present words.
  logic room, both, alone, right_words, waited, silent, take, fails, starts;
  logic completes;  // the output is the end of the previous frame
  logic [1:0] begins;
  logic [SkewBits-1:0] skew_q;
  logic [SilenceBits-1:0] silence_q;
  assign room = ~valid_o | ready_i;
  assign both = &valid_i;
  // A line of one pixel does not begin a frame: it would never be taken.
  assign begins = valid_i & sof_i & ~eol_i;
  assign right_words = sof_i == {2{first_q}} & eol_i == {2{last_x_q}} &
                       eof_i == {2{last_x_q & last_y_q}};
  assign alone = synced_q ? ^valid_i : ^begins;
  assign waited = alone & skew_q == SkewBits'(MaxSkew);
  assign silent = silence_q == SilenceBits'(MaxSilence);
  assign take = synced_q & both & right_words & room & ~completes;
  assign fails = synced_q & ((both & ~right_words) | waited | silent);
  assign starts = ~synced_q & (&begins);
  // Out of step, everything but first words of frames is dropped; so is a word that waited too
  // long.
  assign ready_o = (synced_q ? {2{take}} : ~begins) | {2{waited}};
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      synced_q <= 1'b0;
      skew_q <= '0;
      silence_q <= '0;
      error_o <= 1'b0;
    end else begin
      if (fails) synced_q <= 1'b0;
      else if (starts) synced_q <= 1'b1;
      skew_q <= alone & ~waited ? skew_q + 1'b1 : '0;
      silence_q <= synced_q & ~first_q & valid_i == '0 & ~silent ? silence_q + 1'b1 : '0;
      error_o <= fails | waited;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni | fails | starts) begin
      x_q <= '0;
      y_q <= '0;
      first_q <= 1'b1;
      last_x_q <= 1'b0;
      last_y_q <= SensorHeight == 1;
    end else if (take) begin
      x_q <= last_x_q ? '0 : x_q + 12'd1;
      first_q <= last_x_q & last_y_q;
      last_x_q <= x_q == 12'(SensorWidth - 2);
      if (last_x_q) begin
        y_q <= last_y_q ? '0 : y_q + 12'd1;
        last_y_q <= last_y_q ? SensorHeight == 1 : y_q == 12'(SensorHeight - 2);
      end
    end
  end

  // Where the next pair is in the window, decided with the pair before it.
  logic in_columns_q, at_left_q, at_right_q, near_end_q;  // near_end_q: one or no column before the end
  logic in_rows_q, at_top_q, at_bottom_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni | fails | starts | (first_q & ~take)) begin
      in_columns_q <= left_is_0_q;
      at_left_q <= left_is_0_q;
      at_right_q <= 1'b0;
      near_end_q <= 1'b0;
      in_rows_q <= top_is_0_q;
      at_top_q <= top_is_0_q;
      at_bottom_q <= bottom_is_0_q;
    end else if (take) begin
      in_columns_q <= last_x_q ? left_is_0_q : x_q == before_left_q |
                                               (in_columns_q & x_q != right_q);
      at_left_q <= last_x_q ? left_is_0_q : x_q == before_left_q;
      at_right_q <= ~last_x_q & x_q == before_right_q;
      near_end_q <= ~last_x_q & (x_q == before_right_q | x_q == near_right_q);
      if (last_x_q) begin
        in_rows_q <= last_y_q ? top_is_0_q : y_q == before_top_q | (in_rows_q & y_q != bottom_q);
        at_top_q <= last_y_q ? top_is_0_q : y_q == before_top_q;
        at_bottom_q <= last_y_q ? bottom_is_0_q : y_q == before_bottom_q;
      end
    end
  end

  // The window. Its last two pixels are held until the rest of the sensors' frames has arrived.
  logic shown, keeps, corner, kept_q, passes, ends, whole, begins_window, ends_line;
  logic [31:0] kept_data_q;
  assign shown = in_columns_q & in_rows_q;
  assign corner = at_right_q & at_bottom_q;
  assign keeps = shown & at_bottom_q & near_end_q;
  assign passes = take & shown & ~keeps;
  assign ends = take & last_x_q & last_y_q;
  assign whole = ends & (corner | kept_q);
  assign begins_window = at_left_q & at_top_q;
  assign ends_line = at_right_q | last_x_q;

  // End of the frame: the pixels held back, or black pixels in place of lines.
  logic ended_q, black;
  logic [11:0] lines_q;  // lines that have not been output
  logic lines_left_q;    // there are such
  logic [1:0] tail_q;    // held pixels that may be output
  assign black = ended_q & lines_left_q;
  assign completes = black | tail_q != '0;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_o <= 1'b0;
      kept_q <= 1'b0;
      ended_q <= 1'b0;
      lines_q <= '0;
      lines_left_q <= 1'b0;
      tail_q <= '0;
      frame_o <= 1'b0;
    end else begin
      if (room) valid_o <= passes | completes;
      kept_q <= ~fails & ~ends & (kept_q | (take & corner));
      ended_q <= fails | ends | (ended_q & ~take);
      if (whole) begin
        lines_q <= '0;
        lines_left_q <= 1'b0;
      end else if (passes & begins_window) begin
        lines_q <= height_q;
        lines_left_q <= 1'b1;
      end else if ((passes & ends_line) | (black & room)) begin
        lines_q <= lines_q - 12'd1;
        lines_left_q <= lines_q != 12'd1;
      end
      if (whole) tail_q <= 2'd2;
      else if (room & tail_q != '0) tail_q <= tail_q - 2'd1;
      frame_o <= ends;
    end
    if (take & keeps) kept_data_q <= {kept_data_q[15:0], data_i};
    if (room) begin
      sof_o <= passes & begins_window;
      eol_o <= completes ? ~tail_q[1] : ends_line;
      {left_o, right_o} <= tail_q[1] ? kept_data_q[31:16] : tail_q[0] ? kept_data_q[15:0]
                           : black ? '0 : data_i;
    end
  end
endmodule
