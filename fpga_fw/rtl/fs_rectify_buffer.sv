// Holds the last LineRows raster rows of one camera; reads a 2 x 2 block of pixels per tick.
//
// Formula   taps (even/odd row, even/odd column) of the 2 x 2 pixels at row row_i of the ring and
//           column column_i; 0 where inside_i says that the tap is outside the raw image
// Schedule  Four banks, by odd and even row and column, so that each of the four pixels is in its
//           own bank. Row pair r of the ring begins at address r * ceil(W / 2):
//             24 row pairs, columns  25 products  26 addresses  27 read  28 register  29 taps
// Latency   6 ticks (from stage 23 to 29); a written pixel can be read in the next tick.
// Limits    An address must not be read in the tick in which it is written, unless inside_i is 0.
//           Bank numbers: 0 even row, even column; 1 even, odd; 2 odd, even; 3 odd, odd.
module fs_rectify_buffer #(
  parameter int MaxWidth = 640,
  parameter int LineRows = 102,
  localparam int HalfWidth = (MaxWidth + 1) / 2,
  localparam int HalfBits = $clog2(HalfWidth + 1),
  localparam int Depth = LineRows / 2 * HalfWidth,
  localparam int BankBits = $clog2(Depth),
  localparam int RingBits = $clog2(LineRows)
) (
  input  logic                clk_i,
  input  logic                en_i,
  input  logic [HalfBits-1:0] half_i,     // ceil(W / 2)
  input  logic [3:0]          write_bank_i,
  input  logic [BankBits-1:0] write_address_i,
  input  logic [7:0]          raw_i,
  input  logic [RingBits-1:0] row_i,      // stage 23
  input  logic [HalfBits:0]   column_i,   // stage 23; -1 is all ones
  input  logic [3:0]          inside_i,   // stage 28
  output logic [31:0]         taps_o      // stage 29
);
  localparam int PairBits = RingBits - 1;
  logic [PairBits-1:0] even_pair_q, odd_pair_q;
  logic [HalfBits-1:0] even_column_q, odd_column_q, even_column_25_q, odd_column_25_q;
  logic [BankBits-1:0] even_row_q, odd_row_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      // The even row below an odd row belongs to the next pair.
      odd_pair_q <= row_i[RingBits-1:1];
      even_pair_q <= row_i == RingBits'(LineRows - 1) ? '0
                     : row_i[RingBits-1:1] + PairBits'(row_i[0]);
      odd_column_q <= column_i[HalfBits:1];
      even_column_q <= column_i[HalfBits:1] + HalfBits'(column_i[0]);
      odd_row_q <= BankBits'(odd_pair_q * half_i);
      even_row_q <= BankBits'(even_pair_q * half_i);
      odd_column_25_q <= odd_column_q;
      even_column_25_q <= even_column_q;
    end
  end

  for (genvar bank = 0; bank < 4; bank++) begin : g_bank
    (* no_rw_check *) logic [7:0] memory[0:Depth-1];
    logic [BankBits-1:0] address_q;
    logic [7:0] read_q, out_q, tap_q;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        address_q <= (bank / 2 == 1 ? odd_row_q : even_row_q)
                     + (bank % 2 == 1 ? BankBits'(odd_column_25_q) : BankBits'(even_column_25_q));
        read_q <= memory[address_q];
        out_q <= read_q;
        tap_q <= inside_i[bank] ? out_q : '0;
      end
    end
    always_ff @(posedge clk_i) begin
      if (en_i && write_bank_i[bank]) memory[write_address_i] <= raw_i;
    end
    assign taps_o[8*bank+:8] = tap_q;
  end
endmodule
