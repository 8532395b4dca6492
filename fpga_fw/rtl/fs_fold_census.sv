// Computes the signature word of census.
//
// Formula   fold(left) ^ rol(fold(right), 16); fold XORs bit k into bit k mod 32
// C++ twin  census_word() in src/core/signature.cpp
// Schedule  tick 1   the word is registered
// Latency   LatencyTicks.
// Handshake raster, without sol at the output.
// Limits    none.
module fs_fold_census #(
  parameter int Bits = 24
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            en_i,
  input  logic            valid_i,
  input  logic            sof_i,
  input  logic [Bits-1:0] left_i,
  input  logic [Bits-1:0] right_i,
  output logic            valid_o,
  output logic            sof_o,
  output logic [31:0]     word_o
);
  localparam int LatencyTicks = 1;
  localparam int Words = (Bits + 31) / 32;
  logic [32*Words-1:0] left, right;
  assign left = (32 * Words)'(left_i);
  assign right = (32 * Words)'(right_i);
  logic [31:0] word;
  always_comb begin
    word = '0;
    for (int i = 0; i < Words; i++)
      word = word ^ left[32*i+:32] ^ {right[32*i+:16], right[32*i+16+:16]};
  end
  always_ff @(posedge clk_i) begin
    if (en_i) word_o <= word;
  end

  logic unused_sol;
  fs_raster_delay #(.Rows(0), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i, .valid_i, .sof_i, .sol_i(sof_i), .valid_o, .sof_o, .sol_o(unused_sol)
  );
endmodule
