// Finds the right winner: the best disparity of every pixel of the right image, along the diagonals
// of the same sums (Fig. 6 of the paper).
//
// Formula   dR(xr, y) = the d with the smallest S(xr + d, y, d), xr + d < W; the lowest such d
// C++ twin  fpga_stereo::select (src/core/select.cpp), right_winner
// Schedule  A systolic chain: lane d holds the best sum so far of right pixel x - d.
//             tick x:  best(d) = S(x, d) if that is less than best(d - 1), else best(d - 1)
//           Lane 0 takes a new right pixel each tick. In the first ticks of a row, the lanes d > x
//           hold pixels from the end of the previous row. Their search is complete, so they pass
//           unchanged, and rows need no gap between them.
// Latency   sums_i (x, d) are compared at once; right_winner_o belongs to the pixel that was x
//           Disparities ticks ago.
// Handshake begins_i comes one tick before the first sums of a row.
// Limits    none. After a reset, and for bubble rows, the output is arbitrary; its ticks are not
//           valid.
module fs_select_right #(
  parameter int Disparities = 64,
  parameter int SumBits = 13,
  localparam int DBits = $clog2(Disparities)
) (
  input  logic                           clk_i,
  input  logic                           en_i,
  input  logic                           begins_i,
  input  logic [Disparities*SumBits-1:0] sums_i,
  output logic [DBits-1:0]               right_winner_o
);
  // Lanes that this row has reached: d <= x. Synchronous set and reset of flip-flops cost no LUT;
  // they include en_i because they have priority over the clock enable.
  logic [Disparities-1:0] reached_q;
  always_ff @(posedge clk_i) begin
    if (en_i && begins_i) reached_q <= Disparities'(1);
    else if (en_i) reached_q <= {reached_q[Disparities-2:0], 1'b1};
  end

  logic [Disparities*SumBits-1:0] best_q;
  logic [Disparities*DBits-1:0] winner;
  always_ff @(posedge clk_i) begin
    if (en_i) best_q[0+:SumBits] <= sums_i[0+:SumBits];
  end
  assign winner[0+:DBits] = '0;

  for (genvar d = 1; d < Disparities; d++) begin : g_lane
    // Only as many bits as d needs: synthesis would take minutes to find, lane by lane, that the
    // others are 0.
    localparam int LaneBits = $clog2(d + 1);
    logic less, better;
    logic [LaneBits-1:0] winner_q;
    fs_select_less #(.Bits(SumBits)) u_less (
      .a_i(sums_i[d*SumBits+:SumBits]), .b_i(best_q[(d-1)*SumBits+:SumBits]), .less_o(less)
    );
    assign better = reached_q[d] && less;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        best_q[d*SumBits+:SumBits] <= better ? sums_i[d*SumBits+:SumBits]
                                             : best_q[(d-1)*SumBits+:SumBits];
      end
      if (en_i && better) winner_q <= LaneBits'(d);
      else if (en_i) winner_q <= LaneBits'(winner[(d-1)*DBits+:DBits]);
    end
    assign winner[d*DBits+:DBits] = DBits'(winner_q);
  end
  assign right_winner_o = winner[(Disparities-1)*DBits+:DBits];

  logic unused;
  assign unused = reached_q[0] ^ (^best_q[(Disparities-1)*SumBits+:SumBits]);
endmodule
