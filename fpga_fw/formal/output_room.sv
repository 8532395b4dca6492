// Formal: fs_output loses no word, for any raster whose ticks were decided on while there was room
// (input_raster: p_room), any configuration and any ready; and its stream obeys the rules.
//
// Wires named like u_output's signals in Yosys's flattened netlist connect to those signals.
module output_room #(
  parameter int EnableClocks = 0
) (
  input logic        clk_i,
  input logic        rst_ni,
  input logic [11:0] width_i,
  input logic [11:0] height_i,
  input logic        stage_rst_ni,
  input logic        en_i,
  input logic        valid_i,
  input logic        sof_i,
  input logic        sol_i,
  input logic [15:0] disparity_i,
  input logic        frame_in_i,
  input logic        frame_bad_i,
  input logic        buffer_sof_i,
  input logic        buffer_error_i,
  input logic        ready_i,
  output logic [2:0] reached_o
);
  logic room_o, frame_out_o, buffer_frame_o, valid_o, sof_o, eol_o, eof_o, bad_o;
  logic [15:0] disparity_o;
  fs_output #(.MaxFrames(4), .EnableClocks(EnableClocks)) u_output (
    .clk_i, .rst_ni, .width_i, .height_i, .stage_rst_ni, .en_i, .valid_i, .sof_i, .sol_i,
    .disparity_i, .room_i(1'b1), .room_o, .frame_out_o, .frame_in_i, .frame_bad_i, .buffer_sof_i,
    .buffer_error_i, .buffer_frame_o, .valid_o, .ready_i, .sof_o, .eol_o, .eof_o, .bad_o, .disparity_o
  );
  (* hierconn *) wire \u_output.push_q , \u_output.unused_ready ;
  (* hierconn *) wire [4:0] \u_output.count ;
  (* hierconn *) wire [19:0] \u_output.word_q ;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // A tick in this clock was decided on EnableClocks + 1 clocks ago.
  logic held_q;
  logic [19:0] held_word_q;
  logic [EnableClocks:0] rooms_q;  // [k]: room_o k + 1 clocks ago
  always_comb assume (~(en_i & stage_rst_ni) | rooms_q[EnableClocks]);
  always_ff @(posedge clk_i) begin
    rooms_q <= rst_ni ? (EnableClocks + 1)'({rooms_q, room_o}) : '0;
    held_q <= rst_ni & valid_o & ~ready_i;
    held_word_q <= {bad_o, eof_o, eol_o, sof_o, disparity_o};
  end

  always_comb if (started_q & \u_output.push_q ) p_no_word_lost: assert (\u_output.unused_ready );
  always_comb if (started_q & held_q) begin
    p_valid_stays: assert (valid_o);
    p_payload_stays: assert ({bad_o, eof_o, eol_o, sof_o, disparity_o} == held_word_q);
  end
  always_comb if (started_q)
    p_frame_out: assert (frame_out_o == (\u_output.push_q & \u_output.word_q [18]));
  always_comb if (started_q & \u_output.push_q ) begin
    p_eof_ends_a_line: assert (~\u_output.word_q [18] | \u_output.word_q [17]);
    p_bad_with_eof_only: assert (~\u_output.word_q [19] | \u_output.word_q [18]);
  end

  // Invariants for induction: the words on their way have room; the more recently there was
  // room, the fewer they are.
  always_comb if (started_q) i_count: assert (\u_output.count <= 5'd16);
  logic [4:0] words, most;
  assign words = \u_output.count + 5'(\u_output.push_q );
  always_comb begin
    most = 5'd16;
    for (int k = EnableClocks; k >= 0; k--) if (rooms_q[k]) most = 5'(15 - EnableClocks + k);
    if (room_o) most = 5'(14 - EnableClocks);
  end
  always_comb if (started_q) i_on_the_way: assert (words <= most);

  // Cover: these events are reachable.
  always_ff @(posedge clk_i) begin
    if (~rst_ni) reached_o <= '0;
    else reached_o <= reached_o | {\u_output.count > 5'd13, frame_out_o, ~room_o & rooms_q[0]};
  end
endmodule
