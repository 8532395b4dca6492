// Stretches a pulse so that an LED shows it.
//
// Formula   seen_o is high for Clocks clocks after the last event_i
module held #(
  parameter int Clocks = 10000000
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic event_i,
  output logic seen_o
);
  localparam int Bits = $clog2(Clocks + 1);
  logic [Bits-1:0] left_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) left_q <= '0;
    else if (event_i) left_q <= Bits'(Clocks);
    else if (seen_o) left_q <= left_q - 1'b1;
  end
  assign seen_o = left_q != '0;
endmodule
