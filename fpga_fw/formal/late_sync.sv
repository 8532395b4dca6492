// Formal: replaces fs_sync for two clocks, in the steps of async_fifo.sv. A bit that changes in the
// step in which the clock rises is seen with its old or its new value; each bit independently.
module fs_sync #(
  parameter int Bits = 1
) (
  input  logic            clk_i,
  input  logic [Bits-1:0] d_i,
  output logic [Bits-1:0] q_o
);
  (* anyseq *) logic [Bits-1:0] late;
  logic [Bits-1:0] first, second, first_q, second_q, d_q;
  logic clk_q, rise;
  assign rise = clk_i & ~clk_q;
  assign first = rise ? (late & d_q) | (~late & d_i) : first_q;
  assign second = rise ? first_q : second_q;
  assign q_o = second;
  // Clocked in every step, whatever the clock does: clk2fflogic does not transform this module.
  always_ff @(posedge clk_i) begin
    clk_q <= clk_i;
    d_q <= d_i;
    first_q <= first;
    second_q <= second;
  end
endmodule
