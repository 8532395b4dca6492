// Distributes the tick to the registers of all stages. One flip-flop cannot drive tens of thousands
// across a chip within a clock, so each group of registers has its own copy. The raster and the
// reset of the stages are delayed by the same number of clocks.
//
// Schedule  clock 1  one copy per eight groups
//           clock 2  one copy per group, copies of the reset, and the raster's registers
// Latency   2 clocks, not ticks: when the input reads that there is room, as many further ticks are
//           already on their way (EnableClocks of fs_output).
module fs_enable #(
  parameter int Copies = 1,  // copies of the tick
  parameter int Resets = 1   // copies of the reset
) (
  input  logic              clk_i,
  input  logic              rst_ni,
  input  logic              stage_rst_ni,
  input  logic              en_i,
  input  logic              valid_i,
  input  logic              sof_i,
  input  logic              sol_i,
  input  logic [7:0]        left_i,
  input  logic [7:0]        right_i,
  output logic [Resets-1:0] stage_rst_no,
  output logic [Copies-1:0] en_o,
  output logic              valid_o,
  output logic              sof_o,
  output logic              sol_o,
  output logic [7:0]        left_o,
  output logic [7:0]        right_o
);
  localparam int Each = 8;
  localparam int Firsts = (Copies + Each - 1) / Each;

  // Kept: synthesis would otherwise merge the equal registers.
  logic [Firsts-1:0] first_q;
  for (genvar k = 0; k < Firsts; k++) begin : g_first
    (* keep *) always_ff @(posedge clk_i) first_q[k] <= en_i;
  end
  for (genvar k = 0; k < Copies; k++) begin : g_copy
    (* keep *) always_ff @(posedge clk_i) en_o[k] <= first_q[k/Each];
  end

  // rst_ni resets the stages without the extra clock: nothing may leave them after it.
  logic rst_nq;
  always_ff @(posedge clk_i) rst_nq <= rst_ni & stage_rst_ni;
  for (genvar k = 0; k < Resets; k++) begin : g_reset
    (* keep *) always_ff @(posedge clk_i) stage_rst_no[k] <= rst_ni & rst_nq;
  end

  logic [18:0] raster_q;
  always_ff @(posedge clk_i) begin
    raster_q <= {valid_i, sof_i, sol_i, left_i, right_i};
    {valid_o, sof_o, sol_o, left_o, right_o} <= raster_q;
  end
endmodule
