// Receives bytes, 8N1.
//
// Formula   A low level starts a byte. Each bit is the majority of three samples, taken 3/8, 4/8
//           and 5/8 into the bit. If the start bit reads high, it was a glitch and is ignored. If
//           the stop bit reads low, the byte is dropped with framing_error_o, and the line must be
//           high before the next byte. So a break (line low for long) gives one framing error.
// C++ twin  UartLine in test/rtl/link/uart_test.cpp, the other end
// Schedule  fs_sync; ticks of 1/8 bit from the edge on. The next byte may start from 5/8 of the
//           stop bit on, so the sender may be faster than this receiver.
// Latency   9 5/8 bits and 5 clocks from the edge to the byte
// Handshake A stream with room for one byte: if that byte has not moved when the next one is
//           complete, the next one is dropped with overrun_o. Pulses of one clock.
// Limits    baud_i <= ClockHz / 16; the sender's rate within 3 % of it at 32 clocks per bit or more
module fs_uart_rx #(
  parameter int ClockHz = 100000000
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [22:0] baud_i,
  input  logic        rxd_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic [7:0]  data_o,
  output logic        framing_error_o,
  output logic        overrun_o
);
  logic rxd;
  fs_sync u_rxd (.clk_i, .d_i(rxd_i), .q_o(rxd));

  logic busy_q, wait_q, tick;
  fs_baud #(.ClockHz(ClockHz), .StepBits(26)) u_baud (
    .clk_i, .restart_i(~busy_q), .step_i({baud_i, 3'd0}), .tick_o(tick)
  );

  logic [2:0] eighth_q;   // eighth of the bit at the next tick, minus one
  logic [3:0] bit_q;      // 0: start bit, 1 to 8: data, 9: stop bit
  logic [1:0] samples_q;
  logic [7:0] data_q;
  logic decide, value, done, start, valid_q;
  assign decide = tick & eighth_q == 3'd4;
  assign value = (samples_q[0] & samples_q[1]) | (rxd & (samples_q[0] | samples_q[1]));
  assign done = decide & (bit_q == 4'd9);
  assign start = ~busy_q & ~wait_q & ~rxd;
  always_ff @(posedge clk_i) begin
    if (start) begin
      eighth_q <= '0;
      bit_q <= '0;
    end else if (tick) begin
      eighth_q <= eighth_q + 3'd1;
      bit_q <= bit_q + 4'(&eighth_q);
      samples_q <= {samples_q[0], rxd};
    end
    if (decide & bit_q != 4'd9) data_q <= {value, data_q[7:1]};
    busy_q <= rst_ni & (start | (busy_q & ~done & ~(decide & bit_q == '0 & value)));
    wait_q <= ~rst_ni | ((wait_q | (done & ~value)) & ~rxd);
    framing_error_o <= rst_ni & done & ~value;
    overrun_o <= rst_ni & done & value & valid_q & ~ready_i;
    valid_q <= rst_ni & ((done & value) | (valid_q & ~ready_i));
    if (done & value & (~valid_q | ready_i)) data_o <= data_q;
  end
  assign valid_o = valid_q;
endmodule
