// Adder that selects its second operand.
//
// Formula   sum_o = a_i + (select_i ? b_i : c_i) + CarryIn, modulo 2^Bits
// Schedule  Behavioural, or with Primitives 1 an instantiated ECP5 carry chain. Each bit of that
//           chain has a four-input table, which performs the selection at no cost; synthesis does
//           not infer this. fpga_fw/formal proves that both are equal.
// Latency   none.
module fs_add_select #(
  parameter int Bits = 13,
  parameter int CarryIn = 0,  // 0, 1
  parameter int Primitives = 0
) (
  input  logic [Bits-1:0] a_i,
  input  logic [Bits-1:0] b_i,
  input  logic [Bits-1:0] c_i,
  input  logic            select_i,
  output logic [Bits-1:0] sum_o
);
  if (Primitives == 0) begin : g_behavioural
    assign sum_o = a_i + (select_i ? b_i : c_i) + Bits'(CarryIn);
  end else begin : g_ecp5
    localparam int Pairs = (Bits + 1) / 2;
    // Table of A, B, C, D: A ^ (D ? B : C). Its first four entries, C = D = 0, give the carry where
    // the carry in is not propagated: A.
    localparam logic [15:0] Table = 16'h665A;
    logic [2*Pairs-1:0] a, b, c, sum;
    logic [Pairs:0] carry;
    assign a = (2 * Pairs)'(a_i);
    assign b = (2 * Pairs)'(b_i);
    assign c = (2 * Pairs)'(c_i);
    assign carry[0] = CarryIn != 0;
    for (genvar k = 0; k < Pairs; k++) begin : g_pair
      CCU2C #(
        .INIT0(Table), .INIT1(Table), .INJECT1_0("NO"), .INJECT1_1("NO")
      ) u_pair (
        .CIN(carry[k]), .COUT(carry[k+1]),
        .A0(a[2*k]), .B0(b[2*k]), .C0(c[2*k]), .D0(select_i), .S0(sum[2*k]),
        .A1(a[2*k+1]), .B1(b[2*k+1]), .C1(c[2*k+1]), .D1(select_i), .S1(sum[2*k+1])
      );
    end
    assign sum_o = sum[Bits-1:0];
  end
endmodule
