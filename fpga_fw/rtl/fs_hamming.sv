// Hamming distance of two census vectors.
//
// Formula   count_o = popcount(a_i ^ b_i)
// Schedule  tick 1  popcounts of parts of 15 bits
//           tick 2  sums of two parts each, if there are more than two
//           last    sum of all
// Latency   2 ticks; 3 for more than 30 bits (LongBits).
module fs_hamming #(
  parameter int Bits = 24,
  localparam int CountBits = $clog2(Bits + 1)
) (
  input  logic                 clk_i,
  input  logic                 en_i,
  input  logic [Bits-1:0]      a_i,
  input  logic [Bits-1:0]      b_i,
  output logic [CountBits-1:0] count_o
);
  localparam int LongBits = 30;
  localparam int Part = 15;
  localparam int Pairs = (Bits + 2 * Part - 1) / (2 * Part);
  localparam int Parts = 2 * Pairs;
  logic [Parts*Part-1:0] differ;
  if (Parts * Part > Bits) begin : g_fill
    assign differ[Parts*Part-1:Bits] = '0;
  end
  assign differ[Bits-1:0] = a_i ^ b_i;
  logic [4*Parts-1:0] part_q;
  for (genvar k = 0; k < Parts; k++) begin : g_part
    logic [3:0] count;
    fs_popcount #(.Bits(Part)) u_count (.bits_i(differ[Part*k+:Part]), .count_o(count));
    always_ff @(posedge clk_i) begin
      if (en_i) part_q[4*k+:4] <= count;
    end
  end

  logic [5*Pairs-1:0] pair;
  for (genvar k = 0; k < Pairs; k++) begin : g_pair
    logic [4:0] sum;
    assign sum = 5'(part_q[8*k+:4]) + 5'(part_q[8*k+4+:4]);
    if (Bits > LongBits) begin : g_tick
      always_ff @(posedge clk_i) begin
        if (en_i) pair[5*k+:5] <= sum;
      end
    end else begin : g_same_tick
      assign pair[5*k+:5] = sum;
    end
  end

  logic [CountBits-1:0] sum;
  always_comb begin
    sum = '0;
    for (int k = 0; k < Pairs; k++) sum = sum + CountBits'(pair[5*k+:5]);
  end
  always_ff @(posedge clk_i) begin
    if (en_i) count_o <= sum;
  end
endmodule
