// Turns the stream of pixel pairs into the raster: makes the pipeline's ticks.
//
// Formula   Rows have exactly width_i ticks. A row is either a row of a frame or a bubble row: a
//           frame in flight needs further ticks to leave the pipeline. In each clock in which the
//           output has room:
//             in a frame      a tick with the next pixel as soon as it arrives, or with 0 in place
//                             of a missing pixel
//             between frames  a tick with a frame's first pixel if it has arrived, the previous row
//                             is complete and GapRows bubble rows lie behind the last frame; else a
//                             tick of a bubble row if such a row has begun, frames are in flight,
//                             or the waiting frame needs the gap; else no tick.
//                             While no frame waits for them, bubbles also wait for bubble_room_i,
//                             so the tail of a frame leaves the pipeline only as fast as it is read
//           Frames that are not width_i x height_i:
//             line too short   eol comes early: the rest of the line is 0
//             line too long    pixels after the width_i-th are dropped, up to eol or sof
//             frame too short  sof comes early, anywhere: the rest of the frame is 0, at one tick
//                              per clock, while the new frame waits
//             frame too long   pixels after the last row are dropped, up to sof; so are pixels
//                              before the first sof
//           A frame is cut if a pixel of it was filled in, and long if one was dropped. If a
//           surplus pixel arrives after the frame has left the pipeline, only the counter reports
//           it.
// C++ twin  expected_frames() in test/rtl/input_output_rig.hpp
// Schedule  clock 1, 2  fs_stream_fifo, so that ready_o is a register
//           clock 3     decision; loads en_o and the raster
//           clock 4     en_o = 1 and the raster holds the pixel that this tick consumes
//           New configuration: while apply_i is high no frame begins. When nothing is in flight and
//           the row is complete, apply_o is high for one clock. The configuration changes in the
//           next clock; the stages are in reset in that clock and the 7 after it.
// Latency   3 clocks from a pixel to its tick if the pipeline was empty.
// Handshake Stream in; raster with its enable out. room_i: there is room for the tick decided on in
//           this clock, the one now on the raster and the two before it. While stage_rst_no is low,
//           en_o is high and all tags are 0; the output of the pipeline is then to be ignored.
// Limits    16 <= width_i, 1 <= height_i; they change only in the clock after apply_o. Fewer than
//           MaxFrames frames in flight: a further one waits.
module fs_input #(
  parameter int GapRows = 7,     // bubble rows between two frames, at least
  parameter int MaxFrames = 256  // a power of two
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  // The stream.
  input  logic        valid_i,
  output logic        ready_o,
  input  logic        sof_i,
  input  logic        eol_i,
  input  logic [7:0]  left_i,
  input  logic [7:0]  right_i,
  // The raster.
  output logic        stage_rst_no,
  output logic        en_o,
  output logic        valid_o,
  output logic        sof_o,
  output logic        sol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o,
  // To and from the end of the pipeline. Pulses.
  input  logic        room_i,
  input  logic        bubble_room_i,  // for bubble rows: also room for what they push out
  input  logic        frame_out_i,  // the last pixel of a frame has left the pipeline
  output logic        frame_in_o,   // a frame has begun
  output logic        frame_bad_o,  // the frame that began last is cut or long
  // To and from the registers.
  input  logic        apply_i,  // level: a configuration waits to be applied
  output logic        apply_o,  // pulse: apply it now
  output logic        busy_o,   // a frame is in flight
  output logic        cut_frame_o,  // pulses, once per frame
  output logic        long_frame_o
);
  localparam int ResetClocks = 8;
  localparam int FrameBits = $clog2(MaxFrames);
  localparam int GapBits = $clog2(GapRows + 2);
  if (GapRows < 0) initial $fatal(1, "fs_input: GapRows is %0d, allowed: 0 or more", GapRows);
  if (MaxFrames < 4 || MaxFrames != 1 << FrameBits)
    initial $fatal(1, "fs_input: MaxFrames is %0d, allowed: 4, 8, 16, ..", MaxFrames);

  // The pixel at the head of the stream.
  logic head_valid, head_ready, head_sof, head_eol;
  logic [7:0] head_left, head_right;
  logic [4:0] unused_count;
  fs_stream_fifo #(.Bits(18), .Depth(16)) u_fifo (
    .clk_i, .rst_ni,
    .valid_i, .ready_o, .data_i({sof_i, eol_i, left_i, right_i}),
    .valid_o(head_valid), .ready_i(head_ready),
    .data_o({head_sof, head_eol, head_left, head_right}),
    .count_o(unused_count)
  );

  logic running;                         // the stages are not in reset
  logic frame_q;                         // the next tick belongs to a frame in progress
  logic first_q, last_q;                 // the next tick is the first (last) one of its row
  logic last_row_q;                      // this is the last row of the frame
  logic pad_line_q, drop_line_q;         // fill with 0 (drop) up to the end of the line
  logic seen_q, cut_q, long_q;           // state of the frame that began last
  logic idle_q, full_q, spaced_q;        // no frame in flight; too many; the gap is complete

  // Decisions of this clock.
  logic sof_waits, pads, begins, bubbles, tick, begin_tick, take, drop, apply;
  always_comb begin
    sof_waits = head_valid & head_sof;
    pads = pad_line_q | sof_waits;
    begins = ~frame_q & first_q & sof_waits & spaced_q & ~full_q & ~apply_i;
    bubbles = ~frame_q & (~first_q | ~idle_q | (sof_waits & ~spaced_q & ~apply_i));
    tick = running & room_i &
           (begins | (bubbles & (bubble_room_i | sof_waits)) |
            (frame_q & (pads | (head_valid & ~drop_line_q))));
    begin_tick = tick & begins;
    take = tick & (frame_q ? ~pads : begins);
    drop = head_valid & ~head_sof & (~frame_q | drop_line_q);
    apply = running & ~frame_q & first_q & idle_q & apply_i;
  end
  assign head_ready = take | drop;

  // Columns.
  logic [11:0] x_q, before_last_x_q;
  always_ff @(posedge clk_i) begin
    before_last_x_q <= width_i - 12'd2;
    if (!rst_ni) begin
      x_q <= '0;
      first_q <= 1'b1;
      last_q <= 1'b0;
    end else if (tick) begin
      x_q <= last_q ? '0 : x_q + 12'd1;
      first_q <= last_q;
      last_q <= x_q == before_last_x_q;
    end
  end

  // Rows of the frame, and bubble rows behind it.
  logic [11:0] y_q, before_last_y_q;
  logic [GapBits-1:0] gap_q;
  logic one_row_q, frame_end, gap_end;
  assign frame_end = tick & last_q & frame_q & last_row_q;
  assign gap_end = tick & last_q & ~frame_q & gap_q == GapBits'(GapRows - 1);
  always_ff @(posedge clk_i) begin
    before_last_y_q <= height_i - 12'd2;
    one_row_q <= height_i == 12'd1;
    if (begin_tick) begin
      y_q <= '0;
      last_row_q <= one_row_q;
    end else if (tick & last_q) begin
      y_q <= y_q + 12'd1;
      last_row_q <= y_q == before_last_y_q;
    end
    if (tick & last_q) gap_q <= frame_q ? '0 : gap_q + 1'b1;
    if (!rst_ni) begin
      frame_q <= 1'b0;
      spaced_q <= 1'b1;
    end else begin
      if (begin_tick) frame_q <= 1'b1;
      if (frame_end) frame_q <= 1'b0;
      if (frame_end) spaced_q <= GapRows == 0;
      if (gap_end | apply) spaced_q <= 1'b1;
    end
  end

  // Lines and frames that are too short or too long.
  logic cut, too_long;
  assign cut = frame_q & tick & pads & ~cut_q;
  assign too_long = drop & seen_q & ~long_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      pad_line_q <= 1'b0;
      drop_line_q <= 1'b0;
      seen_q <= 1'b0;
      cut_q <= 1'b0;
      long_q <= 1'b0;
      cut_frame_o <= 1'b0;
      long_frame_o <= 1'b0;
      frame_in_o <= 1'b0;
    end else begin
      if (tick & last_q) pad_line_q <= 1'b0;
      else if (take & head_eol) pad_line_q <= 1'b1;
      if (take) drop_line_q <= last_q & ~head_eol;
      else if (drop & head_eol) drop_line_q <= 1'b0;
      if (begin_tick) seen_q <= 1'b1;
      cut_q <= (cut_q | cut) & ~begin_tick;
      long_q <= (long_q | too_long) & ~begin_tick;
      cut_frame_o <= cut;
      long_frame_o <= too_long;
      frame_in_o <= begin_tick;
    end
  end
  assign frame_bad_o = cut_frame_o | long_frame_o;

  // Frames in flight, counted one clock late. That is harmless, as every row has more clocks.
  logic [FrameBits-1:0] in_flight_q, in_flight_d;
  assign in_flight_d = in_flight_q + FrameBits'(frame_in_o) - FrameBits'(frame_out_i);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      in_flight_q <= '0;
      idle_q <= 1'b1;
      full_q <= 1'b0;
    end else begin
      in_flight_q <= in_flight_d;
      idle_q <= in_flight_d == '0;
      full_q <= in_flight_d == '1;
    end
  end
  assign busy_o = ~idle_q;

  // New configuration, reset of the stages.
  logic [ResetClocks-1:0] hold_q;
  assign running = ~hold_q[ResetClocks-1];
  always_ff @(posedge clk_i) begin
    if (!rst_ni | apply) hold_q <= '1;
    else hold_q <= hold_q << 1;
    apply_o <= rst_ni & apply;
    stage_rst_no <= rst_ni & running;
  end

  // The raster.
  always_ff @(posedge clk_i) begin
    en_o <= rst_ni & (tick | ~running);
    if (!rst_ni | !running) begin
      valid_o <= 1'b0;
      sof_o <= 1'b0;
      sol_o <= 1'b0;
    end else if (tick) begin
      valid_o <= frame_q | begins;
      sof_o <= begins;
      sol_o <= first_q;
    end
    if (tick) begin
      left_o <= take ? head_left : '0;
      right_o <= take ? head_right : '0;
    end
  end
endmodule
