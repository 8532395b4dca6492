// The board's top module with its pins as plain ports for a Verilated model: each bidirectional pin
// has separate input, output and enable ports, and the two-wire buses have pull-ups.
//
// C++ twin  Ft245Chip (test/rtl/link/ft245_chip.hpp) connects to the ports from rxf_ni to data_oe_o
module board_pins #(
  parameter int PllFeedback = 12,
  parameter int PllDivide = 10,
  parameter int UartBaud = 1000000
) (
  input  logic       clk_i,
  input  logic [6:0] btn_i,
  input  logic [3:0] sw_i,
  output logic [7:0] led_o,
  input  logic       usb_clk_i,
  input  logic       rxf_ni,
  input  logic       txe_ni,
  output logic       rd_no,
  output logic       wr_no,
  output logic       oe_no,
  output logic       siwu_no,
  input  logic [7:0] data_i,
  input  logic       be_i,
  output logic [7:0] data_o,
  output logic       be_o,
  output logic       data_oe_o,
  output logic       txd_o,
  input  logic       rxd_i,
  output logic       sensor_clk_o,
  output logic       sensor_rst_no,
  output logic       scl_o,
  output logic [1:0] sda_o,      // {left, right}
  input  logic [1:0] sda_low_i,  // 1 = that sensor pulls SDA low
  input  logic [1:0] pixclk_i,
  input  logic [1:0] frame_valid_i,
  input  logic [1:0] line_valid_i,
  input  logic [15:0] data_pixels_i,
  output logic       wifi_en_o
);
  wire [7:0] ft_d;
  wire scl, left_sda, right_sda;
  pullup (scl);
  pullup (left_sda);
  pullup (right_sda);
  // The FT232H drives the data bus while OE# is low.
  assign ft_d = oe_no ? 8'bz : data_i;
  assign data_o = ft_d;
  assign be_o = 1'b1;
  assign data_oe_o = u_top.usb_drives;
  assign scl_o = scl;
  assign sda_o = {left_sda, right_sda};
  assign left_sda = sda_low_i[1] ? 1'b0 : 1'bz;
  assign right_sda = sda_low_i[0] ? 1'b0 : 1'bz;
  logic unused_be;
  assign unused_be = be_i;
  top #(
    .MaxWidth(64), .Disparities(16), .Primitives(0), .PllFeedback(PllFeedback),
    .PllDivide(PllDivide), .UartBaud(UartBaud), .SensorWidth(72), .SensorHeight(52)
  ) u_top (
    .clk_25mhz(clk_i), .btn(btn_i), .sw(sw_i), .led(led_o), .wifi_en(wifi_en_o),
    .ft_clk(usb_clk_i), .ft_rxf_n(rxf_ni), .ft_txe_n(txe_ni), .ft_rd_n(rd_no), .ft_wr_n(wr_no),
    .ft_oe_n(oe_no), .ft_siwu_n(siwu_no), .ft_d, .ftdi_rxd(txd_o), .ftdi_txd(rxd_i),
    .cam_clk(sensor_clk_o), .cam_reset_n(sensor_rst_no), .cam_scl(scl), .left_sda, .right_sda,
    .left_pixclk(pixclk_i[1]), .left_fv(frame_valid_i[1]), .left_lv(line_valid_i[1]),
    .left_d(data_pixels_i[15:8]), .right_pixclk(pixclk_i[0]), .right_fv(frame_valid_i[0]),
    .right_lv(line_valid_i[0]), .right_d(data_pixels_i[7:0])
  );
endmodule
