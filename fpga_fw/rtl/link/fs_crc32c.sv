// CRC-32C, several bits per step.
//
// Formula   link.md: polynomial 0x1EDC6F41, reflected. The register starts as all ones; its inverse
//           is sent, low byte first. Over a message followed by its CRC the register becomes
//           Residue, which a test compares with the C++ value.
// C++ twin  fpga_stereo::link::crc32c (src/link/packet.cpp)
// Schedule  combinational: each bit of the next register is the parity of those bits of crc ^ data
//           that a constant mask selects. The masks are computed here, so no chain of steps
//           remains.
// Limits    Bits is 8 or 32; the low byte of data comes first.
module fs_crc32c #(
  parameter int Bits = 32
) (
  input  logic [31:0]     crc_i,
  input  logic [Bits-1:0] data_i,
  output logic [31:0]     crc_o,
  output logic            residue_o  // crc_i covers a message and its CRC
);
  localparam logic [31:0] Reflected = 32'h82F63B78;
  localparam logic [31:0] Residue = 32'hB798B438;
  if (Bits != 8 && Bits != 32) initial $fatal(1, "fs_crc32c: Bits is %0d, allowed: 8, 32", Bits);

  function automatic logic [31:0] stepped(input logic [31:0] word);
    stepped = word;
    for (int k = 0; k < Bits; k++) stepped = (stepped >> 1) ^ (stepped[0] ? Reflected : '0);
  endfunction

  logic [Bits-1:0] mixed;
  logic [32*Bits-1:0] columns;  // effect of each bit of `mixed`
  assign mixed = crc_i[Bits-1:0] ^ data_i;
  for (genvar j = 0; j < Bits; j++) begin : g_column
    localparam logic [31:0] Column = stepped(32'd1 << j);
    assign columns[32*j+:32] = Column;
  end
  for (genvar i = 0; i < 32; i++) begin : g_bit
    logic [Bits-1:0] mask;
    for (genvar j = 0; j < Bits; j++) begin : g_mask
      assign mask[j] = columns[32*j+i];
    end
    if (i + Bits < 32) begin : g_shifted
      assign crc_o[i] = ^(mixed & mask) ^ crc_i[i+Bits];
    end else begin : g_new
      assign crc_o[i] = ^(mixed & mask);
    end
  end
  assign residue_o = crc_i == Residue;
endmodule
