// Counts the position of a pixel in its row, for one pipeline stage of speckle.
//
// Formula   position x = 3 word + slot, slot 0..2. The code {word, slot} names a pixel of a row
//           everywhere in speckle: three neighbours share a word of a 36-bit block RAM, and the
//           codes with slot 3 are free for verdicts. Codes are only compared for equality.
// Schedule  A counter. first_i is the row start of the previous stage, so that the outputs are
//           registers of their own stage.
// Limits    none: it also counts outside rows, where the outputs are not used.
module fs_speckle_position #(
  parameter int WordBits = 8
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                en_i,
  input  logic                first_i,
  output logic [WordBits-1:0] word_o,
  output logic [1:0]          slot_o,
  output logic                odd_o  // toggles with every row
);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      word_o <= '0;
      slot_o <= '0;
      odd_o <= 1'b0;
    end else if (en_i) begin
      word_o <= first_i ? '0 : slot_o[1] ? word_o + 1'b1 : word_o;
      slot_o <= first_i || slot_o[1] ? 2'd0 : {slot_o[0], ~slot_o[0]};
      odd_o <= odd_o ^ first_i;
    end
  end
endmodule
