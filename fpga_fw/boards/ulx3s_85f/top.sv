// Top level for the ULX3S v3 with LFE5U-85F: two cameras, the whole pipeline, and the link.
// README.md describes the wiring, the switches, the buttons and the LEDs.
//
//   cameras or test pattern -> fs_system -> FT232H (synchronous 245 FIFO) or FT231X (serial)
//
// Clock     25 MHz -> VCO = 50 MHz * PllFeedback (400 to 800 MHz) -> core = VCO / PllDivide.
//           12 and 10: 60 MHz.  12 and 6: 100 MHz.
//           The FT232H and each sensor bring their own clocks.
// Reset     until the PLL has locked, and while BTN_PWRn is pressed; released synchronously. The
//           end of the link that is not selected is in reset.
// Limits    UartBaud <= core clock / 32
module top #(
  parameter int MaxWidth = 640,
  parameter int Disparities = 64,
  parameter int CensusFull = 0,
  parameter int Primitives = 1,  // of the ECP5: fs_add_select
  parameter int PllFeedback = 12,
  parameter int PllDivide = 12,
  parameter int UartBaud = 1000000,
  parameter int SensorWidth = 752,
  parameter int SensorHeight = 480
) (
  input  logic       clk_25mhz,
  input  logic [6:0] btn,
  input  logic [3:0] sw,
  output logic [7:0] led,
  output logic       wifi_en,
  // FT232H.
  input  logic       ft_clk,
  input  logic       ft_rxf_n,
  input  logic       ft_txe_n,
  output logic       ft_rd_n,
  output logic       ft_wr_n,
  output logic       ft_oe_n,
  output logic       ft_siwu_n,
  inout  wire  [7:0] ft_d,
  // FT231X; the signal names are those of the chip.
  output logic       ftdi_rxd,
  input  logic       ftdi_txd,
  // Sensors.
  output logic       cam_clk,
  output logic       cam_reset_n,
  inout  wire        cam_scl,
  inout  wire        left_sda,
  inout  wire        right_sda,
  input  logic       left_pixclk,
  input  logic       left_fv,
  input  logic       left_lv,
  input  logic [7:0] left_d,
  input  logic       right_pixclk,
  input  logic       right_fv,
  input  logic       right_lv,
  input  logic [7:0] right_d
);
  localparam int ClockHz = 50000000 * PllFeedback / PllDivide;
  if (UartBaud > ClockHz / 32)
    initial $fatal(1, "top: UartBaud is %0d, allowed: up to %0d", UartBaud, ClockHz / 32);

  // The core clock. Phase comparison at 25 MHz; CLKOP, at half of the VCO, is only fed back.
  logic feedback, clk, locked;
  (* FREQUENCY_PIN_CLKI = "25" *)
  EHXPLLL #(
    .CLKI_DIV(1), .CLKFB_DIV(PllFeedback), .FEEDBK_PATH("CLKOP"),
    .CLKOP_ENABLE("ENABLED"), .CLKOP_DIV(2), .CLKOP_CPHASE(1), .CLKOP_FPHASE(0),
    .CLKOS_ENABLE("ENABLED"), .CLKOS_DIV(PllDivide), .CLKOS_CPHASE(PllDivide - 1),
    .CLKOS_FPHASE(0)
  ) u_pll (
    .CLKI(clk_25mhz), .CLKFB(feedback), .CLKOP(feedback), .CLKOS(clk), .LOCK(locked),
    .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b0),
    .PHASESTEP(1'b0), .PHASELOADREG(1'b0), .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0), .ENCLKOS(1'b0)
  );

  // Flip-flops are 0 after the FPGA is configured, so the reset is active from the start.
  logic [3:0] rst_nq;
  always_ff @(posedge clk) rst_nq <= {rst_nq[2:0], locked & btn[0]};
  logic rst_n;
  assign rst_n = rst_nq[3];

  // Switches and buttons, asynchronous.
  logic pattern, serial, show_errors, show_overruns;
  fs_sync #(.Bits(4)) u_hand (
    .clk_i(clk), .d_i({sw[0], sw[1], btn[1], btn[2]}),
    .q_o({pattern, serial, show_errors, show_overruns})
  );

  // The two ends of the link, and the selection.
  logic rx_valid, rx_ready, tx_valid, tx_ready, usb_rst_nq, serial_rst_nq;
  logic usb_rx_valid, usb_tx_ready, serial_rx_valid, serial_tx_ready, framing_error, uart_overrun;
  logic [7:0] rx_data, usb_rx_data, serial_rx_data, usb_data;
  logic [31:0] tx_data;
  logic usb_drives, unused_be;
  always_ff @(posedge clk) begin
    usb_rst_nq <= rst_n & ~serial;
    serial_rst_nq <= rst_n & serial;
  end
  // Depth: block RAM is scarce, and the rings of the streams are the buffer.
  fs_link_usb #(.TxDepth(64), .RxDepth(64)) u_usb (
    .clk_i(clk), .rst_ni(usb_rst_nq), .tx_valid_i(tx_valid & ~serial), .tx_ready_o(usb_tx_ready),
    .tx_data_i(tx_data), .rx_valid_o(usb_rx_valid), .rx_ready_i(rx_ready & ~serial),
    .rx_data_o(usb_rx_data), .usb_clk_i(ft_clk), .rxf_ni(ft_rxf_n), .txe_ni(ft_txe_n),
    .rd_no(ft_rd_n), .wr_no(ft_wr_n), .oe_no(ft_oe_n), .siwu_no(ft_siwu_n), .data_i(ft_d),
    .be_i(1'b1), .data_o(usb_data), .be_o(unused_be), .data_oe_o(usb_drives)
  );
  assign ft_d = usb_drives ? usb_data : 8'bz;
  fs_link_uart #(.ClockHz(ClockHz)) u_serial (
    .clk_i(clk), .rst_ni(serial_rst_nq), .tx_valid_i(tx_valid & serial),
    .tx_ready_o(serial_tx_ready), .tx_data_i(tx_data), .rx_valid_o(serial_rx_valid),
    .rx_ready_i(rx_ready & serial), .rx_data_o(serial_rx_data), .baud_i(23'(UartBaud)),
    .rxd_i(ftdi_txd), .txd_o(ftdi_rxd), .framing_error_o(framing_error), .overrun_o(uart_overrun)
  );
  assign rx_valid = serial ? serial_rx_valid : usb_rx_valid;
  assign rx_data = serial ? serial_rx_data : usb_rx_data;
  assign tx_ready = serial ? serial_tx_ready : usb_tx_ready;

  // The cameras.
  logic [11:0] width, height;
  logic cameras_valid, cameras_ready, cameras_sof, cameras_eol, whole_frame;
  logic [7:0] cameras_left, cameras_right, errors, overruns;
  fs_cameras #(.SensorWidth(SensorWidth), .SensorHeight(SensorHeight)) u_cameras (
    .pixclk_i({left_pixclk, right_pixclk}), .frame_valid_i({left_fv, right_fv}),
    .line_valid_i({left_lv, right_lv}), .data_i({left_d, right_d}), .clk_i(clk), .rst_ni(rst_n),
    .width_i(width), .height_i(height), .valid_o(cameras_valid), .ready_i(cameras_ready),
    .sof_o(cameras_sof), .eol_o(cameras_eol), .left_o(cameras_left), .right_o(cameras_right),
    .frame_o(whole_frame), .errors_o(errors), .overruns_o(overruns)
  );
  logic [3:0] index;
  logic [7:0] sensor_register;
  logic [15:0] sensor_value;
  logic sensor_last, scl_low, sda_low;
  logic [1:0] answered;
  fs_mt9v034 u_table (
    .index_i(index), .register_o(sensor_register), .value_o(sensor_value), .last_o(sensor_last)
  );
  fs_sensor_setup #(.ClockHz(ClockHz)) u_setup (
    .clk_i(clk), .rst_ni(rst_n), .frame_i(whole_frame), .answered_o(answered), .index_o(index),
    .register_i(sensor_register), .value_i(sensor_value), .last_i(sensor_last),
    .sensor_rst_no(cam_reset_n), .scl_low_o(scl_low), .sda_low_o(sda_low),
    .sda_i({left_sda, right_sda})
  );
  assign cam_clk = clk_25mhz;
  assign cam_scl = scl_low ? 1'b0 : 1'bz;
  assign left_sda = sda_low ? 1'b0 : 1'bz;
  assign right_sda = sda_low ? 1'b0 : 1'bz;

  // The test pattern, no faster than the link can carry its disparities: 30 frames of 640 x 480 a
  // second over USB; over a serial line two bytes of ten bits per pixel, plus the overhead of a
  // row's packet. There a frame takes seconds, so a frame that nobody asked for, or that a
  // configuration waits for, is made at the rate of USB.
  localparam int UsbRate = ClockHz < 9216000 ? ClockHz : 9216000;
  localparam int RateBits = $clog2(ClockHz + 1);
  logic streaming, slow_q, pattern_valid, pattern_ready, pattern_sof, pattern_eol;
  logic [7:0] pattern_left, pattern_right;
  logic made_valid, made_ready;
  logic [17:0] made;
  test_pattern #(.ClockHz(ClockHz)) u_pattern (
    .clk_i(clk), .rst_ni(rst_n),
    .rate_i(slow_q ? RateBits'(UartBaud / 24) : RateBits'(UsbRate)), .width_i(width),
    .height_i(height), .valid_o(made_valid), .ready_i(made_ready), .sof_o(made[17]),
    .eol_o(made[16]), .left_o(made[15:8]), .right_o(made[7:0])
  );
  fs_stream_slice #(.Bits(18)) u_made (
    .clk_i(clk), .rst_ni(rst_n), .valid_i(made_valid), .ready_o(made_ready), .data_i(made),
    .valid_o(pattern_valid), .ready_i(pattern_ready),
    .data_o({pattern_sof, pattern_eol, pattern_left, pattern_right})
  );

  // Selects the pixels. The selection changes when a frame of the pattern is about to begin; the
  // pattern waits while it is not selected. Pixels of the cameras are dropped while the pattern is
  // selected, so that the cameras never stall, and afterwards up to the start of a frame. A camera
  // frame that the pattern interrupts is flagged as cut.
  logic raw_valid, raw_ready, raw_sof, raw_eol;
  logic [7:0] raw_left, raw_right;
  logic pair_valid, pair_ready;
  logic [17:0] pair;
  logic pattern_q, pattern_begins, leaves, cameras_pass;
  logic synced_q;  // a frame of the cameras has begun
  assign pattern_begins = pattern_valid & pattern_sof;
  assign leaves = pattern_begins & ~pattern;
  assign cameras_pass = ~pattern_q & (cameras_sof | synced_q);
  assign {raw_valid, raw_sof, raw_eol, raw_left, raw_right} = pattern_q
      ? {pattern_valid & ~leaves, pattern_sof, pattern_eol, pattern_left, pattern_right}
      : {cameras_valid & cameras_pass, cameras_sof, cameras_eol, cameras_left, cameras_right};
  fs_stream_slice #(.Bits(18)) u_raw (
    .clk_i(clk), .rst_ni(rst_n), .valid_i(raw_valid), .ready_o(raw_ready),
    .data_i({raw_sof, raw_eol, raw_left, raw_right}), .valid_o(pair_valid), .ready_i(pair_ready),
    .data_o(pair)
  );
  assign cameras_ready = raw_ready | ~cameras_pass;
  assign pattern_ready = raw_ready & pattern_q & ~leaves;
  always_ff @(posedge clk) begin
    if (!rst_n) begin
      pattern_q <= 1'b0;
      synced_q <= 1'b0;
      slow_q <= 1'b0;
    end else begin
      if (pattern_begins) pattern_q <= pattern;
      synced_q <= ~pattern_q & (synced_q | (cameras_valid & cameras_sof & raw_ready));
      slow_q <= serial & streaming & (slow_q | (pattern_begins & pattern_ready));
    end
  end

  // RingRows: as many as fit into the remaining of the 208 block RAMs.
  fs_system #(
    .MaxWidth(MaxWidth), .Disparities(Disparities), .CensusFull(CensusFull),
    .Primitives(Primitives), .ClockHz(ClockHz), .RingRows(3)
  ) u_system (
    .clk_i(clk), .rst_ni(rst_n), .rx_valid_i(rx_valid), .rx_ready_o(rx_ready),
    .rx_data_i(rx_data), .tx_valid_o(tx_valid), .tx_ready_i(tx_ready), .tx_data_o(tx_data),
    .valid_i(pair_valid), .ready_o(pair_ready), .sof_i(pair[17]), .eol_i(pair[16]),
    .left_i(pair[15:8]), .right_i(pair[7:0]), .width_o(width), .height_o(height),
    .streaming_o(streaming)
  );

  // LEDs.
  logic [9:0] ft_count_q;  // shows that the FT232H's clock runs
  always_ff @(posedge ft_clk) ft_count_q <= ft_count_q + 10'd1;
  logic ft_seen, ft_seen_q;
  fs_sync u_ft_seen (.clk_i(clk), .d_i(ft_count_q[9]), .q_o(ft_seen));
  logic trouble, begins;
  assign begins = raw_valid & raw_ready & raw_sof;
  logic [7:0] errors_q, overruns_q;
  logic [4:0] frames_q;
  logic [$clog2(ClockHz)-1:0] second_q;
  always_ff @(posedge clk) begin
    ft_seen_q <= ft_seen;
    errors_q <= errors;
    overruns_q <= overruns;
    if (!rst_n) begin
      frames_q <= '0;
      second_q <= '0;
    end else begin
      frames_q <= frames_q + 5'(begins);
      second_q <= second_q == $clog2(ClockHz)'(ClockHz - 1) ? '0 : second_q + 1'b1;
    end
  end
  assign trouble = errors != errors_q | overruns != overruns_q | framing_error | uart_overrun;
  logic [3:0] seen;
  held #(.Clocks(ClockHz / 10)) u_line (
    .clk_i(clk), .rst_ni(rst_n), .event_i(serial | (ft_seen ^ ft_seen_q)), .seen_o(seen[0])
  );
  held #(.Clocks(ClockHz / 10)) u_from_host (
    .clk_i(clk), .rst_ni(rst_n), .event_i(rx_valid & rx_ready), .seen_o(seen[1])
  );
  held #(.Clocks(ClockHz / 10)) u_to_host (
    .clk_i(clk), .rst_ni(rst_n), .event_i(tx_valid & tx_ready), .seen_o(seen[2])
  );
  held #(.Clocks(ClockHz / 2)) u_trouble (
    .clk_i(clk), .rst_ni(rst_n), .event_i(trouble), .seen_o(seen[3])
  );
  always_ff @(posedge clk) begin
    if (show_errors) led <= errors;
    else if (show_overruns) led <= overruns;
    else led <= {seen[3], frames_q[4], answered, seen[2:0],
                 second_q < $clog2(ClockHz)'(ClockHz / 2)};
  end
  assign wifi_en = 1'b0;  // the ESP32 shares pins with the right camera

  logic unused;
  assign unused = ^{btn[6:3], sw[3:2], unused_be};
endmodule
