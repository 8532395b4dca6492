// Two sensors: from their ports to the pairs that fs_system takes.
//
//   fs_camera, fs_camera -> fs_camera_pair -> a FIFO of Depth pairs
//
// Formula   see fs_camera_pair
// C++ twin  test/rtl/link/camera_test.cpp
// Schedule  see fs_camera, fs_camera_pair
// Latency   3 clocks of the pixel clock and some 9 of clk_i from the pins to the output
// Handshake Stream out. fs_input stalls it if a frame comes before a row of ticks is complete: for
//           a row of clocks at most, some 270 pixels at 25 MHz with clk_i at 60 MHz. Depth covers
//           that. The gap that fs_input needs between frames lies in the sensors' blanking.
//           There are longer stalls: up to 41 rows of clocks when a configuration takes
//           effect while a slow line still holds the previous frame; and up to a frame of clocks
//           when a new height, or sensors that stopped, make fs_input fill up the previous frame.
//           Then the frame is cut, fs_camera_pair fills in its missing lines, and the next one is
//           whole. errors_o counts frames that were not whole, overruns_o frames that found no
//           room, both modulo 256.
// Limits    Pixels come at no more than half of clk_i's rate. A frame and its blanking must take
//           longer than its ticks plus the stalls; otherwise the next frame is cut, too.
module fs_cameras #(
  parameter int SensorWidth = 752,
  parameter int SensorHeight = 480,
  parameter int MaxSkew = 128,
  parameter int MaxSilence = 16383,
  parameter int Depth = 1024
) (
  // The ports: {left, right}.
  input  logic [1:0]  pixclk_i,
  input  logic [1:0]  frame_valid_i,
  input  logic [1:0]  line_valid_i,
  input  logic [15:0] data_i,
  // The pairs.
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o,
  output logic        frame_o,    // pulse: both sensors' frames were whole
  output logic [7:0]  errors_o,
  output logic [7:0]  overruns_o
);
  logic [1:0] valid, ready, sof, eol, eof, overrun;
  logic [15:0] data;
  for (genvar k = 0; k < 2; k++) begin : g_camera
    fs_camera u_camera (
      .pixclk_i(pixclk_i[k]), .frame_valid_i(frame_valid_i[k]), .line_valid_i(line_valid_i[k]),
      .data_i(data_i[8*k+:8]), .clk_i, .rst_ni, .valid_o(valid[k]), .ready_i(ready[k]),
      .sof_o(sof[k]), .eol_o(eol[k]), .eof_o(eof[k]), .data_o(data[8*k+:8]),
      .overrun_o(overrun[k])
    );
  end

  logic pair_valid, pair_ready, pair_sof, pair_eol, error;
  logic [7:0] pair_left, pair_right;
  fs_camera_pair #(
    .SensorWidth(SensorWidth), .SensorHeight(SensorHeight), .MaxSkew(MaxSkew),
    .MaxSilence(MaxSilence)
  ) u_pair (
    .clk_i, .rst_ni, .width_i, .height_i, .valid_i(valid), .ready_o(ready), .sof_i(sof),
    .eol_i(eol), .eof_i(eof), .data_i(data), .error_o(error), .frame_o, .valid_o(pair_valid),
    .ready_i(pair_ready), .sof_o(pair_sof), .eol_o(pair_eol), .left_o(pair_left),
    .right_o(pair_right)
  );
  fs_block_fifo #(.Bits(18), .Depth(Depth)) u_fifo (
    .clk_i, .rst_ni, .valid_i(pair_valid), .ready_o(pair_ready),
    .data_i({pair_sof, pair_eol, pair_left, pair_right}), .valid_o, .ready_i,
    .data_o({sof_o, eol_o, left_o, right_o})
  );

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      errors_o <= '0;
      overruns_o <= '0;
    end else begin
      errors_o <= errors_o + 8'(error);
      overruns_o <= overruns_o + 8'(overrun[0]) + 8'(overrun[1]);
    end
  end
endmodule
