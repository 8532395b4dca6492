// Refines the disparity to 1/32 px: vertex of the least-squares parabola through five sums.
//
// Formula   num = 2 C(-2) + C(-1) - C(1) - 2 C(2),  den = 2 C(-2) - C(-1) - 2 C(0) - C(1) + 2 C(2)
//           offset = 32 * 7 num / (10 den), rounded half away from zero, clamped to -32..32;
//           0 unless subpixel and 2 <= dL <= Disparities - 3 and den > 0
//           disparity = 32 dL + offset; NoDisparity where not kept. The disparity needs no clamp:
//           where the offset is not 0, dL is more than a pixel away from both ends of the range.
// C++ twin  fpga_stereo::subpixel (src/core/subpixel.cpp)
// Schedule  ticks 1..4   n = 7 |num|, d = 5 den, from sums and differences
//           ticks 5..10  |offset| = floor((32 n + d) / (2 d)), by shift and subtract. Only 6 bits
//                        of the quotient are needed, so the division begins with
//                        r = floor((32 n + d) / 32) = n + floor(d / 32), and the 5 remaining bits
//                        of d follow one by one:
//             tick 6     r >= 2 d: |offset| is 32 or more, and is clamped. Otherwise r < 2 d, and
//                        this holds again after each step:
//             6..10      the next bit of |offset| is r >= d; then r = r - d;
//                        r = 2 r + next bit of d
//           tick 11      disparity
//           Sums are below 2^S, so |num| < 3 * 2^S and den <= 4 * 2^S: n and d have S + 5 bits, r
//           S + 6. No negation is needed: |num| = m + sign, where m is num or its inverse, and
//           7 |num| = (8 m + 7 sign) - m.
// Latency   LatencyRows, LatencyTicks.
// Handshake the raster (fs_top).
module fs_subpixel #(
  parameter int Disparities = 64,
  parameter int SumBits = 13,
  localparam int DBits = $clog2(Disparities)
) (
  input  logic                             clk_i,
  input  logic                             rst_ni,
  input  logic                             en_i,
  input  logic [fs_pkg::ConfigBits-1:0]    config_i,
  input  logic                             valid_i,
  input  logic                             sof_i,
  input  logic                             sol_i,
  input  logic                             kept_i,
  input  logic [DBits-1:0]                 winner_i,
  input  logic [5*SumBits-1:0]             around_i,
  output logic                             valid_o,
  output logic                             sof_o,
  output logic                             sol_o,
  output logic [fs_pkg::DisparityBits-1:0] disparity_o
);
  localparam int LatencyRows = 0;
  localparam int LatencyTicks = 11;
  localparam int S = SumBits;
  localparam int Steps = $clog2(fs_pkg::DisparityScale);
  if (fs_pkg::SubpixelNumerator != 7 || fs_pkg::SubpixelDenominator != 10 || Steps != 5)
    initial $fatal(1, "fs_subpixel: supports only offset = 32 * 7 num / (10 den)");

  logic subpixel;
  assign subpixel = config_i[fs_pkg::ConfigFlagsSubpixelLsb];

  fs_raster_delay #(.Rows(LatencyRows), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i, .valid_i, .sof_i, .sol_i, .valid_o, .sof_o, .sol_o
  );

  // Values that accompany the arithmetic: index k belongs to tick k + 1.
  logic [10*DBits-1:0] winner_q;
  logic [9:0] kept_q;
  logic [2:0] inside_q;    // may be refined, if den > 0
  logic [9:3] refined_q;
  logic [9:2] negative_q;  // num is negative
  logic [9:5] full_q;      // |offset| is clamped

  // Ticks 1 to 4.
  logic signed [S:0] outer_q, inner_q;
  logic signed [S+1:0] bend_q;
  logic signed [S+2:0] num_q, den_q;
  logic [S-1:0] centre_q;
  logic [S:0] outer_sum_q, inner_sum_q, inner_sum2_q;
  logic [S+1:0] m_q;
  logic [S+4:0] n_q, d_q;
  // Ticks 5 to 10: index k is the value before step k.
  logic [S+5:0] first_r_q;
  logic [S+4:0] first_d_q;
  logic [(Steps+1)*(S+6)-1:0] r;
  logic [(Steps+1)*(S+5)-1:0] d;
  logic [Steps-1:0] quotient;

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      winner_q <= {winner_q[0+:9*DBits], winner_i};
      kept_q <= {kept_q[8:0], kept_i};
      inside_q <= {
        inside_q[1:0],
        subpixel && winner_i >= DBits'(2) && winner_i <= DBits'(Disparities - 3)
      };
      negative_q <= {negative_q[8:2], num_q[S+2]};
      refined_q <= {refined_q[8:3], inside_q[2] && !den_q[S+2] && den_q != '0};
      full_q <= {full_q[8:5], first_r_q >= {first_d_q, 1'b0}};

      outer_q <= $signed({1'b0, around_i[0+:S]}) - $signed({1'b0, around_i[4*S+:S]});
      inner_q <= $signed({1'b0, around_i[S+:S]}) - $signed({1'b0, around_i[3*S+:S]});
      outer_sum_q <= {1'b0, around_i[0+:S]} + {1'b0, around_i[4*S+:S]};
      inner_sum_q <= {1'b0, around_i[S+:S]} + {1'b0, around_i[3*S+:S]};
      centre_q <= around_i[2*S+:S];

      num_q <= $signed({outer_q, 1'b0}) + (S + 3)'(inner_q);
      bend_q <= $signed({1'b0, outer_sum_q}) - $signed({2'b0, centre_q});
      inner_sum2_q <= inner_sum_q;

      m_q <= num_q[S+1:0] ^ {(S + 2){num_q[S+2]}};
      den_q <= $signed({bend_q, 1'b0}) - $signed({2'b0, inner_sum2_q});

      n_q <= {m_q, {3{negative_q[2]}}} - (S + 5)'(m_q);
      d_q <= {1'b0, den_q[S+1:0], 2'b0} + (S + 5)'(den_q[S+1:0]);

      first_r_q <= {1'b0, n_q} + (S + 6)'(d_q[S+4:Steps]);
      first_d_q <= d_q;
    end
  end

  assign r[0+:S+6] = first_r_q;
  assign d[0+:S+5] = first_d_q;
  for (genvar k = 0; k < Steps; k++) begin : g_step
    logic [S+6:0] difference;  // negative if r < d
    logic [S+5:0] next_r_q;
    logic [S+4:0] next_d_q;
    logic [Steps-1-k:0] bit_q;  // kept until the last step
    assign difference = {1'b0, r[k*(S+6)+:S+6]} - {2'b0, d[k*(S+5)+:S+5]};
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        next_r_q <= {
          difference[S+6] ? r[k*(S+6)+:S+5] : difference[S+4:0], d[k*(S+5)+Steps-1-k]
        };
        next_d_q <= d[k*(S+5)+:S+5];
        bit_q <= (Steps - k)'({bit_q, ~difference[S+6]});
      end
    end
    assign r[(k+1)*(S+6)+:S+6] = next_r_q;
    assign d[(k+1)*(S+5)+:S+5] = next_d_q;
    assign quotient[Steps-1-k] = bit_q[Steps-1-k];
  end

  // Tick 11. -offset is its inverse plus 1; that 1 comes as the carry out of an extra lowest bit.
  logic [Steps:0] offset;
  logic minus;
  logic [DBits+Steps:0] value;
  assign offset = !refined_q[9] ? '0 : full_q[9] ? (Steps + 1)'(fs_pkg::DisparityScale)
                                                 : {1'b0, quotient};
  assign minus = refined_q[9] & negative_q[9];
  assign value = {winner_q[9*DBits+:DBits], Steps'(0), 1'b1} +
                 {{(DBits - 1){minus}}, offset ^ {(Steps + 1){minus}}, minus};
  always_ff @(posedge clk_i) begin
    if (en_i && !kept_q[9]) disparity_o <= fs_pkg::NoDisparity;
    else if (en_i) disparity_o <= fs_pkg::DisparityBits'(value[DBits+Steps:1]);
  end

  logic unused;  // after the last step, and below the result
  assign unused = ^{r[Steps*(S+6)+:S+6], d[Steps*(S+5)+:S+5], value[0], config_i};
endmodule
