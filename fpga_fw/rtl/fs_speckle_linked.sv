// Decides whether two neighbouring pixels belong to the same region.
//
// Formula   linked = both valid and |a - b| <= range
// C++ twin  connected() in src/core/speckle.cpp
// Schedule  tick 0: difference; tick 1: compared with +range and -range
// Latency   2 ticks.
module fs_speckle_linked #(
  parameter int Bits = 11
) (
  input  logic            clk_i,
  input  logic            en_i,
  input  logic [9:0]      range_i,
  input  logic            valid_i,  // both pixels are valid
  input  logic [Bits-1:0] a_i,
  input  logic [Bits-1:0] b_i,
  output logic            linked_o
);
  localparam int Wide = (Bits > 10 ? Bits : 10) + 2;
  logic [Bits:0] difference_q;
  logic [Wide-1:0] range, difference, above, below;
  logic valid_q;
  assign range = Wide'(range_i);
  assign difference = {{(Wide - Bits - 1) {difference_q[Bits]}}, difference_q};
  assign above = range - difference;  // negative: difference too large
  assign below = range + difference;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      difference_q <= {1'b0, a_i} - {1'b0, b_i};
      valid_q <= valid_i;
      linked_o <= valid_q & ~above[Wide-1] & ~below[Wide-1];
    end
  end
  logic unused;
  assign unused = ^{above[Wide-2:0], below[Wide-2:0]};
endmodule
