// Splits words of 32 bits into words of OutBits, the lowest byte first.
//
// Formula   out = in[OutBits - 1 : 0], then the next OutBits, ..
// C++ twin  put() in test/rtl/link/link_usb_test.cpp
// Schedule  OutBits = 32: wires. Else a shift register, loaded as its last part leaves.
// Latency   1 clock; 0 with OutBits = 32. One word out per clock.
// Handshake Stream on both sides, with a combinational path from ready_i to ready_o.
// Limits    OutBits 8 or 32
module fs_word_gearbox #(
  parameter int OutBits = 8
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               valid_i,
  output logic               ready_o,
  input  logic [31:0]        data_i,
  output logic               valid_o,
  input  logic               ready_i,
  output logic [OutBits-1:0] data_o
);
  localparam int Parts = 32 / OutBits;
  if (OutBits != 8 && OutBits != 32)
    initial $fatal(1, "fs_word_gearbox: OutBits is %0d, allowed: 8, 32", OutBits);

  if (Parts == 1) begin : g_wires
    // Clock and reset are not needed.
    logic unused;
    assign unused = clk_i & rst_ni;
    assign valid_o = valid_i;
    assign ready_o = ready_i;
    assign data_o = data_i[OutBits-1:0];
  end else begin : g_shift
    logic [31:0] data_q;
    logic [Parts-1:0] left_q;  // a one for each remaining part
    assign ready_o = ~left_q[0] | (~left_q[1] & ready_i);
    assign valid_o = left_q[0];
    assign data_o = data_q[OutBits-1:0];
    always_ff @(posedge clk_i) begin
      if (valid_i & ready_o) data_q <= data_i;
      else if (ready_i) data_q <= data_q >> OutBits;
      if (!rst_ni) left_q <= '0;
      else if (valid_i & ready_o) left_q <= '1;
      else if (ready_i) left_q <= left_q >> 1;
    end
  end
endmodule
