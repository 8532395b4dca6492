// Connects fs_cameras to fs_input, so that a test sees what the pipeline receives for a cut frame.
// frame_out_i follows frame_in_o by one clock: each frame counts as out as soon as it has begun.
module camera_raster #(
  parameter int SensorWidth = 32,
  parameter int SensorHeight = 48
) (
  input  logic [1:0]  pixclk_i,
  input  logic [1:0]  frame_valid_i,
  input  logic [1:0]  line_valid_i,
  input  logic [15:0] data_i,
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        room_i,
  output logic        en_o,
  output logic        valid_o,
  output logic        sof_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o,
  output logic        cut_frame_o,
  output logic        long_frame_o
);
  logic valid, ready, sof, eol, frame_in, frame_in_q;
  logic [7:0] left, right;
  logic unused_frame, unused_sol, unused_bad, unused_apply, unused_busy, unused_rst_n;
  logic [7:0] unused_errors, unused_overruns;
  fs_cameras #(
    .SensorWidth(SensorWidth), .SensorHeight(SensorHeight), .MaxSkew(40), .MaxSilence(1000),
    .Depth(64)
  ) u_cameras (
    .pixclk_i, .frame_valid_i, .line_valid_i, .data_i, .clk_i, .rst_ni,
    .width_i(12'(SensorWidth)), .height_i(12'(SensorHeight)), .valid_o(valid), .ready_i(ready),
    .sof_o(sof), .eol_o(eol), .left_o(left), .right_o(right), .frame_o(unused_frame),
    .errors_o(unused_errors), .overruns_o(unused_overruns)
  );
  always_ff @(posedge clk_i) frame_in_q <= frame_in;
  fs_input u_input (
    .clk_i, .rst_ni, .width_i(12'(SensorWidth)), .height_i(12'(SensorHeight)), .valid_i(valid),
    .ready_o(ready), .sof_i(sof), .eol_i(eol), .left_i(left), .right_i(right),
    .stage_rst_no(unused_rst_n), .en_o, .valid_o, .sof_o, .sol_o(unused_sol), .left_o, .right_o,
    .room_i, .bubble_room_i(1'b1), .frame_out_i(frame_in_q), .frame_in_o(frame_in),
    .frame_bad_o(unused_bad), .apply_i(1'b0), .apply_o(unused_apply), .busy_o(unused_busy),
    .cut_frame_o, .long_frame_o
  );
endmodule
