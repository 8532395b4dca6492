// Register table of the sensor MT9V034: 752 x 480 at 30 frames a second.
//
// Formula   With SYSCLK = 25 MHz a row is 752 + 835 clocks, 63.48 us; a frame is 480 + 45 rows:
//           30.0 frames a second. The rows take most of the frame's time, so the link has that time
//           to send them, too (640 px of disparity: 21 MB/s). The exposure is always 236 rows,
//           14.98 ms, in both sensors, so one number gives the time from its middle to the first
//           pixel.
// C++ twin  kSensorTable in test/rtl/board_test.cpp
// Handshake none: a table, index_i to entry
// Limits    Register numbers are those of the data sheet of the MT9V034, context A. Reset
//           values on which the pair depends are written as well. Both sensors are masters with
//           the same clock, reset and writes, so they stay in step; each has its own automatic
//           gain. An exposure of more than 480 rows would make the frames longer.
module fs_mt9v034 (
  input  logic [3:0]  index_i,
  output logic [7:0]  register_o,
  output logic [15:0] value_o,
  output logic        last_o
);
  always_comb begin
    last_o = 1'b0;
    case (index_i)
      4'd0: {register_o, value_o} = {8'h07, 16'h0388};  // master, parallel port, simultaneous
      4'd1: {register_o, value_o} = {8'h01, 16'd1};     // first column
      4'd2: {register_o, value_o} = {8'h02, 16'd4};     // first row
      4'd3: {register_o, value_o} = {8'h03, 16'd480};   // rows
      4'd4: {register_o, value_o} = {8'h04, 16'd752};   // columns
      4'd5: {register_o, value_o} = {8'h05, 16'd835};   // horizontal blanking, clocks
      4'd6: {register_o, value_o} = {8'h06, 16'd45};    // vertical blanking, rows
      4'd7: {register_o, value_o} = {8'h0D, 16'h0300};  // no binning, no flip
      4'd8: {register_o, value_o} = {8'h0B, 16'd236};   // exposure, rows
      default: begin
        {register_o, value_o} = {8'hAF, 16'h0002};      // automatic gain, exposure as written
        last_o = 1'b1;
      end
    endcase
  end
endmodule
