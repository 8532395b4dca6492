// Sends bytes, 8N1: a low start bit, eight bits from the lowest on, a high stop bit.
//
// Formula   a bit takes ClockHz / baud_i clocks on average, and each edge is at most a clock late
// C++ twin  UartLine in test/rtl/link/uart_test.cpp, the other end
// Schedule  ten bits in a shift register; the next byte follows without a gap
// Latency   3 clocks from the byte to the falling edge
// Handshake Stream. ready_o is high between bytes, and in the last clock of a byte.
// Limits    baud_i <= ClockHz / 4. A change of it during a byte corrupts that byte.
module fs_uart_tx #(
  parameter int ClockHz = 100000000
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [22:0] baud_i,
  input  logic        valid_i,
  output logic        ready_o,
  input  logic [7:0]  data_i,
  output logic        txd_o
);
  logic busy_q, tick, last_q;
  logic [3:0] bits_q;   // bits left after this one
  logic [8:0] shift_q;
  logic txd_q = 1'b1;   // the line is high from the start
  fs_baud #(.ClockHz(ClockHz), .StepBits(23)) u_baud (
    .clk_i, .restart_i(~busy_q), .step_i(baud_i), .tick_o(tick)
  );

  logic take;
  assign ready_o = ~busy_q | (tick & last_q);
  assign take = valid_i & ready_o;
  always_ff @(posedge clk_i) begin
    if (take) shift_q <= {data_i, 1'b0};
    else if (tick) shift_q <= {1'b1, shift_q[8:1]};
    if (take) bits_q <= 4'd9;
    else if (tick) bits_q <= bits_q - 4'd1;
    if (take) last_q <= 1'b0;
    else if (tick) last_q <= bits_q == 4'd1;
    busy_q <= rst_ni & (take | (busy_q & ~(tick & last_q)));
    txd_q <= ~rst_ni | ~busy_q | shift_q[0];
  end
  assign txd_o = txd_q;
endmodule
