// The link over a serial line, 8N1: connects the gateware's streams to the two pins.
//
// Formula   the host reads the words of tx as bytes, the lowest first, and writes the bytes of rx
// C++ twin  none: bytes out = bytes in
// Schedule  tx  fs_word_gearbox, fs_uart_tx
//           rx  fs_uart_rx, fs_stream_fifo
// Latency   tx: 4 clocks to the falling edge; rx: 9 5/8 bits and 7 clocks after it
// Handshake Streams. The gateware's side has the same ports as fs_link_usb, in one clock domain.
//           There is no RTS/CTS: bytes that arrive while the FIFO is full are dropped (overrun_o).
//           framing_error_o and overrun_o are pulses of one clock.
// Limits    baud_i <= ClockHz / 32, up to 8,388,607; changing it corrupts the bytes in transfer.
module fs_link_uart #(
  parameter int ClockHz = 100000000,
  parameter int RxDepth = 16
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        tx_valid_i,
  output logic        tx_ready_o,
  input  logic [31:0] tx_data_i,
  output logic        rx_valid_o,
  input  logic        rx_ready_i,
  output logic [7:0]  rx_data_o,
  // The line.
  input  logic [22:0] baud_i,  // bits per second
  input  logic        rxd_i,
  output logic        txd_o,
  output logic        framing_error_o,
  output logic        overrun_o
);
  logic byte_valid, byte_ready, in_valid, in_ready;
  logic [7:0] tx_byte, in;
  fs_word_gearbox #(.OutBits(8)) u_parts (
    .clk_i, .rst_ni, .valid_i(tx_valid_i), .ready_o(tx_ready_o), .data_i(tx_data_i),
    .valid_o(byte_valid), .ready_i(byte_ready), .data_o(tx_byte)
  );
  fs_uart #(.ClockHz(ClockHz)) u_uart (
    .clk_i, .rst_ni, .baud_i, .tx_valid_i(byte_valid), .tx_ready_o(byte_ready), .tx_data_i(tx_byte),
    .txd_o, .rxd_i, .rx_valid_o(in_valid), .rx_ready_i(in_ready), .rx_data_o(in),
    .framing_error_o, .overrun_o
  );
  logic [$clog2(RxDepth):0] unused_count;
  fs_stream_fifo #(.Bits(8), .Depth(RxDepth)) u_rx (
    .clk_i, .rst_ni, .valid_i(in_valid), .ready_o(in_ready), .data_i(in), .valid_o(rx_valid_o),
    .ready_i(rx_ready_i), .data_o(rx_data_o), .count_o(unused_count)
  );
endmodule
