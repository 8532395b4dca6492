// The register bus on four pins, for any microcontroller: an SPI slave, mode 0, highest bit first.
//
// Formula   a transfer is 48 bits while cs_ni is low: command (bit 7 write), word address, data.
//           Reading: the data of the register is in the last 32 bits of miso_o.
// Schedule  the pins are sampled by clk_i; a write goes out with its 48th bit; a read with its 16th
//           bit, and its data is there 5 clocks later
// Latency   3 clocks from a pin to its register.
// Handshake read_o and write_o for one clock; data_i two clocks behind read_o (fs_top).
// Limits    sclk_i at most an eighth of clk_i. A transfer that is cut short does nothing.
module spi_registers (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        sclk_i,
  input  logic        cs_ni,
  input  logic        mosi_i,
  output logic        miso_o,
  output logic        write_o,
  output logic        read_o,
  output logic [7:0]  address_o,
  output logic [31:0] data_o,
  input  logic [31:0] data_i
);
  // Two registers against metastability, a third for edges.
  logic [2:0] sclk_q;
  logic [1:0] cs_q, mosi_q;
  logic rises, falls;
  always_ff @(posedge clk_i) begin
    sclk_q <= {sclk_q[1:0], sclk_i};
    cs_q <= {cs_q[0], ~cs_ni};
    mosi_q <= {mosi_q[0], mosi_i};
  end
  assign rises = sclk_q[1] & ~sclk_q[2] & cs_q[1];
  assign falls = ~sclk_q[1] & sclk_q[2] & cs_q[1];

  logic [5:0] count_q;  // bits that have come
  logic [46:0] in_q;
  logic [31:0] out_q;
  logic is_write;
  logic [1:0] got_read_q;
  assign is_write = in_q[46];
  assign write_o = rises & count_q == 6'd47 & is_write;
  assign read_o = rises & count_q == 6'd15 & ~in_q[14];
  assign address_o = write_o ? in_q[38:31] : {in_q[6:0], mosi_q[1]};
  assign data_o = {in_q[30:0], mosi_q[1]};
  assign miso_o = out_q[31];
  always_ff @(posedge clk_i) begin
    if (!rst_ni || !cs_q[1]) begin
      count_q <= '0;
      got_read_q <= '0;
    end else begin
      if (rises && count_q != 6'd48) count_q <= count_q + 6'd1;
      got_read_q <= {got_read_q[0], read_o};
    end
    if (rises) in_q <= {in_q[45:0], mosi_q[1]};
    if (got_read_q[1]) out_q <= data_i;
    else if (falls && count_q != 6'd16) out_q <= {out_q[30:0], 1'b0};
  end
endmodule
