// Compares a < b in one carry chain. The chain is one bit longer than the words, so that the borrow
// leaves it as a sum bit, without another LUT. No register.
module fs_select_less #(
  parameter int Bits = 13
) (
  input  logic [Bits-1:0] a_i,
  input  logic [Bits-1:0] b_i,
  output logic            less_o
);
  logic [Bits:0] difference;
  assign difference = {1'b0, a_i} - {1'b0, b_i};
  assign less_o = difference[Bits];

  logic unused;
  assign unused = ^difference[Bits-1:0];
endmodule
