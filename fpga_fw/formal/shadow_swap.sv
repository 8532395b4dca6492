// Formal: fs_registers and fs_input, for any use of the bus and any stream. The configuration in
// effect changes only in the clock after apply_o, all of it at once, to the shadow as it was when
// CONTROL.apply was written, always in range, and never while a frame is in flight. From a write to
// a mesh to that clock, uploading_o is high.
//
// Wires named like the signals of u_input and u_registers in Yosys's flattened netlist connect to
// those signals.
module shadow_swap #(
  parameter int MaxWidth = 640,
  parameter int LineRows = 32
) (
  input logic        clk_i,
  input logic        rst_ni,
  input logic        write_i,
  input logic [7:0]  address_i,
  input logic [31:0] data_i,
  input logic        valid_i,
  input logic        sof_i,
  input logic        eol_i,
  input logic        room_i,
  input logic        bubble_room_i,
  input logic        frame_out_i,
  output logic [3:0] reached_o
);
  localparam int MaxFrames = 8;
  localparam int FrameBits = $clog2(MaxFrames);
  logic [fs_pkg::ConfigBits-1:0] active;
  logic [11:0] width, height, read_pixels;
  logic [7:0] read_rows;
  assign width = active[fs_pkg::ConfigWidthPixelsLsb+:12];
  assign height = active[fs_pkg::ConfigHeightRowsLsb+:12];
  assign read_pixels = active[fs_pkg::ConfigReadStartPixelsLsb+:12];
  assign read_rows = active[fs_pkg::ConfigReadStartRowsLsb+:8];
  logic pending, apply, uploading;
  logic mesh_we, mesh_right, read_valid;
  logic [3:0] mesh_node;
  logic [31:0] mesh_data, data;
  logic busy, frame_in, frame_bad, cut_frame, long_frame;
  fs_registers #(.MaxWidth(MaxWidth), .LineRows(LineRows), .MeshNodes(16)) u_registers (
    .clk_i, .rst_ni, .write_i, .read_i(1'b0), .address_i, .data_i, .read_valid_o(read_valid),
    .data_o(data), .config_o(active), .pending_o(pending), .apply_i(apply),
    .mesh_we_o(mesh_we), .mesh_right_o(mesh_right), .mesh_node_o(mesh_node),
    .mesh_data_o(mesh_data), .uploading_o(uploading),
    .busy_i(busy), .frame_in_i(frame_in), .frame_out_i, .cut_frame_i(cut_frame),
    .long_frame_i(long_frame), .buffer_left_i(1'b0), .buffer_right_i(1'b0), .buffer_frame_i(1'b0),
    .signatures_i('0)
  );
  logic ready, stage_rst_n, en, valid, sof, sol;
  logic [7:0] left, right;
  fs_input #(.GapRows(2), .MaxFrames(MaxFrames)) u_input (
    .clk_i, .rst_ni, .width_i(width), .height_i(height), .valid_i, .ready_o(ready), .sof_i, .eol_i,
    .left_i(8'd0), .right_i(8'd0), .stage_rst_no(stage_rst_n), .en_o(en), .valid_o(valid),
    .sof_o(sof), .sol_o(sol), .left_o(left), .right_o(right),
    .room_i, .bubble_room_i, .frame_out_i, .frame_in_o(frame_in), .frame_bad_o(frame_bad),
    .apply_i(pending), .apply_o(apply), .busy_o(busy), .cut_frame_o(cut_frame),
    .long_frame_o(long_frame)
  );
  (* hierconn *) wire [fs_pkg::ConfigBits-1:0] \u_registers.shadow_q , \u_registers.active_q ;
  (* hierconn *) wire \u_registers.pending_q , \u_registers.check_q , \u_registers.ok ;
  (* hierconn *) wire \u_input.frame_q , \u_input.idle_q , \u_input.full_q ;
  (* hierconn *) wire \u_input.first_q , \u_input.last_q ;
  (* hierconn *) wire [11:0] \u_input.x_q , \u_input.before_last_x_q ;
  (* hierconn *) wire [7:0] \u_input.hold_q ;
  (* hierconn *) wire [FrameBits-1:0] \u_input.in_flight_q ;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // A frame is in flight from the tick of its first pixel until it leaves the pipeline. It leaves
  // only when all of it is inside.
  logic begins, was_frame_q, ended;
  logic [FrameBits-1:0] complete_q, complete;
  assign begins = en & stage_rst_n & sof;
  assign ended = was_frame_q & ~\u_input.frame_q ;
  assign complete = complete_q + FrameBits'(ended) - FrameBits'(frame_out_i);
  always_ff @(posedge clk_i) begin
    was_frame_q <= rst_ni & \u_input.frame_q ;
    complete_q <= rst_ni ? complete : '0;
  end
  always_comb assume (~frame_out_i | complete_q != '0);
  logic in_flight, was_in_flight_q;
  assign in_flight = complete_q != '0 | ended | \u_input.frame_q | begins;

  logic [fs_pkg::ConfigBits-1:0] active_q;           // a clock ago
  logic [fs_pkg::ConfigBits-1:0] asked_q, shadow_q;  // at the write of CONTROL.apply; a clock ago
  logic asks, apply_q, pending_q, reset_q, mesh_we_q, uploading_q;
  assign asks = write_i & address_i == fs_pkg::RegControl & data_i[fs_pkg::ControlApplyLsb];
  logic [11:0] shadow_width, shadow_height, shadow_pixels;
  logic [7:0] shadow_rows;
  assign shadow_width = \u_registers.shadow_q [fs_pkg::ConfigWidthPixelsLsb+:12];
  assign shadow_height = \u_registers.shadow_q [fs_pkg::ConfigHeightRowsLsb+:12];
  assign shadow_pixels = \u_registers.shadow_q [fs_pkg::ConfigReadStartPixelsLsb+:12];
  assign shadow_rows = \u_registers.shadow_q [fs_pkg::ConfigReadStartRowsLsb+:8];
  logic in_range;
  assign in_range = shadow_width >= 12'd16 & shadow_width <= 12'(MaxWidth) &
                    shadow_height >= 12'd1 & shadow_height <= 12'd1200 &
                    shadow_pixels < shadow_width & shadow_rows < 8'(LineRows);
  always_ff @(posedge clk_i) begin
    was_in_flight_q <= in_flight;
    active_q <= active;
    shadow_q <= \u_registers.shadow_q ;
    if (asks) asked_q <= \u_registers.shadow_q ;
    apply_q <= rst_ni & apply;
    pending_q <= \u_registers.pending_q ;
    mesh_we_q <= mesh_we;
    uploading_q <= uploading;
    reset_q <= ~rst_ni;
  end

  logic changed;
  assign changed = started_q & ~reset_q & active != active_q;
  always_comb if (changed) p_only_behind_apply: assert (apply_q & pending_q);
  always_comb if (changed) p_never_in_flight: assert (~in_flight & ~was_in_flight_q);
  always_comb if (changed) p_stages_in_reset: assert (~stage_rst_n);
  always_comb if (started_q & apply_q & pending_q) begin
    p_all_at_once: assert (\u_registers.active_q == shadow_q);
    p_as_asked: assert (\u_registers.active_q == asked_q);
  end
  always_comb if (started_q & ~reset_q)
    p_uploading: assert (uploading == (mesh_we_q | (uploading_q & ~(apply_q & pending_q))));
  always_comb if (started_q) begin
    p_width_in_range: assert (width >= 12'd16 & width <= 12'(MaxWidth));
    p_height_in_range: assert (height >= 12'd1 & height <= 12'd1200);
    p_read_start_in_range: assert (read_pixels < width & read_rows < 8'(LineRows));
  end
  always_comb if (started_q & apply) p_drained: assert (~in_flight & ~(en & valid & stage_rst_n));

  // Invariants for induction.
  logic [3:0] zeros;
  always_comb begin
    zeros = '0;
    for (int i = 0; i < 8; i++) zeros = zeros + 4'(~\u_input.hold_q [i]);
  end
  always_comb if (started_q) begin
    i_in_flight: assert (\u_input.in_flight_q ==
                         complete_q + FrameBits'((ended | \u_input.frame_q ) & ~frame_in));
    i_frame_in: assert (frame_in == begins);
    i_idle: assert (\u_input.idle_q == (\u_input.in_flight_q == '0));
    i_full: assert (\u_input.full_q == (\u_input.in_flight_q == '1));
    i_room: assert (complete_q != '1 | ~(ended | \u_input.frame_q ));
    i_begins: assert (~begins | \u_input.frame_q );
    i_apply: assert (~apply | &\u_input.hold_q );
    // The ones are shifted out at the top.
    i_hold: assert (\u_input.hold_q == 8'(8'hFF << zeros));
    i_still: assert (~\u_input.hold_q [7] | (\u_input.idle_q & ~\u_input.frame_q & ~ended));
    i_reset: assert (stage_rst_n | (\u_input.idle_q & ~\u_input.frame_q & ~ended));
    i_first: assert (\u_input.first_q == (\u_input.x_q == '0));
    i_last_x: assert (\u_input.before_last_x_q == width - 12'd2 | \u_input.hold_q [0] |
                      \u_input.hold_q [1]);
    i_last: assert (\u_input.last_q ==
                    (~\u_input.hold_q [7] & \u_input.x_q == width - 12'd1));
    i_x: assert (\u_input.x_q < width & (~\u_input.hold_q [7] | \u_input.x_q == '0));
    i_valid: assert (~(en & valid & stage_rst_n) | \u_input.frame_q | ended);
  end
  always_comb if (started_q & \u_registers.check_q ) i_ok: assert (\u_registers.ok == in_range);
  always_comb if (started_q & \u_registers.pending_q ) i_pending: assert (in_range);
  always_comb if (started_q & (\u_registers.pending_q | \u_registers.check_q ))
    i_asked: assert (\u_registers.shadow_q == asked_q);

  // Cover: these events are reachable.
  always_ff @(posedge clk_i) begin
    if (~rst_ni) reached_o <= '0;
    else reached_o <= reached_o | {changed & ~uploading_q, changed & uploading_q,
                                   in_flight & pending, \u_registers.check_q & ~\u_registers.ok };
  end
endmodule
