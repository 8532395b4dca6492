// Computes the signature word of match.
//
// Formula   XOR over d of rol(S(d), d mod 32)
// C++ twin  match_word() in src/core/signature.cpp
// Schedule  tick 1   XOR over each 32 disparities: each bit then has SumBits inputs
//           tick 2   XOR of those words
// Latency   LatencyTicks.
// Handshake raster, without sol at the output.
// Limits    SumBits 1 to 32.
module fs_fold_match #(
  parameter int Disparities = 64,
  parameter int SumBits = 13
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  input  logic                           en_i,
  input  logic                           valid_i,
  input  logic                           sof_i,
  input  logic [Disparities*SumBits-1:0] sums_i,
  output logic                           valid_o,
  output logic                           sof_o,
  output logic [31:0]                    word_o
);
  localparam int LatencyTicks = 2;
  localparam int Groups = (Disparities + 31) / 32;
  if (SumBits < 1 || SumBits > 32)
    initial $fatal(1, "fs_fold_match: SumBits is %0d, allowed: 1 to 32", SumBits);

  logic [32*Groups-1:0] groups, groups_q;
  logic [31:0] word;
  always_comb begin
    groups = '0;
    for (int d = 0; d < Disparities; d++)
      for (int k = 0; k < SumBits; k++)
        groups[d/32*32+(d+k)%32] = groups[d/32*32+(d+k)%32] ^ sums_i[d*SumBits+k];
    word = '0;
    for (int i = 0; i < Groups; i++) word = word ^ groups_q[32*i+:32];
  end

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      groups_q <= groups;
      word_o <= word;
    end
  end

  logic unused_sol;
  fs_raster_delay #(.Rows(0), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i, .valid_i, .sof_i, .sol_i(sof_i), .valid_o, .sof_o, .sol_o(unused_sol)
  );
endmodule
