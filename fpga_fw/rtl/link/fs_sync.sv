// Two flip-flops that bring signals from another clock domain.
//
// Formula   q_o = d_i, two clocks later; three for a bit that changes just at the clock edge
// C++ twin  test/rtl/link/fs_sync.sv models such late bits
// Schedule  clock 1: first flip-flop, which may be metastable; clock 2: second one
// Latency   2 to 3 clocks
// Handshake None. Each bit arrives independently: only one bit of a vector may change at a time.
// Limits    d_i must be a flip-flop of its own clock domain: glitches of logic would be sampled.
module fs_sync #(
  parameter int Bits = 1
) (
  input  logic            clk_i,
  input  logic [Bits-1:0] d_i,
  output logic [Bits-1:0] q_o
);
  (* async_reg = "true" *) logic [Bits-1:0] first_q, second_q;
  always_ff @(posedge clk_i) begin
    first_q <= d_i;
    second_q <= first_q;
  end
  assign q_o = second_q;
endmodule
