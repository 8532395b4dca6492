// A serial line, 8N1, in both directions.
//
// Formula   see fs_uart_tx and fs_uart_rx
// C++ twin  UartLine in test/rtl/link/uart_test.cpp, the other end
// Schedule  see fs_uart_tx and fs_uart_rx
// Latency   see fs_uart_tx and fs_uart_rx
// Handshake streams
// Limits    as theirs, and baud_i <= ClockHz / 32, so that the receiver tolerates 3 %
module fs_uart #(
  parameter int ClockHz = 100000000
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [22:0] baud_i,  // bits per second
  input  logic        tx_valid_i,
  output logic        tx_ready_o,
  input  logic [7:0]  tx_data_i,
  output logic        txd_o,
  input  logic        rxd_i,
  output logic        rx_valid_o,
  input  logic        rx_ready_i,
  output logic [7:0]  rx_data_o,
  output logic        framing_error_o,
  output logic        overrun_o
);
  fs_uart_tx #(.ClockHz(ClockHz)) u_tx (
    .clk_i, .rst_ni, .baud_i, .valid_i(tx_valid_i), .ready_o(tx_ready_o), .data_i(tx_data_i), .txd_o
  );
  fs_uart_rx #(.ClockHz(ClockHz)) u_rx (
    .clk_i, .rst_ni, .baud_i, .rxd_i, .valid_o(rx_valid_o), .ready_i(rx_ready_i),
    .data_o(rx_data_o), .framing_error_o, .overrun_o
  );
endmodule
