// Two flip-flops that bring signals from another clock.
//
// Formula   q_o = d_i, two clocks later, or three for a bit that changes as the clock comes
// C++ twin  test/rtl/link/fs_sync.sv has such late bits
// Schedule  clock 1 first flip-flop, which may be metastable; clock 2 second one
// Latency   2 to 3 clocks
// Handshake none. Each bit comes on its own: of a vector, one bit at most may change at a time.
// Limits    d_i is a flip-flop of its own clock: what logic makes on its way to its value is seen.
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
