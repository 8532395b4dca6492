// The link over FTDI's FIFO: connects the gateware's streams to the chip's pins.
//
// Formula   the host reads the words of tx as bytes, the lowest first, and writes the bytes of rx
// C++ twin  none: bytes out = bytes in
// Schedule  tx  fs_async_fifo (words), fs_word_gearbox (parts of DataBits), fs_ft245
//           rx  fs_ft245, fs_async_fifo (words and their valid bytes), fs_byte_gearbox
// Latency   tx: about 9 clocks of usb_clk_i to WR#; rx: about 4 of usb_clk_i and 4 of clk_i
// Handshake Streams. The gateware's side has the same ports as fs_link_uart.
// Limits    A reset discards the words inside, so packets may be cut. rst_ni is synchronised to
//           usb_clk_i: it must be low for a few clocks of it, or until that clock begins to run.
module fs_link_usb #(
  parameter int DataBits = 8,
  parameter int Burst = 512,
  parameter int FlushClocks = DataBits == 8 ? 1024 : 0,
  parameter int TxDepth = 512,
  parameter int RxDepth = 512
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic                  tx_valid_i,
  output logic                  tx_ready_o,
  input  logic [31:0]           tx_data_i,
  output logic                  rx_valid_o,
  input  logic                  rx_ready_i,
  output logic [7:0]            rx_data_o,
  // The chip: see fs_ft245.
  input  logic                  usb_clk_i,
  input  logic                  rxf_ni,
  input  logic                  txe_ni,
  output logic                  rd_no,
  output logic                  wr_no,
  output logic                  oe_no,
  output logic                  siwu_no,
  input  logic [DataBits-1:0]   data_i,
  input  logic [DataBits/8-1:0] be_i,
  output logic [DataBits-1:0]   data_o,
  output logic [DataBits/8-1:0] be_o,
  output logic                  data_oe_o
);
  localparam int RxBits = DataBits + DataBits / 8;
  logic usb_rst_n;
  fs_sync u_reset (.clk_i(usb_clk_i), .d_i(rst_ni), .q_o(usb_rst_n));

  logic word_valid, word_ready, part_valid, part_ready;
  logic [31:0] word;
  logic [DataBits-1:0] part;
  fs_async_fifo #(.Bits(32), .Depth(TxDepth)) u_tx (
    .wr_clk_i(clk_i), .wr_rst_ni(rst_ni), .wr_valid_i(tx_valid_i), .wr_ready_o(tx_ready_o),
    .wr_data_i(tx_data_i), .rd_clk_i(usb_clk_i), .rd_rst_ni(usb_rst_n), .rd_valid_o(word_valid),
    .rd_ready_i(word_ready), .rd_data_o(word)
  );
  fs_word_gearbox #(.OutBits(DataBits)) u_parts (
    .clk_i(usb_clk_i), .rst_ni(usb_rst_n), .valid_i(word_valid), .ready_o(word_ready),
    .data_i(word), .valid_o(part_valid), .ready_i(part_ready), .data_o(part)
  );

  logic in_valid, in_ready, out_valid, out_ready;
  logic [RxBits-1:0] in, out;
  fs_ft245 #(.DataBits(DataBits), .Burst(Burst), .FlushClocks(FlushClocks)) u_ft245 (
    .clk_i(usb_clk_i), .rst_ni(usb_rst_n), .rxf_ni, .txe_ni, .rd_no, .wr_no, .oe_no, .siwu_no,
    .data_i, .be_i, .data_o, .be_o, .data_oe_o,
    .tx_valid_i(part_valid), .tx_ready_o(part_ready), .tx_data_i(part),
    .rx_valid_o(in_valid), .rx_ready_i(in_ready), .rx_data_o(in[DataBits-1:0]),
    .rx_keep_o(in[RxBits-1:DataBits])
  );
  fs_async_fifo #(.Bits(RxBits), .Depth(RxDepth)) u_rx (
    .wr_clk_i(usb_clk_i), .wr_rst_ni(usb_rst_n), .wr_valid_i(in_valid), .wr_ready_o(in_ready),
    .wr_data_i(in), .rd_clk_i(clk_i), .rd_rst_ni(rst_ni), .rd_valid_o(out_valid),
    .rd_ready_i(out_ready), .rd_data_o(out)
  );
  fs_byte_gearbox #(.InBits(DataBits)) u_bytes (
    .clk_i, .rst_ni, .valid_i(out_valid), .ready_o(out_ready), .data_i(out[DataBits-1:0]),
    .keep_i(out[RxBits-1:DataBits]), .valid_o(rx_valid_o), .ready_i(rx_ready_i), .data_o(rx_data_o)
  );
endmodule
