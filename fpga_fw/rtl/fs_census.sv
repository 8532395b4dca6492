// Census transform of both rectified images. Computes the bits of the row that enters the
// correlation window and again those of the row that leaves it, so that match needs no memory of
// census bits.
//
// Formula   bit k = 1 iff I(neighbour k) < I(centre); neighbours in raster order, without the
//           centre; 0 for a neighbour outside the image. Full: every neighbour; sparse: those whose
//           row and column offsets are both even.
// C++ twin  census() in src/core/census.cpp
// Schedule  As the paper's Fig. 4: scan-line buffers, then a window of registers. Reach is the
//           largest offset in the pattern. For the pixel (x, y) that comes in:
//             tick 1            its column of taps enters the windows; the entering centre is
//                               (x - Reach, y - Reach), the leaving centre CorrelationWindow rows
//                               above
//             tick 2            comparisons
//           Lines: CorrelationWindow + 2 Reach, 8 + 8 bits wide.
// Latency   LatencyRows, LatencyTicks for the entering bits. The leaving bits that accompany the
//           entering bits of raster row i are those of raster row i - CorrelationWindow.
// Handshake the raster (fs_top).
// Limits    width_i 16 .. MaxWidth.
module fs_census #(
  parameter int MaxWidth = 640,
  parameter int CensusWindow = 11,
  parameter int CorrelationWindow = 15,
  parameter int Full = 0,
  parameter int Copies = 1,  // of the tick: one for lines and positions, then one per window
  localparam int Radius = CensusWindow / 2,
  localparam int Reach = Full != 0 ? Radius : Radius - Radius % 2,
  localparam int Side = Full != 0 ? 2 * Reach + 1 : Reach + 1,  // positions along an axis
  localparam int Bits = Side * Side - 1
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic [Copies-1:0] en_i,
  input  logic [11:0]     width_i,
  input  logic [11:0]     height_i,
  input  logic            valid_i,
  input  logic            sof_i,
  input  logic            sol_i,
  input  logic [7:0]      left_i,
  input  logic [7:0]      right_i,
  output logic            valid_o,
  output logic            sof_o,
  output logic            sol_o,
  output logic [Bits-1:0] enter_left_o,
  output logic [Bits-1:0] enter_right_o,
  output logic [Bits-1:0] leave_left_o,
  output logic [Bits-1:0] leave_right_o
);
  localparam int LatencyRows = Reach;
  localparam int LatencyTicks = Reach + 2;
  localparam int Step = Full != 0 ? 1 : 2;
  localparam int Lines = CorrelationWindow + 2 * Reach;

  if (CensusWindow < 5 || CensusWindow > 11 || CensusWindow % 2 == 0)
    initial $fatal(1, "fs_census: CensusWindow is %0d, allowed: 5, 7, 9, 11", CensusWindow);
  if (CorrelationWindow < 5 || CorrelationWindow > 21 || CorrelationWindow % 2 == 0)
    initial $fatal(1, "fs_census: CorrelationWindow is %0d, allowed: 5, 7, .. 21",
                   CorrelationWindow);

  // Scan-line buffers. Tap k is the pixel k rows above the incoming one: {right, left}.
  logic [16*(Lines+1)-1:0] taps;
  assign taps[15:0] = {right_i, left_i};
  fs_line_delay #(
    .Bits(16 * Lines), .MaxLength(MaxWidth)
  ) u_lines (
    .clk_i, .rst_ni, .en_i(en_i[0]),
    .length_i($clog2(MaxWidth + 1)'(width_i)),
    .data_i(taps[16*Lines-1:0]),
    .data_o(taps[16*(Lines+1)-1:16])
  );

  // Positions of the entering and the leaving centre, two ticks ahead of the windows.
  logic enter_valid, enter_sof, sol, leave_valid, leave_sof, unused_sol;
  fs_raster_delay #(.Rows(Reach), .Ticks(Reach - 1)) u_enter (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o(enter_valid), .sof_o(enter_sof), .sol_o(sol)
  );
  fs_raster_delay #(.Rows(Reach + CorrelationWindow), .Ticks(Reach - 1)) u_leave (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o(leave_valid), .sof_o(leave_sof), .sol_o(unused_sol)
  );
  logic [11:0] x, enter_y, leave_y;
  fs_position u_enter_position (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i(enter_valid), .sof_i(enter_sof), .sol_i(sol),
    .x_o(x), .y_o(enter_y)
  );
  logic [11:0] unused_x;
  fs_position u_leave_position (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i(leave_valid), .sof_i(leave_sof), .sol_i(sol),
    .x_o(unused_x), .y_o(leave_y)
  );

  // One tick ahead: distance from the centres to each edge of the image.
  logic [11:0] x_q, right_q, enter_y_q, enter_below_q, leave_y_q, leave_below_q;
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      x_q <= x;
      right_q <= width_i - 12'd1 - x;
      enter_y_q <= enter_y;
      enter_below_q <= height_i - 12'd1 - enter_y;
      leave_y_q <= leave_y;
      leave_below_q <= height_i - 12'd1 - leave_y;
    end
  end

  // Columns and rows of the windows inside the image; position i has the offset Step i - Reach.
  logic [Side-1:0] columns_q, enter_rows_q, leave_rows_q;
  for (genvar i = 0; i < Side; i++) begin : g_inside
    localparam int Offset = Step * i - Reach;
    localparam logic [11:0] Needed = 12'(Offset < 0 ? -Offset : Offset);
    logic column, enter_row, leave_row;
    if (Offset < 0) begin : g_before
      assign column = x_q >= Needed;
      assign enter_row = enter_y_q >= Needed;
      assign leave_row = leave_y_q >= Needed;
    end else if (Offset > 0) begin : g_behind
      assign column = right_q >= Needed;
      assign enter_row = enter_below_q >= Needed;
      assign leave_row = leave_below_q >= Needed;
    end else begin : g_centre
      assign {column, enter_row, leave_row} = '1;
    end
    always_ff @(posedge clk_i) begin
      if (en_i[0]) begin
        columns_q[i] <= column;
        enter_rows_q[i] <= enter_row;
        leave_rows_q[i] <= leave_row;
      end
    end
  end

  // Columns of taps for the windows; position j, counted from above, has the offset Step j - Reach.
  logic [8*Side-1:0] enter_left, enter_right, leave_left, leave_right;
  for (genvar j = 0; j < Side; j++) begin : g_taps
    localparam int Enter = 2 * Reach - Step * j;
    localparam int Leave = Enter + CorrelationWindow;
    assign enter_left[8*j+:8] = taps[16*Enter+:8];
    assign enter_right[8*j+:8] = taps[16*Enter+8+:8];
    assign leave_left[8*j+:8] = taps[16*Leave+:8];
    assign leave_right[8*j+:8] = taps[16*Leave+8+:8];
  end
  // The lines between the two windows serve only as delay.
  logic unused_taps;
  assign unused_taps = ^{taps, unused_sol, unused_x};

  fs_census_window #(.Side(Side), .Step(Step)) u_enter_left (
    .clk_i, .en_i(en_i[1%Copies]), .taps_i(enter_left), .columns_i(columns_q),
    .rows_i(enter_rows_q), .bits_o(enter_left_o)
  );
  fs_census_window #(.Side(Side), .Step(Step)) u_enter_right (
    .clk_i, .en_i(en_i[2%Copies]), .taps_i(enter_right), .columns_i(columns_q),
    .rows_i(enter_rows_q), .bits_o(enter_right_o)
  );
  fs_census_window #(.Side(Side), .Step(Step)) u_leave_left (
    .clk_i, .en_i(en_i[3%Copies]), .taps_i(leave_left), .columns_i(columns_q),
    .rows_i(leave_rows_q), .bits_o(leave_left_o)
  );
  fs_census_window #(.Side(Side), .Step(Step)) u_leave_right (
    .clk_i, .en_i(en_i[4%Copies]), .taps_i(leave_right), .columns_i(columns_q),
    .rows_i(leave_rows_q), .bits_o(leave_right_o)
  );

  fs_raster_delay #(.Rows(LatencyRows), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o, .sof_o, .sol_o
  );
endmodule
