// Finds the runner-up: the smallest sum except for the winner and its two neighbours.
//
// Formula   v2 = the smallest S(d), d other than dL-1, dL, dL+1
// C++ twin  fpga_stereo::select (src/core/select.cpp), runner_up_sum
// Schedule  The two quads of the window (fs_select_left) hold dL-2..dL+2, so v2 is the smallest of
//           all other quads and of the five sums of the window that are not exempt:
//
//             dL-2 at    the five
//             0          0 4 5 6 7
//             1          0 1 5 6 7
//             2          0 1 2 6 7
//             3          0 1 2 3 7
//
//           tick 5   others: the smallest quad of each segment, by the comparisons for the winner
//           tick 6   others: its sum                        window: the five
//           tick 7   others: smallest of two segments       window: {0, 1 or 4}, {3 or 6, 7}
//           tick 8   others: of four                        window: both
//           tick 9   others: of eight                       window: with 2 or 5
//           tick 10  the smaller of others and window
//           A quad of the window that is out of range does not count. At least one of the two is in
//           range. Every segment has a quad left, as quads above the range have the largest sum.
// Latency   10 ticks from the sums of match, 6 from the inputs of tick 4.
module fs_select_runner_up #(
  parameter int Segments = 4,
  parameter int SumBits = 13
) (
  input  logic                          clk_i,
  input  logic                          en_i,
  input  logic [4*Segments*SumBits-1:0] quads_i,      // tick 4
  input  logic [6*Segments-1:0]         below_i,      // tick 4
  input  logic [4*Segments-1:0]         in_window_i,  // tick 4
  input  logic [8*SumBits-1:0]          window_i,     // tick 5
  input  logic [1:0]                    begin_i,      // tick 5
  input  logic                          low_out_i,    // tick 5
  input  logic                          high_out_i,   // tick 5
  output logic [SumBits-1:0]            runner_up_sum_o   // tick 10
);
  localparam int S = SumBits;

  // Others, ticks 5 and 6.
  logic [4*Segments*S-1:0] quads5_q;
  logic [Segments*S-1:0] other;
  for (genvar s = 0; s < Segments; s++) begin : g_segment
    logic low, high, half, pick_q, half_q;
    fs_select_order u_order (
      .below_i(below_i[6*s+:6]), .masked_i(in_window_i[4*s+:4]),
      .low_o(low), .high_o(high), .half_o(half)
    );
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        pick_q <= half ? ~high : low;
        half_q <= half;
      end
    end
    fs_select_pick #(.Bits(S)) u_other (
      .near_i(~half_q), .pick_i(pick_q), .far_i(half_q),
      .words_i(quads5_q[4*s*S+:4*S]), .word_o(other[s*S+:S])
    );
  end
  always_ff @(posedge clk_i) if (en_i) quads5_q <= quads_i;

  // Others, ticks 6 to 9: always three levels, for up to eight segments. Node n is the smaller of
  // nodes 2 n and 2 n + 1; nodes 8 to 15 are the segments.
  logic [16*S-1:S] node;
  for (genvar n = 1; n < 16; n++) begin : g_node
    // Leaves below the node. A node without leaves is constant; with one side it passes that side.
    localparam int Leaves = n >= 8 ? 1 : n >= 4 ? 2 : n >= 2 ? 4 : 8;
    localparam int First = n * Leaves - 8;
    localparam int Second = First + Leaves / 2;
    if (First >= Segments) begin : g_none
      assign node[n*S+:S] = '1;
    end else begin : g_some
      logic [S-1:0] sum, sum_q;
      if (Leaves == 1) begin : g_leaf
        assign sum = other[First*S+:S];
      end else if (Second >= Segments) begin : g_pass
        assign sum = node[2*n*S+:S];
      end else begin : g_least
        logic second;
        fs_select_less #(.Bits(S)) u_less (
          .a_i(node[(2*n+1)*S+:S]), .b_i(node[2*n*S+:S]), .less_o(second)
        );
        assign sum = second ? node[(2*n+1)*S+:S] : node[2*n*S+:S];
      end
      always_ff @(posedge clk_i) if (en_i) sum_q <= sum;
      assign node[n*S+:S] = sum_q;
    end
  end

  logic unused;  // nodes without a segment
  assign unused = ^node;

  // Window, tick 6. The five sums: begin_i + 1 of them come from the first quad.
  logic [S-1:0] word0_q, word14_q, word25_q, word36_q, word7_q;
  logic word14_out_q, word36_out_q, low_out_q, high_out_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      word0_q <= window_i[0+:S];
      word14_q <= begin_i == 2'd0 ? window_i[4*S+:S] : window_i[S+:S];
      word25_q <= begin_i[1] ? window_i[2*S+:S] : window_i[5*S+:S];
      word36_q <= begin_i == 2'd3 ? window_i[3*S+:S] : window_i[6*S+:S];
      word7_q <= window_i[7*S+:S];
      low_out_q <= low_out_i;
      high_out_q <= high_out_i;
      // The first quad can be out of range for begin 2 and 3, the second for 0 and 1. Word 2 or 5
      // is out of range whenever either quad is; the other two only in these cases.
      word14_out_q <= high_out_i && begin_i == 2'd0;
      word36_out_q <= low_out_i && begin_i == 2'd3;
    end
  end

  // Window, ticks 7 to 9, and the final comparison.
  logic less_low, less_high, less_half, less_rest, less_end;
  fs_select_less #(.Bits(S)) u_low (.a_i(word14_q), .b_i(word0_q), .less_o(less_low));
  fs_select_less #(.Bits(S)) u_high (.a_i(word36_q), .b_i(word7_q), .less_o(less_high));
  logic [S-1:0] low_q, high_q, half_q, rest7_q, rest8_q, window_q;
  logic low_out7_q, high_out7_q, rest_out8_q;
  fs_select_less #(.Bits(S)) u_half (.a_i(high_q), .b_i(low_q), .less_o(less_half));
  fs_select_less #(.Bits(S)) u_rest (.a_i(rest8_q), .b_i(half_q), .less_o(less_rest));
  fs_select_less #(.Bits(S)) u_end (.a_i(node[S+:S]), .b_i(window_q), .less_o(less_end));
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      low_q <= less_low && !word14_out_q ? word14_q : word0_q;
      high_q <= less_high && !word36_out_q ? word36_q : word7_q;
      rest7_q <= word25_q;
      low_out7_q <= low_out_q;
      high_out7_q <= high_out_q;

      half_q <= (less_half || low_out7_q) && !high_out7_q ? high_q : low_q;
      rest8_q <= rest7_q;
      rest_out8_q <= low_out7_q || high_out7_q;

      window_q <= less_rest && !rest_out8_q ? rest8_q : half_q;

      runner_up_sum_o <= less_end ? node[S+:S] : window_q;
    end
  end
endmodule
