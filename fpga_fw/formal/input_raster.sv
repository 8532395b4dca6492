// Formal: fs_input turns any stream into a raster, for any width and height, any room, and any
// times at which frames leave the pipeline and configurations come.
//
// A model of the raster runs in parallel. Wires named like u_input's signals in Yosys's flattened
// netlist connect to those signals.
module input_raster #(
  parameter int GapRows = 2,
  parameter int MaxFrames = 8
) (
  input logic        clk_i,
  input logic        rst_ni,
  input logic [11:0] width_i,
  input logic [11:0] height_i,
  input logic        valid_i,
  input logic        sof_i,
  input logic        eol_i,
  input logic        room_i,
  input logic        bubble_room_i,
  input logic        frame_out_i,
  input logic        apply_i,
  output logic [4:0] reached_o
);
  localparam int FrameBits = $clog2(MaxFrames);
  localparam int GapBits = $clog2(GapRows + 2);
  logic ready_o, stage_rst_no, en_o, valid_o, sof_o, sol_o, frame_in_o, frame_bad_o, apply_o;
  logic busy_o, cut_frame_o, long_frame_o;
  logic [7:0] left_o, right_o;
  fs_input #(.GapRows(GapRows), .MaxFrames(MaxFrames)) u_input (
    .clk_i, .rst_ni, .width_i, .height_i, .valid_i, .ready_o, .sof_i, .eol_i,
    .left_i(8'd0), .right_i(8'd0),
    .stage_rst_no, .en_o, .valid_o, .sof_o, .sol_o, .left_o, .right_o,
    .room_i, .bubble_room_i, .frame_out_i, .frame_in_o, .frame_bad_o, .apply_i, .apply_o, .busy_o,
    .cut_frame_o, .long_frame_o
  );
  (* hierconn *) wire [7:0] \u_input.hold_q ;
  (* hierconn *) wire [11:0] \u_input.x_q , \u_input.y_q ;
  (* hierconn *) wire [11:0] \u_input.before_last_x_q , \u_input.before_last_y_q ;
  (* hierconn *) wire \u_input.one_row_q , \u_input.first_q , \u_input.last_q ;
  (* hierconn *) wire \u_input.frame_q , \u_input.last_row_q , \u_input.idle_q , \u_input.full_q ;
  (* hierconn *) wire \u_input.spaced_q ;
  (* hierconn *) wire [FrameBits-1:0] \u_input.in_flight_q ;
  (* hierconn *) wire [GapBits-1:0] \u_input.gap_q ;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // The raster, and the expected position of the next tick.
  logic tick, row_end, frame_end, begins;
  logic [11:0] x_q, y_q;         // position of the next tick
  logic open_q, row_valid_q;     // inside a frame; kind of the current row
  logic spaced_q, spaced;        // GapRows bubble rows lie behind the last frame
  logic [GapBits-1:0] gap_q, gap;
  logic [FrameBits-1:0] complete_q;  // frames that are entirely in the pipeline
  logic [11:0] last_x, last_y;
  assign last_x = width_i - 12'd1;
  assign last_y = height_i - 12'd1;
  assign tick = en_o & stage_rst_no;
  assign begins = tick & sof_o;
  assign row_end = tick & x_q == last_x;
  assign frame_end = row_end & valid_o & (begins ? height_i == 12'd1 : y_q == last_y);
  assign gap = frame_end ? '0 : gap_q + GapBits'(row_end & ~valid_o);
  assign spaced = frame_end ? GapRows == 0 : spaced_q | (row_end & gap == GapBits'(GapRows));
  logic [11:0] was_width_q, was_height_q;
  logic room_q, reset_q, was_apply_q;
  logic [FrameBits-1:0] complete;
  assign complete = complete_q + FrameBits'(frame_end) - FrameBits'(frame_out_i);
  always_ff @(posedge clk_i) begin
    room_q <= room_i;
    reset_q <= ~rst_ni;
    was_apply_q <= rst_ni & apply_o;
    was_width_q <= width_i;
    was_height_q <= height_i;
    if (~rst_ni | ~stage_rst_no) begin
      x_q <= '0;
      open_q <= 1'b0;
      spaced_q <= 1'b1;
    end else if (tick) begin
      x_q <= row_end ? '0 : x_q + 12'd1;
      if (x_q == '0) row_valid_q <= valid_o;
      open_q <= valid_o & ~frame_end;
      y_q <= begins ? '0 : y_q + 12'(row_end);
      gap_q <= gap;
      spaced_q <= spaced;
    end
    complete_q <= rst_ni ? complete : '0;
  end

  // Environment: a configuration is in range and changes only with apply_o; a frame leaves the
  // pipeline only when all of it is inside.
  logic same;
  assign same = width_i == was_width_q & height_i == was_height_q;
  always_comb begin
    assume (width_i >= 12'd16);
    assume (height_i >= 12'd1);
    assume (same | was_apply_q | reset_q);
    assume (~frame_out_i | complete_q != '0);
  end

  // Rows of exactly width ticks, all of a frame or all bubbles; frames of exactly height rows.
  always_comb if (started_q & tick) p_sol: assert (sol_o == (x_q == '0));
  always_comb if (started_q & tick & x_q != '0) p_row_of_one_kind: assert (valid_o == row_valid_q);
  always_comb if (started_q & tick & sof_o) p_sof: assert (sol_o & valid_o & ~open_q);
  always_comb if (started_q & tick & sol_o) p_valid: assert (valid_o == (open_q | sof_o));
  always_comb if (started_q & begins) p_distance: assert (spaced_q);
  // Every tick was decided on while there was room.
  always_comb if (started_q & tick) p_room: assert (room_q);
  // Resets of the stages; changes of the configuration.
  always_comb if (started_q & ~stage_rst_no & ~reset_q)
    p_reset: assert (en_o & ~valid_o & ~sof_o & ~sol_o);
  always_comb if (started_q & reset_q) p_no_tick_in_reset: assert (~en_o & ~stage_rst_no);
  always_comb if (started_q & apply_o) p_apply_between_rows: assert (x_q == '0 & ~open_q & ~tick);
  always_comb if (started_q & apply_o) p_apply_when_drained: assert (complete_q == '0);
  always_comb if (started_q & was_apply_q) p_apply_resets: assert (~stage_rst_no);
  // Frames in flight.
  always_comb if (started_q)
    p_in_flight: assert (\u_input.in_flight_q == complete_q + FrameBits'(open_q));
  always_comb if (started_q & (open_q | begins)) p_never_too_many: assert (complete_q != '1);
  always_comb if (started_q) p_busy: assert (busy_o == (\u_input.in_flight_q != '0));

  // Invariants for induction: fs_input's state equals the model's, except for the tick on the
  // raster.
  logic [11:0] next_x, next_y;
  assign next_x = row_end ? '0 : x_q + 12'(tick);
  assign next_y = begins ? '0 : y_q;
  always_comb if (started_q) i_hold: assert (
      \u_input.hold_q == 8'hFF | \u_input.hold_q == 8'hFE | \u_input.hold_q == 8'hFC |
      \u_input.hold_q == 8'hF8 | \u_input.hold_q == 8'hF0 | \u_input.hold_q == 8'hE0 |
      \u_input.hold_q == 8'hC0 | \u_input.hold_q == 8'h80 | \u_input.hold_q == 8'h00);
  always_comb if (started_q & was_apply_q) i_hold_after: assert (\u_input.hold_q == 8'hFE);
  always_comb if (started_q & apply_o) i_hold_apply: assert (\u_input.hold_q == 8'hFF);
  always_comb if (started_q & (reset_q | &\u_input.hold_q ))
    i_hold_reset: assert (&\u_input.hold_q & (apply_o | reset_q));
  always_comb if (started_q & ~\u_input.hold_q [7] & ~stage_rst_no)
    i_running: assert (x_q == '0 & ~open_q);
  always_comb if (started_q & stage_rst_no) i_stage_reset: assert (~\u_input.hold_q [7] | apply_o);
  always_comb if (started_q & ~|(\u_input.hold_q & 8'h02)) begin
    i_last_x: assert (\u_input.before_last_x_q == width_i - 12'd2);
    i_last_y: assert (\u_input.before_last_y_q == height_i - 12'd2);
    i_one_row: assert (\u_input.one_row_q == (height_i == 12'd1));
  end
  always_comb if (started_q & \u_input.hold_q [7]) i_still: assert (
      \u_input.x_q == '0 & ~\u_input.frame_q & complete_q == '0 & ~\u_input.last_q &
      \u_input.spaced_q );
  always_comb if (started_q & ~\u_input.hold_q [7]) begin
    i_x: assert (\u_input.x_q == next_x);
    i_last: assert (\u_input.last_q == (\u_input.x_q == last_x));
  end
  always_comb if (started_q) begin
    i_first: assert (\u_input.first_q == (\u_input.x_q == '0));
    i_in_row: assert (x_q <= last_x | ~stage_rst_no);
    i_frame: assert (\u_input.frame_q == ((tick ? valid_o & ~frame_end : open_q) & stage_rst_no));
    i_idle: assert (\u_input.idle_q == (\u_input.in_flight_q == '0));
    i_full: assert (\u_input.full_q == (\u_input.in_flight_q == '1));
    i_row_valid: assert (x_q == '0 | ~stage_rst_no | row_valid_q == open_q | ~open_q);
    i_open: assert (x_q == '0 | ~stage_rst_no | open_q == row_valid_q);
  end
  always_comb if (started_q & \u_input.frame_q ) begin
    i_y: assert (\u_input.y_q == (begins ? 12'd0 : y_q + 12'(row_end)));
    i_last_row: assert (\u_input.last_row_q == (\u_input.y_q == last_y));
    i_height: assert (\u_input.y_q <= last_y);
  end
  always_comb if (started_q & stage_rst_no & ~apply_o & ~\u_input.spaced_q ) begin
    i_gap: assert (\u_input.gap_q == (tick ? gap : gap_q));
    i_gap_short: assert (\u_input.gap_q < GapBits'(GapRows));
    i_gap_between_frames: assert (~\u_input.frame_q );
  end
  always_comb if (started_q & ~\u_input.hold_q [7]) i_spaced: assert (
      \u_input.spaced_q == (tick ? spaced : spaced_q) | ~stage_rst_no);

  // Cover: these events are reachable.
  always_ff @(posedge clk_i) begin
    if (~rst_ni) reached_o <= '0;
    else reached_o <= reached_o | {apply_o & row_valid_q, cut_frame_o, long_frame_o,
                                   frame_end & complete_q != '0, tick & ~valid_o};
  end
endmodule
