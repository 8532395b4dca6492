// Hamming distance of two census vectors.
//
// Formula   count_o = popcount(a_i ^ b_i)
// Schedule  tick 1: popcounts of parts of Part bits; tick 2: their sum.
// Latency   2 ticks.
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
  localparam int Part = 15;
  localparam int Parts = (Bits + Part - 1) / Part;
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

  logic [CountBits-1:0] sum;
  always_comb begin
    sum = '0;
    for (int k = 0; k < Parts; k++) sum = sum + CountBits'(part_q[4*k+:4]);
  end
  always_ff @(posedge clk_i) begin
    if (en_i) count_o <= sum;
  end
endmodule
