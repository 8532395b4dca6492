// Delays the tags of the raster (valid, sof, sol) by Rows rows and Ticks ticks.
//
// Formula   tags_o(t) = tags_i(t - Rows * width - Ticks)
// Schedule  A shift register with one valid and one sof bit per row moves at each sol. sol itself
//           repeats every row, so it needs no delay by rows. The delay by ticks is a plain shift
//           register.
// Latency   Rows rows and Ticks ticks; Ticks >= 1.
// Limits    Rows come without gaps from the first sol on (the raster, see fs_top).
module fs_raster_delay #(
  parameter int Rows = 1,
  parameter int Ticks = 1
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic en_i,
  input  logic valid_i,
  input  logic sof_i,
  input  logic sol_i,
  output logic valid_o,
  output logic sof_o,
  output logic sol_o
);
  if (Ticks < 1) initial $fatal(1, "fs_raster_delay: Ticks is %0d, allowed: 1 or more", Ticks);

  // Row tags: bit k is the row that came k rows ago, bit 0 the row of this tick.
  logic [Rows:0] valid_rows, sof_rows;
  if (Rows > 0) begin : g_rows
    logic [Rows:0] valid_q, sof_q;
    assign valid_rows = sol_i ? {valid_q[Rows-1:0], valid_i} : valid_q;
    assign sof_rows = sol_i ? {sof_q[Rows-1:0], sof_i} : sof_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni) begin
        valid_q <= '0;
        sof_q <= '0;
      end else if (en_i) begin
        valid_q <= valid_rows;
        sof_q <= sof_rows;
      end
    end
  end else begin : g_no_rows
    assign valid_rows = valid_i;
    assign sof_rows = sof_i;
  end

  logic [Ticks-1:0] valid_ticks_q, sof_ticks_q, sol_ticks_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_ticks_q <= '0;
      sof_ticks_q <= '0;
      sol_ticks_q <= '0;
    end else if (en_i) begin
      valid_ticks_q <= Ticks'({valid_ticks_q, valid_rows[Rows]});
      sof_ticks_q <= Ticks'({sof_ticks_q, sol_i & sof_rows[Rows]});
      sol_ticks_q <= Ticks'({sol_ticks_q, sol_i});
    end
  end
  assign valid_o = valid_ticks_q[Ticks-1];
  assign sof_o = sof_ticks_q[Ticks-1];
  assign sol_o = sol_ticks_q[Ticks-1];
endmodule
