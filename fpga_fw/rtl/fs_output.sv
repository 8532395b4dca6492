// Turns the raster after the last stage into the stream of disparities.
//
// Formula   One word per pixel of a frame: disparity, sof (first pixel of the frame), eol (last of
//           the row), eof (last of the frame), bad (with eof: the frame was cut or long, or rectify
//           lacked pixels of it).
// Schedule  tick      registers the pixel and its position in the frame
//           clock 1   into fs_stream_fifo; room_o follows in clock 3
//           Bad frames are reported by two sources, each in the order of frames: the input
//           (frame_in_i, then frame_bad_i) and rectify (buffer_sof_i, then buffer_error_i).
// Latency   3 clocks from the tick to valid_o.
// Handshake Raster in, stream out. room_o says that room_i was high and that the FIFO can take 4
//           more words plus EnableClocks: that many may be on their way when fs_input reads room_o,
//           as its en_o arrives here EnableClocks later. While stage_rst_ni is low the raster is
//           ignored.
// Limits    MaxFrames as in fs_input. A flag must come 4 clocks before its frame's last tick.
module fs_output #(
  parameter int MaxFrames = 256,
  parameter int EnableClocks = 0  // 0 to 8: clocks from fs_input's tick to en_i
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  // The raster.
  input  logic        stage_rst_ni,
  input  logic        en_i,
  input  logic        valid_i,
  input  logic        sof_i,
  input  logic        sol_i,
  input  logic [15:0] disparity_i,
  // To and from the input. Pulses.
  input  logic        room_i,          // room further downstream
  output logic        room_o,
  output logic        frame_out_o,     // a frame's last pixel has left the pipeline
  input  logic        frame_in_i,      // a frame has begun
  input  logic        frame_bad_i,     // the frame that began last is bad
  // From rectify's raster, sampled at ticks.
  input  logic        buffer_sof_i,    // first pixel of a frame
  input  logic        buffer_error_i,  // error in the frame of the last sof
  output logic        buffer_frame_o,  // pulse: a frame with such an error has left the pipeline
  // The stream.
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic        eof_o,
  output logic        bad_o,
  output logic [15:0] disparity_o
);
  localparam int Depth = 16;
  localparam int OnTheWay = 4 + EnableClocks;
  localparam int FrameBits = $clog2(MaxFrames);
  if (MaxFrames < 4 || MaxFrames != 1 << FrameBits)
    initial $fatal(1, "fs_output: MaxFrames is %0d, allowed: 4, 8, 16, ..", MaxFrames);
  if (EnableClocks < 0 || EnableClocks > 8)
    initial $fatal(1, "fs_output: EnableClocks is %0d, allowed: 0 to 8", EnableClocks);

  // Position of the pixel.
  logic tick, take;
  assign tick = en_i & stage_rst_ni;
  assign take = tick & valid_i;
  logic [11:0] x, y, last_x_q, last_y_q;
  fs_position u_position (
    .clk_i, .rst_ni(stage_rst_ni), .en_i(tick), .valid_i, .sof_i, .sol_i, .x_o(x), .y_o(y)
  );
  // The last-row flag may be two clocks late: the last column is not among the first two.
  logic [11:0] y_q;
  logic last_column, last_row_q, last;
  assign last_column = x == last_x_q;
  assign last = last_column & last_row_q;

  // Bad frames by source: 0 is the input, 1 is rectify.
  logic [1:0] began, told, bad;
  assign began = {tick & buffer_sof_i, frame_in_i};
  assign told = {tick & buffer_error_i, frame_bad_i};
  logic [FrameBits-1:0] out_q;  // number of the frame that leaves next
  always_ff @(posedge clk_i) begin
    if (!rst_ni) out_q <= '0;
    else if (frame_out_o) out_q <= out_q + 1'b1;
  end
  for (genvar source = 0; source < 2; source++) begin : g_source
    fs_frame_flags #(.MaxFrames(MaxFrames), .Flags(1), .Readers(1)) u_flags (
      .clk_i, .rst_ni, .began_i(began[source]), .told_i(told[source]), .number_i(out_q),
      .flags_o(bad[source])
    );
  end

  // The word.
  logic push_q;
  logic [19:0] word_q;
  always_ff @(posedge clk_i) begin
    last_x_q <= width_i - 12'd1;
    last_y_q <= height_i - 12'd1;
    y_q <= y;
    last_row_q <= y_q == last_y_q;
    word_q <= {last & |bad, last, last_column, sof_i, disparity_i};
    push_q <= rst_ni & take;
    frame_out_o <= rst_ni & take & last;
    buffer_frame_o <= rst_ni & take & last & bad[1];
  end

  logic unused_ready;
  logic [$clog2(Depth):0] count;
  fs_stream_fifo #(.Bits(20), .Depth(Depth)) u_fifo (
    .clk_i, .rst_ni,
    .valid_i(push_q), .ready_o(unused_ready), .data_i(word_q),
    .valid_o, .ready_i, .data_o({bad_o, eof_o, eol_o, sof_o, disparity_o}),
    .count_o(count)
  );
  always_ff @(posedge clk_i) begin
    room_o <= rst_ni & room_i & count <= ($clog2(Depth) + 1)'(Depth - OnTheWay);
  end
endmodule
