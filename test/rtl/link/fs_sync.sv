// Simulates the metastability of fs_sync: each bit that changed since the last clock arrives on
// time or one clock late, at random.
module fs_sync #(
  parameter int Bits = 1
) (
  input  logic            clk_i,
  input  logic [Bits-1:0] d_i,
  output logic [Bits-1:0] q_o
);
  logic [Bits-1:0] before_q, first_q, second_q;
  logic [63:0] random_q = 64'h9E3779B97F4A7C15 ^ 64'(Bits), mixed;
  always_comb begin
    mixed = random_q ^ (random_q << 13);
    mixed = mixed ^ (mixed >> 7);
  end
  always_ff @(posedge clk_i) begin
    random_q <= mixed ^ (mixed << 17);
    before_q <= d_i;
    first_q <= d_i ^ ((d_i ^ before_q) & random_q[40+:Bits]);
    second_q <= first_q;
  end
  assign q_o = second_q;
endmodule
