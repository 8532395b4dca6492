// Delays words of Bits bits by length_i ticks in block RAM. length_i is the length of a row minus
// the ticks of the user's own registers.
//
// Formula   data_o(t) = data_i(t - length_i)
// Schedule  Each memory port reads the oldest word of its ring and writes the newest in its place;
//           one register follows the memory. The three users of a pair of block RAMs:
//
//             RAM 0:  port a: lane 0, whole      port b: lane 2, first half
//             RAM 1:  port a: lane 1, whole      port b: lane 2, second half
//
//           A block RAM of 1024 x 18 holds one row of 640 words and more than half of another. The
//           two halves of the third row are two delays in series. So three lanes of 18 bits take
//           two block RAMs instead of three (2048 x 9: rows of up to 1365 words).
// Latency   length_i ticks.
// Limits    6 <= length_i <= MaxLength. The output of the first length_i ticks is undefined.
//           length_i must be constant; after a change wait for length_i ticks.
module fs_line_delay #(
  parameter int Bits = 18,
  parameter int MaxLength = 640
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  input  logic                           en_i,
  input  logic [$clog2(MaxLength+1)-1:0] length_i,
  input  logic [Bits-1:0]                data_i,
  output logic [Bits-1:0]                data_o
);
  // The widest word of an 18-kbit dual-port block RAM that is deep enough.
  localparam int Depth = MaxLength <= 1024 ? 1024 : 2048;
  localparam int Word = MaxLength <= 1024 ? 18 : 9;
  localparam int Lanes = (Bits + Word - 1) / Word;
  localparam bit Packs = MaxLength + (MaxLength + 1) / 2 <= Depth;
  localparam int Triples = Packs ? Lanes / 3 : 0;
  localparam int Singles = Lanes - 3 * Triples;
  localparam int Half = (MaxLength + 1) / 2;  // words of a split lane
  localparam int AddressBits = $clog2(Depth);
  if (MaxLength > 2048 || MaxLength < 6)
    initial $fatal(1, "fs_line_delay: MaxLength is %0d, allowed: 6 to 2048", MaxLength);

  // Positions of the rings. A ring of n words with its read register and output register delays by
  // n + 2 ticks.
  logic [AddressBits-1:0] whole_q, first_q, second_q;
  logic [AddressBits-1:0] whole_last, first_last, second_last;
  logic [AddressBits-1:0] length;
  assign length = AddressBits'(length_i);
  always_ff @(posedge clk_i) begin
    whole_last <= length - AddressBits'(3);
    first_last <= AddressBits'(length >> 1) - AddressBits'(3);
    second_last <= length - AddressBits'(length >> 1) - AddressBits'(3);
    if (!rst_ni) begin
      whole_q <= '0;
      first_q <= '0;
      second_q <= '0;
    end else if (en_i) begin
      whole_q <= whole_q == whole_last ? '0 : whole_q + 1'b1;
      first_q <= first_q == first_last ? '0 : first_q + 1'b1;
      second_q <= second_q == second_last ? '0 : second_q + 1'b1;
    end
  end

  logic [Lanes*Word-1:0] data_in, data_out;
  assign data_in = (Lanes * Word)'(data_i);
  assign data_o = data_out[Bits-1:0];
  if (Lanes * Word > Bits) begin : g_unused
    logic unused;
    assign unused = ^data_out[Lanes*Word-1:Bits];
  end

  for (genvar k = 0; k < Triples; k++) begin : g_triple
    localparam int Base = 3 * Word * k;
    logic [Word-1:0] between;
    fs_line_delay_pair #(
      .Word(Word), .Depth(Depth), .SplitBase(Depth - Half)
    ) u_first (
      .clk_i, .en_i,
      .a_position_i(whole_q), .a_i(data_in[Base+:Word]), .a_o(data_out[Base+:Word]),
      .b_position_i(first_q), .b_i(data_in[Base+2*Word+:Word]), .b_o(between)
    );
    fs_line_delay_pair #(
      .Word(Word), .Depth(Depth), .SplitBase(Depth - Half)
    ) u_second (
      .clk_i, .en_i,
      .a_position_i(whole_q), .a_i(data_in[Base+Word+:Word]), .a_o(data_out[Base+Word+:Word]),
      .b_position_i(second_q), .b_i(between), .b_o(data_out[Base+2*Word+:Word])
    );
  end

  for (genvar k = 0; k < Singles; k++) begin : g_single
    localparam int Base = Word * (3 * Triples + k);
    logic [Word-1:0] read_q, out_q;
    (* no_rw_check *) logic [Word-1:0] memory[0:Depth-1];
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        read_q <= memory[whole_q];
        memory[whole_q] <= data_in[Base+:Word];
        out_q <= read_q;
      end
    end
    assign data_out[Base+:Word] = out_q;
  end

  // Nothing uses the positions of the halves if no lanes are packed.
  if (Triples == 0) begin : g_no_halves
    logic unused;
    assign unused = ^{first_q, second_q};
  end
endmodule
