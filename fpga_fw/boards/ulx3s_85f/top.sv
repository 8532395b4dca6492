// ULX3S v3 with LFE5U-85F: the whole pipeline at a pixel per clock, fed with a test pattern. Cameras
// and the link will take the places of test_pattern and spi_registers.
//
// Pins      led, sw[2:0], FIRE1, FIRE2   frames, errors, signatures: panel
//           BTN_PWRn                     reset, while it is pressed
//           spi_*, on GP0 .. GP3         all registers and the meshes: spi_registers
// Clock     25 MHz -> VCO = 50 MHz * PllFeedback (400 to 800 MHz) -> core = VCO / PllDivide.
//           12 and 6: 100 MHz.  15 and 8: 93.75 MHz.  15 and 6: 125 MHz.
//           At a pixel per clock 100 MHz are 325 frames of 640 x 480 a second.
// Reset     until the PLL has locked; released synchronously.
// Limits    the pattern is Width x Height of the registers after reset; with another WIDTH or HEIGHT
//           written, its frames are cut or long, and led[7] says so.
module top #(
  parameter int MaxWidth = 640,
  parameter int Disparities = 64,
  parameter int CensusFull = 0,
  parameter int Primitives = 1,  // of the ECP5: fs_add_select
  parameter int PllFeedback = 12,
  parameter int PllDivide = 6
) (
  input  logic       clk_25mhz,
  input  logic [6:0] btn,
  input  logic [3:0] sw,
  output logic [7:0] led,
  input  logic       spi_cs_n,
  input  logic       spi_sclk,
  input  logic       spi_mosi,
  output logic       spi_miso
);
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

  // Registers are 0 after configuration, so the reset is there from the start.
  logic [3:0] rst_nq;
  always_ff @(posedge clk) rst_nq <= {rst_nq[2:0], locked & btn[0]};
  logic rst_n;
  assign rst_n = rst_nq[3];

  logic raw_valid, raw_ready, raw_sof, raw_eol;
  logic [7:0] raw_left, raw_right;
  test_pattern #(
    .Width(MaxWidth < fs_pkg::RegWidthReset ? MaxWidth : fs_pkg::RegWidthReset),
    .Height(fs_pkg::RegHeightReset)
  ) u_pattern (
    .clk_i(clk), .rst_ni(rst_n), .valid_o(raw_valid), .ready_i(raw_ready), .sof_o(raw_sof),
    .eol_o(raw_eol), .left_o(raw_left), .right_o(raw_right)
  );

  // The register bus: what the pins ask for goes before what the LEDs do.
  logic write, pins_read, panel_read;
  logic [7:0] pins_address, panel_address;
  logic [31:0] write_data, read_data;
  assign panel_read = ~write & ~pins_read;
  spi_registers u_pins (
    .clk_i(clk), .rst_ni(rst_n),
    .cs_ni(spi_cs_n), .sclk_i(spi_sclk), .mosi_i(spi_mosi), .miso_o(spi_miso),
    .write_o(write), .read_o(pins_read), .address_o(pins_address), .data_o(write_data),
    .data_i(read_data)
  );

  logic valid, sof, eol, eof, bad, read_valid;
  logic [15:0] disparity;
  logic [64:0] unused_link;
  fs_top #(
    .MaxWidth(MaxWidth), .Disparities(Disparities), .CensusFull(CensusFull),
    .Primitives(Primitives)
  ) u_top (
    .clk_i(clk), .rst_ni(rst_n),
    .write_i(write), .read_i(1'b1), .address_i(panel_read ? panel_address : pins_address),
    .data_i(write_data),
    .read_valid_o(read_valid), .data_o(read_data),
    .valid_i(raw_valid), .ready_o(raw_ready), .sof_i(raw_sof), .eol_i(raw_eol),
    .left_i(raw_left), .right_i(raw_right),
    .valid_o(valid), .ready_i(1'b1), .sof_o(sof), .eol_o(eol), .eof_o(eof), .bad_o(bad),
    .disparity_o(disparity), .room_i(1'b1), .bubble_room_i(1'b1),
    .applied_o(unused_link[0]), .frame_in_o(unused_link[1]), .cut_frame_o(unused_link[2]),
    .long_frame_o(unused_link[3]), .width_o(unused_link[15:4]), .height_o(unused_link[27:16]),
    .raw_valid_o(unused_link[28]), .raw_sof_o(unused_link[29]), .raw_left_o(unused_link[37:30]),
    .raw_right_o(unused_link[45:38]), .rectified_valid_o(unused_link[46]),
    .rectified_sof_o(unused_link[47]), .rectified_error_o(unused_link[48]),
    .rectified_left_o(unused_link[56:49]), .rectified_right_o(unused_link[64:57])
  );
  panel u_panel (
    .clk_i(clk), .rst_ni(rst_n), .read_i(panel_read), .address_o(panel_address), .data_i(read_data),
    .eof_i(valid & eof), .bad_i(bad), .sw_i(sw[2:0]), .fire_i(btn[2:1]), .led_o(led)
  );

  logic unused;
  assign unused = ^{btn[6:3], sw[3], read_valid, sof, eol, disparity};
endmodule
