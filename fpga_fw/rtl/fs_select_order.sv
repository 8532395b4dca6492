// The least of four words that are not masked, from the comparison of each two; the first of equal
// ones. No register.
//
//   below_i  {3 < 2, 3 < 1, 2 < 1, 3 < 0, 2 < 0, 1 < 0}
//   masked_i words that do not count; not all four
module fs_select_order (
  input  logic [5:0] below_i,
  input  logic [3:0] masked_i,
  output logic       low_o,   // of words 0 and 1, the less is 1
  output logic       high_o,  // of words 2 and 3, the less is 3
  output logic       half_o   // the least is of words 2 and 3
);
  logic less;  // the less of words 2 and 3 is less than that of words 0 and 1
  assign low_o = masked_i[0] | (below_i[0] & ~masked_i[1]);
  assign high_o = masked_i[2] | (below_i[5] & ~masked_i[3]);
  assign less = high_o ? (low_o ? below_i[4] : below_i[2]) : (low_o ? below_i[3] : below_i[1]);
  assign half_o = &masked_i[1:0] | (less & ~&masked_i[3:2]);
endmodule
