// The FPGA's end of FTDI's synchronous 245 FIFO: FT232H (8 bit, 60 MHz), FT601 in its 245 mode
// (32 bit, 100 MHz).
//
// Formula   rx is the data from the chip, tx the data to the chip. At a rising clock edge
//             a word is received   if RD# and RXF# are low
//             a word is sent       if WR# and TXE# are low; otherwise it is offered again
//           So data that is present while RXF# rises is not a word, and a word that is offered
//           while TXE# rises is kept. Names as in DS_FT232H and AN_130, DS_FT600Q-FT601Q.
// C++ twin  Ft245Chip in test/rtl/link/ft245_chip.hpp, the other end
// Schedule  Idle   nobody drives; at least one clock between directions, two after Write: the data
//                  stay driven for one clock after WR#, to meet the chip's hold time
//           Turn   OE# low: the chip drives
//           Read   OE# and RD# low: a word per clock
//           Write  WR# low, data driven: a word per clock
//           A direction ends when its flag is high in two consecutive clocks (one is tolerated),
//           when its stream is empty or full, or after Burst clocks if the other direction waits.
//           The other direction is then next: neither can starve.
// Latency   to the chip: 4 clocks from tx to WR#; from the chip: 3 clocks to rx
// Handshake Streams. rx_keep_o: the valid bytes (BE of the FT601). siwu_no is low for 4 clocks if
//           nothing was written for FlushClocks after a write: the FT232H then sends a USB packet
//           that is not full, without waiting for its latency timer.
// Timing    Outputs are flip-flops. RXF# and TXE# take effect in the clock in which they arrive, as
//           in the formula, so that no word has to be taken back. They and the data arrive late in
//           the clock (FT232H: 9 ns of 16.7); the FT601 at 100 MHz may need clk_i from a PLL, with
//           a later phase.
// Limits    FT232H: its EEPROM must select 245 FIFO; it has no BE, be_i is 1. FT601: its FIFO mode
//           must be 245, one channel; BE is driven as all ones; it is assumed to send the remaining
//           data when WR# rises, so its SIWU# stays high (FlushClocks = 0). clk_i is the chip's and
//           may stop at any time: everything stops and resumes with it. Before the first clock the
//           outputs are high, and nothing is driven.
module fs_ft245 #(
  parameter int DataBits = 8,
  parameter int Burst = 512,
  parameter int FlushClocks = 1024
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  // The pins. data_oe_o drives data and BE.
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
  output logic                  data_oe_o,
  // To the host.
  input  logic                  tx_valid_i,
  output logic                  tx_ready_o,
  input  logic [DataBits-1:0]   tx_data_i,
  // From the host.
  output logic                  rx_valid_o,
  input  logic                  rx_ready_i,
  output logic [DataBits-1:0]   rx_data_o,
  output logic [DataBits/8-1:0] rx_keep_o
);
  localparam int KeepBits = DataBits / 8;
  localparam int BurstBits = $clog2(Burst + 2);
  if (DataBits != 8 && DataBits != 32)
    initial $fatal(1, "fs_ft245: DataBits is %0d, allowed: 8, 32", DataBits);
  if (Burst < 1) initial $fatal(1, "fs_ft245: Burst is %0d, allowed: 1 or more", Burst);

  // Initial values: the chip's clock starts late, and its inputs must be high until then.
  typedef enum logic [1:0] {Idle, Turn, Read, Write} state_e;
  state_e state_q, state_d;
  logic rd_n_q = 1'b1, wr_n_q = 1'b1, oe_n_q = 1'b1, siwu_n_q = 1'b1, data_oe_q = 1'b0;
  logic [DataBits-1:0] data_q;
  logic full_q;  // data_q waits to be written

  // The word to write.
  logic head_valid, head_ready, written;
  logic [DataBits-1:0] head_data;
  logic [4:0] unused_count;
  fs_stream_fifo #(.Bits(DataBits), .Depth(16)) u_tx (
    .clk_i, .rst_ni, .valid_i(tx_valid_i), .ready_o(tx_ready_o), .data_i(tx_data_i),
    .valid_o(head_valid), .ready_i(head_ready), .data_o(head_data), .count_o(unused_count)
  );
  assign written = ~wr_n_q & ~txe_ni;
  assign head_ready = ~full_q | written;
  always_ff @(posedge clk_i) begin
    if (head_valid & head_ready) data_q <= head_data;
    full_q <= rst_ni & (head_valid | ~head_ready);
  end

  // Direction. Every word that is read needs room; four may be on their way.
  logic [4:0] rx_count;
  logic room_q, stalled_q, was_read_q, burst_over_q, may_read, may_write;
  logic [BurstBits-1:0] burst_q;
  assign may_read = ~rxf_ni & room_q;
  assign may_write = ~txe_ni & full_q;
  always_comb begin
    state_d = state_q;
    case (state_q)
      Idle: begin
        if (may_write & ~(may_read & ~was_read_q)) state_d = Write;
        else if (may_read & ~data_oe_q) state_d = Turn;
      end
      Turn: state_d = Read;
      Read: if (~room_q | (rxf_ni & stalled_q) | (burst_over_q & may_write)) state_d = Idle;
      default: begin
        if (txe_ni ? stalled_q : ~head_valid | (burst_over_q & may_read)) state_d = Idle;
      end
    endcase
    if (!rst_ni) state_d = Idle;
  end
  always_ff @(posedge clk_i) begin
    state_q <= state_d;
    rd_n_q <= state_d != Read;
    oe_n_q <= state_d != Read && state_d != Turn;
    wr_n_q <= state_d != Write;
    data_oe_q <= state_d == Write || !wr_n_q;
    room_q <= rst_ni & rx_count < 5'd12;
    stalled_q <= (state_q == Read & rxf_ni) | (state_q == Write & txe_ni);
    if (!rst_ni) was_read_q <= 1'b0;
    else if (state_q != Idle) was_read_q <= state_q != Write;
    burst_q <= state_q == Idle ? BurstBits'(Burst - 1) : burst_q - BurstBits'(burst_q != '0);
    burst_over_q <= state_q != Idle & burst_q == '0;
  end
  assign rd_no = rd_n_q;
  assign oe_no = oe_n_q;
  assign wr_no = wr_n_q;
  assign data_oe_o = data_oe_q;
  assign data_o = data_q;
  assign be_o = '1;

  // The word that was read.
  logic in_valid_q, unused_ready;
  logic [KeepBits+DataBits-1:0] in_q;
  always_ff @(posedge clk_i) begin
    in_valid_q <= rst_ni & ~rd_n_q & ~rxf_ni;
    in_q <= {be_i, data_i};
  end
  fs_stream_fifo #(.Bits(KeepBits + DataBits), .Depth(16)) u_rx (
    .clk_i, .rst_ni, .valid_i(in_valid_q), .ready_o(unused_ready), .data_i(in_q),
    .valid_o(rx_valid_o), .ready_i(rx_ready_i), .data_o({rx_keep_o, rx_data_o}),
    .count_o(rx_count)
  );

  // SIWU#: sends immediately.
  if (FlushClocks > 0) begin : g_flush
    localparam int FlushBits = $clog2(FlushClocks + 4);
    logic [FlushBits-1:0] idle_q;
    logic unsent_q;
    always_ff @(posedge clk_i) begin
      if (!rst_ni | full_q | ~unsent_q) idle_q <= '0;
      else idle_q <= idle_q + 1'b1;
      unsent_q <= rst_ni & (written | (unsent_q & idle_q != FlushBits'(FlushClocks + 3)));
      siwu_n_q <= ~(rst_ni & unsent_q & idle_q >= FlushBits'(FlushClocks));
    end
  end
  assign siwu_no = siwu_n_q;
endmodule
