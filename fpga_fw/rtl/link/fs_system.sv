// A whole board without its pins: the stereo pipeline and the board's end of the link.
//
//   cameras -> fs_link -> fs_top -> fs_link -> words        bytes -> fs_link -> registers, pixels
//
// C++ twin  sim::SystemModel (fpga_fw/sim/gateware/system.hpp) simulates this module
// Handshake Streams. Only fs_top itself stalls the cameras' pixels: while a configuration takes
//           effect, and if a frame follows another one too soon.
// Limits    see fs_top, fs_link
module fs_system #(
  parameter int MaxWidth = fs_pkg::DefaultMaxWidth,
  parameter int Disparities = fs_pkg::DefaultDisparities,
  parameter int CensusWindow = fs_pkg::DefaultCensusWindow,
  parameter int CorrelationWindow = fs_pkg::DefaultCorrelationWindow,
  parameter int CensusFull = 0,
  parameter int LineRows = fs_pkg::DefaultLineRows,
  parameter int MeshNodes = fs_pkg::DefaultMeshNodes,
  parameter int Primitives = 0,
  parameter int ClockHz = 100000000,
  parameter int Streams = 126,  // streams to build: bit s for stream s
  parameter int RingRows = 6    // rows in the ring of each stream
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // The line.
  input  logic        rx_valid_i,
  output logic        rx_ready_o,
  input  logic [7:0]  rx_data_i,
  output logic        tx_valid_o,
  input  logic        tx_ready_i,
  output logic [31:0] tx_data_o,
  // The cameras.
  input  logic        valid_i,
  output logic        ready_o,
  input  logic        sof_i,
  input  logic        eol_i,
  input  logic [7:0]  left_i,
  input  logic [7:0]  right_i,
  output logic [11:0] width_o,  // size of the images, in effect
  output logic [11:0] height_o,
  // A stream is on, and no configuration waits for the current frame to end.
  output logic        streaming_o
);
  localparam int MaxFrames = 64;
  logic write, read, read_valid, pixels_valid, pixels_ready, room, bubble_room, applied, frame_in;
  logic cut_frame, long_frame, raw_valid, raw_sof, rectified_valid, rectified_sof, rectified_error;
  logic valid, sof, eol, eof, unused_bad, streaming, pending;
  logic [7:0] address;
  logic [31:0] write_data, read_data;
  logic [17:0] pixels;
  logic [15:0] raw, rectified, disparity;
  fs_link #(
    .MaxWidth(MaxWidth), .ClockHz(ClockHz), .Streams(8'(Streams)), .RingRows(RingRows),
    .MaxFrames(MaxFrames)
  ) u_link (
    .clk_i, .rst_ni, .rx_valid_i, .rx_ready_o, .rx_data_i, .tx_valid_o, .tx_ready_i, .tx_data_o,
    .camera_valid_i(valid_i), .camera_ready_o(ready_o), .camera_i({sof_i, eol_i, left_i, right_i}),
    .write_o(write), .read_o(read), .address_o(address), .data_o(write_data),
    .read_valid_i(read_valid), .data_i(read_data),
    .pixels_valid_o(pixels_valid), .pixels_ready_i(pixels_ready), .pixels_o(pixels),
    .room_o(room), .bubble_room_o(bubble_room), .streaming_o(streaming), .applied_i(applied),
    .frame_in_i(frame_in), .cut_frame_i(cut_frame), .long_frame_i(long_frame), .width_i(width_o), .height_i(height_o),
    .raw_valid_i(raw_valid), .raw_sof_i(raw_sof), .raw_i(raw),
    .rectified_valid_i(rectified_valid), .rectified_sof_i(rectified_sof),
    .rectified_error_i(rectified_error), .rectified_i(rectified),
    .disparity_valid_i(valid), .disparity_sof_i(sof), .disparity_eol_i(eol),
    .disparity_eof_i(eof), .disparity_i(disparity)
  );
  fs_top #(
    .MaxWidth(MaxWidth), .Disparities(Disparities), .CensusWindow(CensusWindow),
    .CorrelationWindow(CorrelationWindow), .CensusFull(CensusFull), .LineRows(LineRows),
    .MeshNodes(MeshNodes), .Primitives(Primitives), .MaxFrames(MaxFrames)
  ) u_top (
    .clk_i, .rst_ni, .write_i(write), .read_i(read), .address_i(address), .data_i(write_data),
    .read_valid_o(read_valid), .data_o(read_data),
    .valid_i(pixels_valid), .ready_o(pixels_ready), .sof_i(pixels[17]), .eol_i(pixels[16]),
    .left_i(pixels[15:8]), .right_i(pixels[7:0]),
    .valid_o(valid), .ready_i(1'b1), .sof_o(sof), .eol_o(eol), .eof_o(eof), .bad_o(unused_bad),
    .disparity_o(disparity),
    .room_i(room), .bubble_room_i(bubble_room), .pending_o(pending), .applied_o(applied),
    .frame_in_o(frame_in), .cut_frame_o(cut_frame), .long_frame_o(long_frame), .width_o, .height_o,
    .raw_valid_o(raw_valid), .raw_sof_o(raw_sof), .raw_left_o(raw[7:0]), .raw_right_o(raw[15:8]),
    .rectified_valid_o(rectified_valid), .rectified_sof_o(rectified_sof),
    .rectified_error_o(rectified_error), .rectified_left_o(rectified[7:0]),
    .rectified_right_o(rectified[15:8])
  );
  always_ff @(posedge clk_i) streaming_o <= streaming & ~pending;
endmodule
