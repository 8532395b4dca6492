// Decides which pixels keep their disparity: left-right check and uniqueness check.
//
// Formula   kept = (x - dL >= 0 and |dR(x - dL) - dL| <= disp12_max_diff, or no left_right_check)
//              and (256 v2 > uniqueness v1, or no uniqueness_check)
//           As v2 is an integer, 256 v2 > p is equivalent to v2 > floor(p / 256).
// C++ twin  fpga_stereo::check (src/core/check.cpp)
// Schedule  tick 1   writes dR(x) into a ring of the last right winners; computes the address of
//                    dR(x - dL) and the product uniqueness v1
//           tick 2   reads dR(x - dL); computes its bounds, dL -+ disp12_max_diff; compares v2
//           tick 3   compares dR with the bounds
// Latency   LatencyRows, LatencyTicks.
// Handshake the raster (fs_top).
// Limits    Disparities up to 128, SumBits up to 17 (one 18-bit multiplier).
module fs_check #(
  parameter int Disparities = 64,
  parameter int SumBits = 13,
  localparam int DBits = $clog2(Disparities)
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  input  logic                          en_i,
  input  logic [fs_pkg::ConfigBits-1:0] config_i,
  input  logic                          valid_i,
  input  logic                          sof_i,
  input  logic                          sol_i,
  input  logic [DBits-1:0]              winner_i,
  input  logic [DBits-1:0]              right_winner_i,
  input  logic [SumBits-1:0]            winner_sum_i,
  input  logic [SumBits-1:0]            runner_up_sum_i,
  input  logic [5*SumBits-1:0]          around_i,
  output logic                          valid_o,
  output logic                          sof_o,
  output logic                          sol_o,
  output logic                          kept_o,
  output logic [DBits-1:0]              winner_o,
  output logic [5*SumBits-1:0]          around_o
);
  localparam int LatencyRows = 0;
  localparam int LatencyTicks = 3;
  localparam int FactorBits = $clog2(fs_pkg::UniquenessScale);
  localparam int ProductBits = SumBits + 10;
  if (Disparities < 2 || Disparities > 128 || SumBits > 17)
    initial $fatal(1, "fs_check: Disparities is %0d, SumBits is %0d, allowed: 2 to 128, up to 17",
                   Disparities, SumBits);

  logic left_right_check, uniqueness_check;
  logic [7:0] disp12_max_diff;
  logic [9:0] uniqueness;
  assign left_right_check = config_i[fs_pkg::ConfigFlagsLeftRightCheckLsb];
  assign uniqueness_check = config_i[fs_pkg::ConfigFlagsUniquenessCheckLsb];
  assign disp12_max_diff = config_i[fs_pkg::ConfigDisp12MaxDiffPixelsLsb+:8];
  assign uniqueness = config_i[fs_pkg::ConfigUniquenessFactorLsb+:10];

  fs_raster_delay #(.Rows(LatencyRows), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i, .valid_i, .sof_i, .sol_i, .valid_o, .sof_o, .sol_o
  );

  // Tick 1. The column counter saturates at the largest dL.
  logic [DBits-1:0] at_q, from_q, column, next_column_q;
  logic seen1_q;  // x - dL >= 0
  assign column = sol_i ? '0 : next_column_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) at_q <= '0;
    else if (en_i) at_q <= at_q + 1'b1;
  end

  // Read in tick 2: by then the word for dL = 0 is written, and the oldest is not yet overwritten.
  (* ram_style = "distributed" *) logic [DBits-1:0] right_winners[0:2**DBits-1];
  logic [DBits-1:0] right_winner_q;
  logic [ProductBits-1:0] product_q;
  logic [SumBits-1:0] runner_up_sum_q;
  logic [DBits-1:0] winner1_q, winner2_q;
  logic signed [9:0] highest_q, lowest_q;  // 0 - 255 .. 127 + 255
  logic signed [9:0] below_highest, above_lowest;
  logic seen2_q, unique_q;
  logic [5*SumBits-1:0] around1_q, around2_q;
  assign below_highest = highest_q - 10'(right_winner_q);
  assign above_lowest = 10'(right_winner_q) - lowest_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      right_winners[at_q] <= right_winner_i;
      from_q <= at_q - winner_i;
      next_column_q <= &column ? column : column + 1'b1;
      seen1_q <= winner_i <= column;
      product_q <= ProductBits'(uniqueness) * ProductBits'(winner_sum_i);
      runner_up_sum_q <= runner_up_sum_i;
      winner1_q <= winner_i;
      around1_q <= around_i;

      right_winner_q <= right_winners[from_q];
      seen2_q <= seen1_q;
      highest_q <= 10'(winner1_q) + 10'(disp12_max_diff);
      lowest_q <= 10'(winner1_q) - 10'(disp12_max_diff);
      unique_q <= ProductBits'(runner_up_sum_q) > (product_q >> FactorBits);
      winner2_q <= winner1_q;
      around2_q <= around1_q;

      kept_o <= (!left_right_check || (seen2_q && !below_highest[9] && !above_lowest[9])) &&
                (!uniqueness_check || unique_q);
      winner_o <= winner2_q;
      around_o <= around2_q;
    end
  end

  logic unused;  // only the signs of the differences are used
  assign unused = ^{below_highest[8:0], above_lowest[8:0], config_i};
endmodule
