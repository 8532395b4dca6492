// Computes the position within the frame of the tick whose tags are at the inputs.
//
// Formula   x = ticks since sol, y = rows since sof (constant during bubble rows)
// Latency   none: x_o, y_o belong to the tick whose tags are at the inputs.
module fs_position (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        en_i,
  input  logic        valid_i,
  input  logic        sof_i,
  input  logic        sol_i,
  output logic [11:0] x_o,
  output logic [11:0] y_o
);
  logic [11:0] next_x_q, y_q;
  assign x_o = sol_i ? '0 : next_x_q;
  assign y_o = sof_i ? '0 : (sol_i & valid_i) ? y_q + 12'd1 : y_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      next_x_q <= '0;
      y_q <= '0;
    end else if (en_i) begin
      next_x_q <= x_o + 12'd1;
      y_q <= y_o;
    end
  end
endmodule
