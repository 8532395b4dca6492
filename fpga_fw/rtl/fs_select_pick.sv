// Selects one of four words with two LUT4 per bit; a plain multiplexer takes three. No register.
//
//   near_i  pick_i  far_i   word_o
//   1       0       0       word 0
//   1       1       0       word 1
//   0       1       1       word 2
//   0       0       1       word 3
//   0       0       0       0, so that results can be ORed
module fs_select_pick #(
  parameter int Bits = 13
) (
  input  logic              near_i,
  input  logic              pick_i,
  input  logic              far_i,
  input  logic [4*Bits-1:0] words_i,
  output logic [Bits-1:0]   word_o
);
  // low is word 0 or 1, or, with near_i 0, a mask that selects word 2 or 3.
  logic [Bits-1:0] low, high;
  assign low = near_i ? (pick_i ? words_i[Bits+:Bits] : words_i[0+:Bits]) : {Bits{pick_i}};
  assign high = (low & words_i[2*Bits+:Bits]) | (~low & words_i[3*Bits+:Bits]);
  assign word_o = far_i ? high : low;
endmodule
