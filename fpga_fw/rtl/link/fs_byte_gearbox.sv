// Splits words of InBits into their valid bytes, the lowest first.
//
// Formula   out = the bytes k of data_i with keep_i[k], k = 0, 1, ..
// C++ twin  Ft245Chip::give() in test/rtl/link/ft245_chip.hpp
// Schedule  a word is held until its last byte leaves; a word without valid bytes is skipped
// Latency   1 clock. One byte out per clock.
// Handshake Stream on both sides, with a combinational path from ready_i to ready_o.
// Limits    InBits 8 or 32
module fs_byte_gearbox #(
  parameter int InBits = 8
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                valid_i,
  output logic                ready_o,
  input  logic [InBits-1:0]   data_i,
  input  logic [InBits/8-1:0] keep_i,
  output logic                valid_o,
  input  logic                ready_i,
  output logic [7:0]          data_o
);
  localparam int Bytes = InBits / 8;
  if (InBits != 8 && InBits != 32)
    initial $fatal(1, "fs_byte_gearbox: InBits is %0d, allowed: 8, 32", InBits);

  logic [InBits-1:0] data_q;
  logic [Bytes-1:0] keep_q, rest;
  always_comb begin
    rest = keep_q & (keep_q - 1'b1);  // without its lowest one
    data_o = '0;
    for (int k = Bytes - 1; k >= 0; k--) if (keep_q[k]) data_o = data_q[8*k+:8];
  end
  assign valid_o = keep_q != '0;
  assign ready_o = keep_q == '0 | (rest == '0 & ready_i);
  always_ff @(posedge clk_i) begin
    if (valid_i & ready_o) data_q <= data_i;
    if (!rst_ni) keep_q <= '0;
    else if (ready_o) keep_q <= keep_i & {Bytes{valid_i}};
    else if (ready_i) keep_q <= rest;
  end
endmodule
