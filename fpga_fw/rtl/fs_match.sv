// Matching cost: sums Hamming distances over the correlation window, for all disparities at once.
//
// Formula   h(x, y, d) = popcount(CL(x, y) ^ CR(x - d, y)), half of the bits where x - d < 0
//           S(x, y, d) = sum of h over CorrelationWindow squared, 0 outside the image
// C++ twin  Match in src/core/match.cpp
// Schedule  Each disparity has a lane (fs_match_lane) that never recomputes a window: the running
//           sum of each column gains the row that enters and loses the row that leaves; a running
//           sum along the row gives the window sum. Column sums are kept for a row in block RAM.
//           The ticks below are for up to 30 census bits; with more, everything from tick 4 on is
//           one tick later. Tick 2 pairs the left bits with the right bits of d pixels earlier;
//           then the lane's ticks follow. Signals that all lanes use have a copy for every Group of
//           lanes, so that no flip-flop drives more than that.
//           The column sums start anew when row 0 of a frame enters. By then the window's centre
//           has left the frame before, because there is a gap between frames.
// Latency   LatencyRows, LatencyTicks.
// Handshake the raster (fs_top).
// Limits    width_i >= max(16, CorrelationWindow + 1); at least CorrelationWindow / 2 bubble rows
//           between frames.
module fs_match #(
  parameter int MaxWidth = 640,
  parameter int Disparities = 64,
  parameter int CensusBits = 24,
  parameter int CorrelationWindow = 15,
  parameter int Primitives = 0,  // 0 behavioural, 1 ECP5
  parameter int Copies = 1,      // of the tick: flags, column sums, then one per four lanes
  localparam int SumBits = $clog2(CorrelationWindow * CorrelationWindow * CensusBits + 1)
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  input  logic [Copies-1:0]              en_i,
  input  logic [11:0]                    width_i,
  input  logic                           valid_i,
  input  logic                           sof_i,
  input  logic                           sol_i,
  input  logic [CensusBits-1:0]          enter_left_i,
  input  logic [CensusBits-1:0]          enter_right_i,
  input  logic [CensusBits-1:0]          leave_left_i,
  input  logic [CensusBits-1:0]          leave_right_i,
  output logic                           valid_o,
  output logic                           sof_o,
  output logic                           sol_o,
  output logic [Disparities*SumBits-1:0] sums_o
);
  localparam int Radius = CorrelationWindow / 2;
  localparam int LatencyRows = Radius;
  localparam int Long = CensusBits > 30 ? 1 : 0;  // fs_hamming takes one tick more
  localparam int LatencyTicks = Radius + 9 + Long;
  localparam int Group = 8;
  localparam int Groups = (Disparities + Group - 1) / Group;
  localparam int ColumnBits = $clog2(CorrelationWindow * CensusBits + 1);
  localparam int PlaceBits = $clog2(CorrelationWindow);

  if (Disparities < 16 || Disparities > 128 || Disparities % 4 != 0)
    initial $fatal(1, "fs_match: Disparities is %0d, allowed: 16, 20, .. 128", Disparities);

  // Tick 1: inputs registered. Tick 2: lane d sees the left pixel x and the right pixel x - d.
  logic [2*CensusBits-1:0] left_q, right_q;  // {leave, enter}
  logic sol_1_q;
  logic [2*CensusBits*Disparities-1:0] lane_right_q;
  logic [2*CensusBits*(Disparities+1)-1:0] lane_right;
  logic [Disparities-1:0] seen_q;  // x - d >= 0
  assign lane_right = {lane_right_q, right_q};
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      left_q <= {leave_left_i, enter_left_i};
      right_q <= {leave_right_i, enter_right_i};
      sol_1_q <= sol_i;
      seen_q <= sol_1_q ? Disparities'(1) : Disparities'({seen_q, 1'b1});
    end
  end
  for (genvar d = 0; d < Disparities; d++) begin : g_right
    always_ff @(posedge clk_i) begin
      if (en_i[(2+d/4)%Copies])
        lane_right_q[2*CensusBits*d+:2*CensusBits] <= lane_right[2*CensusBits*d+:2*CensusBits];
    end
  end

  // Tags of the entering row and position of the window's centre, at tick 2.
  logic enter_valid, enter_sof, sol, centre_valid, centre_sof, unused_sol;
  fs_raster_delay #(.Rows(0), .Ticks(1 + Long)) u_enter (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o(enter_valid), .sof_o(enter_sof), .sol_o(sol)
  );
  fs_raster_delay #(.Rows(Radius), .Ticks(1 + Long)) u_centre (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o(centre_valid), .sof_o(centre_sof), .sol_o(unused_sol)
  );
  logic [11:0] x, unused_x, unused_y, centre_y;
  fs_position u_enter_position (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i(enter_valid), .sof_i(enter_sof), .sol_i(sol),
    .x_o(x), .y_o(unused_y)
  );
  fs_position u_centre_position (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i(centre_valid), .sof_i(centre_sof), .sol_i(sol),
    .x_o(unused_x), .y_o(centre_y)
  );
  logic unused;
  assign unused = ^{unused_sol, unused_x, unused_y, lane_right};
  logic enter_valid_q, enter_sof_q, centre_valid_q, sol_q;
  logic [11:0] x_q, centre_y_q, last_x_q;
  always_ff @(posedge clk_i) begin
    last_x_q <= width_i - 12'd1;
    if (en_i[0]) begin
      enter_valid_q <= enter_valid;
      enter_sof_q <= enter_sof;
      centre_valid_q <= centre_valid;
      sol_q <= sol;
      x_q <= x;
      centre_y_q <= centre_y;
    end
  end

  // Row flags, constant over a row: tick 3. The lanes get them at tick 4, row 0 at tick 5.
  logic enters_q;          // a row of a frame enters
  logic leaves_q;          // a row of the frame leaves
  logic row0_q, row0_4_q;  // row 0 of a frame enters
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      enters_q <= enter_valid_q;
      leaves_q <= centre_valid_q & centre_y_q > 12'(Radius);
      if (sol_q) row0_q <= enter_sof_q;
      row0_4_q <= row0_q;
    end
  end

  // Column flags of the running sum along the row: tick 6 (first: 7), in the lanes a tick later.
  // x is the column that enters the sum.
  logic [11:0] x3_q, x4_q, x5_q;
  logic row_end_q, first_q, first_7_q, last_q;
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      x3_q <= x_q;
      x4_q <= x3_q;
      x5_q <= x4_q;
      row_end_q <= x5_q == last_x_q;
      // The centre is x - Radius: the window extends past the left edge, or past the right edge
      // (then x is already in the next row).
      first_q <= x5_q >= 12'(Radius) && x5_q <= 12'(2 * Radius);
      first_7_q <= first_q;
      last_q <= x5_q < 12'(Radius);
    end
  end

  // Per group of lanes: the left bits at tick 2; the flags one tick later than above.
  logic [2*CensusBits*Groups-1:0] group_left_q;
  logic [6*Groups-1:0] group_flags_q;
  logic [PlaceBits*Groups-1:0] group_place_q;  // in the lanes' rings
  for (genvar g = 0; g < Groups; g++) begin : g_group
    // Kept: synthesis would otherwise merge the equal registers.
    (* keep *) always_ff @(posedge clk_i) begin
      if (en_i[(2+g*Group/4)%Copies]) begin
        group_left_q[2*CensusBits*g+:2*CensusBits] <= left_q;
        group_flags_q[6*g+:6] <= {enters_q, leaves_q, row0_4_q, row_end_q, first_7_q, last_q};
      end
    end
    (* keep *) always_ff @(posedge clk_i) begin
      if (!rst_ni) begin
        group_place_q[PlaceBits*g+:PlaceBits] <= '0;
      end else if (en_i[(2+g*Group/4)%Copies]) begin
        group_place_q[PlaceBits*g+:PlaceBits] <=
            group_place_q[PlaceBits*g+:PlaceBits] == PlaceBits'(CorrelationWindow - 1)
                ? '0 : group_place_q[PlaceBits*g+:PlaceBits] + 1'b1;
      end
    end
  end

  logic [Disparities*ColumnBits-1:0] column_new, column_old;
  for (genvar d = 0; d < Disparities; d++) begin : g_lane
    localparam int Left = 2 * CensusBits * (d / Group);
    localparam int Right = 2 * CensusBits * d;
    logic enters, leaves, row0, row_end, first, last;
    assign {enters, leaves, row0, row_end, first, last} = group_flags_q[6*(d/Group)+:6];
    fs_match_lane #(
      .CensusBits(CensusBits), .CorrelationWindow(CorrelationWindow),
      .Primitives(Primitives)
    ) u_lane (
      .clk_i, .en_i(en_i[(2+d/4)%Copies]),
      .enter_left_i(group_left_q[Left+:CensusBits]),
      .enter_right_i(lane_right_q[Right+:CensusBits]),
      .leave_left_i(group_left_q[Left+CensusBits+:CensusBits]),
      .leave_right_i(lane_right_q[Right+CensusBits+:CensusBits]),
      .seen_i(seen_q[d]),
      .enters_i(enters), .leaves_i(leaves), .row0_i(row0),
      .column_old_i(column_old[ColumnBits*d+:ColumnBits]),
      .column_new_o(column_new[ColumnBits*d+:ColumnBits]),
      .place_i(group_place_q[PlaceBits*(d/Group)+:PlaceBits]),
      .row_end_i(row_end), .first_i(first), .last_i(last),
      .sum_o(sums_o[SumBits*d+:SumBits])
    );
  end

  // Delays the sums by a row, minus the tick from reading a sum to writing it.
  fs_line_delay #(
    .Bits(Disparities * ColumnBits), .MaxLength(MaxWidth)
  ) u_columns (
    .clk_i, .rst_ni, .en_i(en_i[1%Copies]),
    .length_i($clog2(MaxWidth + 1)'(width_i - 12'd1)),
    .data_i(column_new),
    .data_o(column_old)
  );

  fs_raster_delay #(.Rows(LatencyRows), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i, .valid_o, .sof_o, .sol_o
  );
endmodule
