// Computes the position of a tap's pixels in their frame.
//
// Formula   eol with every width_i-th pixel from sof on, eof with the last one of row height_i - 1
// Latency   1 clock
// Limits    Frames are whole: the raster of fs_top has no others. width_i is 16 or more, as the
//           values to compare with are registered.
module fs_tap #(
  parameter int Bits = 8
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic [11:0]     width_i,
  input  logic [11:0]     height_i,
  input  logic            valid_i,
  input  logic            sof_i,
  input  logic [Bits-1:0] pixel_i,
  output logic            valid_o,
  output logic            sof_o,
  output logic            eol_o,
  output logic            eof_o,
  output logic [Bits-1:0] pixel_o
);
  logic [11:0] left_q, rows_q, last_x_q;  // pixels left in the row, rows left after it
  logic last_row_q;
  logic eol;
  assign eol = ~sof_i & left_q == 12'd1;
  always_ff @(posedge clk_i) begin
    last_x_q <= width_i - 12'd1;
    valid_o <= rst_ni & valid_i;
    sof_o <= sof_i;
    eol_o <= eol;
    eof_o <= eol & last_row_q;
    pixel_o <= pixel_i;
    last_row_q <= rows_q == '0;
    if (valid_i) begin
      left_q <= sof_i ? last_x_q : eol ? width_i : left_q - 12'd1;
      if (sof_i) rows_q <= height_i - 12'd1;
      else if (eol) rows_q <= rows_q - 12'd1;
    end
  end
endmodule
