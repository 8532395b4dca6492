// One census window: one column of taps enters per tick, the bits of the centre come out.
//
// Formula   bit k = taps(neighbour k) < taps(centre) and the neighbour is in the image
// Schedule  tick 1: the window shifts by a column; tick 2: comparisons.
// Limits    columns_i and rows_i describe the centre that is in the window after tick 1.
module fs_census_window #(
  parameter int Side = 5,  // positions along an axis
  parameter int Step = 2,  // pixels between positions
  localparam int Bits = Side * Side - 1
) (
  input  logic              clk_i,
  input  logic              en_i,
  input  logic [8*Side-1:0] taps_i,     // top to bottom
  input  logic [Side-1:0]   columns_i,  // inside the image; position 0 is the leftmost
  input  logic [Side-1:0]   rows_i,
  output logic [Bits-1:0]   bits_o
);
  localparam int Columns = Step * (Side - 1) + 1;
  localparam int Column = 8 * Side;

  // Column 0 is the newest and rightmost.
  logic [Column*Columns-1:0] window_q;
  always_ff @(posedge clk_i) begin
    if (en_i) window_q <= (Column * Columns)'({window_q, taps_i});
  end

  logic [7:0] centre;
  assign centre = window_q[Column*(Columns/2)+8*(Side/2)+:8];
  for (genvar j = 0; j < Side; j++) begin : g_row
    for (genvar i = 0; i < Side; i++) begin : g_column
      localparam int Place = j * Side + i;
      localparam int Centre = Side * Side / 2;
      if (Place != Centre) begin : g_bit
        localparam int Bit = Place < Centre ? Place : Place - 1;
        logic [7:0] neighbour;
        assign neighbour = window_q[Column*(Columns-1-Step*i)+8*j+:8];
        always_ff @(posedge clk_i) begin
          if (en_i) bits_o[Bit] <= (neighbour < centre) & columns_i[i] & rows_i[j];
        end
      end
    end
  end
endmodule
