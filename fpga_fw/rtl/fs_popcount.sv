// Counts the bits set in a vector with a tree of full adders: two halves, and one bit as carry in.
//
// Formula   count_o = popcount(bits_i)
// Latency   none.
module fs_popcount #(
  parameter int Bits = 15,
  localparam int CountBits = $clog2(Bits + 1)
) (
  input  logic [Bits-1:0]      bits_i,
  output logic [CountBits-1:0] count_o
);
  if (Bits == 1) begin : g_one
    assign count_o = bits_i;
  end else if (Bits == 2) begin : g_two
    assign count_o = {&bits_i, ^bits_i};
  end else begin : g_many
    localparam int High = (Bits - 1) / 2;
    localparam int Low = Bits - 1 - High;
    logic [$clog2(Low+1)-1:0] low;
    logic [$clog2(High+1)-1:0] high;
    fs_popcount #(.Bits(Low)) u_low (.bits_i(bits_i[Low-1:0]), .count_o(low));
    fs_popcount #(.Bits(High)) u_high (.bits_i(bits_i[Low+High-1:Low]), .count_o(high));
    // Written out so that it maps to LUTs and not to a carry chain of two bits.
    logic [CountBits-1:0] a, b;
    assign a = CountBits'(low);
    assign b = CountBits'(high);
    for (genvar i = 0; i < CountBits; i++) begin : g_add
      logic carry;
      if (i == 0) begin : g_first
        assign carry = bits_i[Bits-1];
      end else begin : g_next
        assign carry = (a[i-1] & b[i-1]) | (g_add[i-1].carry & (a[i-1] ^ b[i-1]));
      end
      assign count_o[i] = a[i] ^ b[i] ^ carry;
    end
  end
endmodule
