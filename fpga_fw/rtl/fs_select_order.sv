// Finds the smallest of four words that are not masked, given all pairwise comparisons; the first
// one on a tie. No register.
//
//   below_i  {3 < 2, 3 < 1, 2 < 1, 3 < 0, 2 < 0, 1 < 0}
//   masked_i words to ignore; must not be all four
module fs_select_order (
  input  logic [5:0] below_i,
  input  logic [3:0] masked_i,
  output logic       low_o,   // the smaller of words 0 and 1 is word 1
  output logic       high_o,  // the smaller of words 2 and 3 is word 3
  output logic       half_o   // the smallest is word 2 or 3
);
  logic less;  // the smaller of words 2, 3 is less than the smaller of words 0, 1
  assign low_o = masked_i[0] | (below_i[0] & ~masked_i[1]);
  assign high_o = masked_i[2] | (below_i[5] & ~masked_i[3]);
  assign less = high_o ? (low_o ? below_i[4] : below_i[2]) : (low_o ? below_i[3] : below_i[1]);
  assign half_o = &masked_i[1:0] | (less & ~&masked_i[3:2]);
endmodule
