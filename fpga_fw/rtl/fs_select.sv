// Winner takes all: selects the best disparity of every left and every right pixel, the sums around
// the left winner, and the runner-up's sum.
//
// Formula   dL = the d with the smallest S(x, y, d); v1 its sum; the lowest such d
//           dR = the d with the smallest S(x + d, y, d), x + d < W; the lowest such d
//           v2 = the smallest S(x, y, d), d other than dL-1, dL, dL+1
//           C(k) = S(x, y, dL + k), k = -2..2, k = -2 in the lowest bits; 0 where dL + k is not in
//           0..D-1
// C++ twin  fpga_stereo::select (src/core/select.cpp)
// Schedule  left   ticks 1..6: winner and C (fs_select_left); 5..10: runner-up
//                  (fs_select_runner_up)
//           right  all sums of a right pixel have been compared Disparities - 1 ticks after the
//                  pixel came (fs_select_right); this determines the latency
//           The results of the left pixel therefore wait in two memories of 36-bit words, from
//           tick 6 (winner, four of C, tags) and from tick 10 (v1 = C(0), v2) on.
// Latency   LatencyRows, LatencyTicks.
// Handshake the raster (fs_top).
// Limits    Disparities 16, 20, .. 128. Any width.
module fs_select #(
  parameter int Disparities = 64,
  parameter int SumBits = 13,
  parameter int Copies = 1,  // of the tick: runner-up and memories, right, then left
  localparam int DBits = $clog2(Disparities)
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  input  logic [Copies-1:0]              en_i,
  input  logic                           valid_i,
  input  logic                           sof_i,
  input  logic                           sol_i,
  input  logic [Disparities*SumBits-1:0] sums_i,
  output logic                           valid_o,
  output logic                           sof_o,
  output logic                           sol_o,
  output logic [DBits-1:0]               winner_o,
  output logic [DBits-1:0]               right_winner_o,
  output logic [SumBits-1:0]             winner_sum_o,
  output logic [SumBits-1:0]             runner_up_sum_o,
  output logic [5*SumBits-1:0]           around_o
);
  localparam int LatencyRows = 0;
  localparam int LatencyTicks = Disparities + 1;
  localparam int Segments = (Disparities + 15) / 16;
  localparam int S = SumBits;
  localparam int LeftCopies = Copies > 2 ? Copies - 2 : 1;
  if (Disparities < 16 || Disparities > 128 || Disparities % 4 != 0)
    initial $fatal(1, "fs_select: Disparities is %0d, allowed: 16, 20, .. 128", Disparities);

  // Left: results at tick 6 and tick 10.
  logic [Disparities*S-1:0] sums_q;  // tick 1
  logic [DBits-1:0] winner;
  logic [5*S-1:0] around;
  logic [S-1:0] runner_up_sum;
  logic [4*Segments*S-1:0] quads;
  logic [6*Segments-1:0] below;
  logic [4*Segments-1:0] in_window;
  logic [8*S-1:0] window;
  logic [1:0] window_begin;
  logic low_out, high_out;
  fs_select_left #(.Disparities(Disparities), .SumBits(S), .Copies(LeftCopies)) u_left (
    .clk_i, .en_i(en_i[Copies-1-:LeftCopies]), .sums_i, .sums_o(sums_q),
    .winner_o(winner), .around_o(around),
    .quads_o(quads), .below_o(below), .in_window_o(in_window),
    .window_o(window), .begin_o(window_begin), .low_out_o(low_out), .high_out_o(high_out)
  );
  fs_select_runner_up #(.Segments(Segments), .SumBits(S)) u_runner_up (
    .clk_i, .en_i(en_i[0]), .quads_i(quads), .below_i(below), .in_window_i(in_window),
    .window_i(window), .begin_i(window_begin), .low_out_i(low_out), .high_out_i(high_out),
    .runner_up_sum_o(runner_up_sum)
  );

  // Right: result at tick LatencyTicks.
  fs_select_right #(.Disparities(Disparities), .SumBits(S)) u_right (
    .clk_i, .en_i(en_i[1%Copies]), .begins_i(sol_i), .sums_i(sums_q), .right_winner_o
  );

  // Tick 6.
  logic valid, sof, sol;
  fs_raster_delay #(.Rows(LatencyRows), .Ticks(6)) u_tags (
    .clk_i, .rst_ni, .en_i(en_i[0]), .valid_i, .sof_i, .sol_i,
    .valid_o(valid), .sof_o(sof), .sol_o(sol)
  );
  logic [S-1:0] centre7_q, centre8_q, centre9_q, centre_q;  // C(0) until tick 10
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      centre7_q <= around[2*S+:S];
      centre8_q <= centre7_q;
      centre9_q <= centre8_q;
      centre_q <= centre9_q;
    end
  end

  // The memories. Writes are so far ahead of reads that the output register is loaded in tick
  // LatencyTicks.
  localparam int Ahead6 = LatencyTicks - 6 - 2;
  localparam int Ahead10 = LatencyTicks - 10 - 2;
  localparam int Bits6 = 4 * S + DBits + 3;
  localparam int Bits10 = 2 * S;
  logic [DBits-1:0] read_at_q, write6_at_q, write10_at_q;
  (* no_rw_check *) logic [Bits6-1:0] memory6[0:2**DBits-1];
  (* no_rw_check *) logic [Bits10-1:0] memory10[0:2**DBits-1];
  logic [Bits6-1:0] read6_q;
  logic [Bits10-1:0] read10_q;
  logic filled_q;  // the word read was written after the reset
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      read_at_q <= '0;
      write6_at_q <= DBits'(Ahead6);
      write10_at_q <= DBits'(Ahead10);
      filled_q <= 1'b0;
    end else if (en_i[0]) begin
      read_at_q <= read_at_q + 1'b1;
      write6_at_q <= write6_at_q + 1'b1;
      write10_at_q <= write10_at_q + 1'b1;
      if (read_at_q == DBits'(Ahead6)) filled_q <= 1'b1;
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      memory6[write6_at_q] <= {valid, sof, sol, winner, around[3*S+:2*S], around[0+:2*S]};
      memory10[write10_at_q] <= {runner_up_sum, centre_q};
      read6_q <= memory6[read_at_q];
      read10_q <= memory10[read_at_q];

      {winner_o, around_o[3*S+:2*S], around_o[0+:2*S]} <= read6_q[0+:Bits6-3];
      {runner_up_sum_o, around_o[2*S+:S]} <= read10_q;
    end
    if (!rst_ni || !filled_q) {valid_o, sof_o, sol_o} <= '0;
    else if (en_i[0]) {valid_o, sof_o, sol_o} <= read6_q[Bits6-1-:3];
  end
  assign winner_sum_o = around_o[2*S+:S];
endmodule
