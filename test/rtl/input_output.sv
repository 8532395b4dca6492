// Test top: input and output of the pipeline with its registers and signatures. In place of the
// stages stand two delays, named after the first and the last stage:
// fs_input -> "rectify" -> "speckle" -> fs_output.
//
// Formula   disparity = {left, right}. "rectify" reports a buffer error where left = right = 8'hEE.
// Latency   FirstRows + Rows rows, FirstTicks + Ticks ticks.
// Limits    (FirstRows + Rows) * width + FirstTicks + Ticks < 4096.
module input_output #(
  parameter int MaxWidth = 64,
  parameter int GapRows = 2,
  parameter int MaxFrames = 256,
  parameter int FirstRows = 2,
  parameter int FirstTicks = 3,
  parameter int Rows = 5,
  parameter int Ticks = 4
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        valid_i,
  output logic        ready_o,
  input  logic        sof_i,
  input  logic        eol_i,
  input  logic [7:0]  left_i,
  input  logic [7:0]  right_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic        eof_o,
  output logic        bad_o,
  output logic [15:0] disparity_o,
  input  logic        write_i,
  input  logic        read_i,
  input  logic [7:0]  address_i,
  input  logic [31:0] data_i,
  output logic        read_valid_o,
  output logic [31:0] data_o,
  // Internal signals for the test to observe.
  output logic [11:0] width_o,
  output logic [11:0] height_o,
  output logic        stage_rst_no,
  output logic        en_o,
  output logic        raster_valid_o,
  output logic        raster_sof_o,
  output logic        raster_sol_o,
  output logic        apply_o,
  output logic        frame_out_o
);
  logic pending, busy, room, frame_in, frame_bad, cut_frame, long_frame, buffer_frame;
  logic [15:0] pixel;
  fs_input #(.GapRows(GapRows), .MaxFrames(MaxFrames)) u_input (
    .clk_i, .rst_ni, .width_i(width_o), .height_i(height_o),
    .valid_i, .ready_o, .sof_i, .eol_i, .left_i, .right_i,
    .stage_rst_no, .en_o, .valid_o(raster_valid_o), .sof_o(raster_sof_o), .sol_o(raster_sol_o),
    .left_o(pixel[15:8]), .right_o(pixel[7:0]),
    .room_i(room), .bubble_room_i(1'b1), .frame_out_i(frame_out_o), .frame_in_o(frame_in),
    .frame_bad_o(frame_bad),
    .apply_i(pending), .apply_o, .busy_o(busy), .cut_frame_o(cut_frame), .long_frame_o(long_frame)
  );

  logic first_valid, first_sof, first_sol, last_valid, last_sof, last_sol;
  fs_raster_delay #(.Rows(FirstRows), .Ticks(FirstTicks)) u_first (
    .clk_i, .rst_ni(stage_rst_no), .en_i(en_o),
    .valid_i(raster_valid_o), .sof_i(raster_sof_o), .sol_i(raster_sol_o),
    .valid_o(first_valid), .sof_o(first_sof), .sol_o(first_sol)
  );
  fs_raster_delay #(.Rows(Rows), .Ticks(Ticks)) u_last (
    .clk_i, .rst_ni(stage_rst_no), .en_i(en_o),
    .valid_i(first_valid), .sof_i(first_sof), .sol_i(first_sol),
    .valid_o(last_valid), .sof_o(last_sof), .sol_o(last_sol)
  );
  // Pixels by tick number, modulo 4096.
  logic [15:0] memory[0:4095];
  logic [11:0] now_q;
  always_ff @(posedge clk_i) begin
    if (en_o) begin
      memory[now_q] <= pixel;
      now_q <= now_q + 12'd1;
    end
    if (!rst_ni) now_q <= '0;
  end
  logic [15:0] first_data, last_data;
  assign first_data = memory[now_q-12'(FirstRows)*width_o-12'(FirstTicks)];
  assign last_data = memory[now_q-12'(FirstRows+Rows)*width_o-12'(FirstTicks+Ticks)];
  logic buffer_error;
  assign buffer_error = en_o & stage_rst_no & first_valid & first_data == 16'hEEEE;

  fs_output #(.MaxFrames(MaxFrames)) u_output (
    .clk_i, .rst_ni, .width_i(width_o), .height_i(height_o),
    .stage_rst_ni(stage_rst_no), .en_i(en_o),
    .valid_i(last_valid), .sof_i(last_sof), .sol_i(last_sol), .disparity_i(last_data),
    .room_i(1'b1), .room_o(room), .frame_out_o, .frame_in_i(frame_in), .frame_bad_i(frame_bad),
    .buffer_sof_i(first_sof), .buffer_error_i(buffer_error), .buffer_frame_o(buffer_frame),
    .valid_o, .ready_i, .sof_o, .eol_o, .eof_o, .bad_o, .disparity_o
  );

  logic [32*fs_pkg::NumStages-1:0] signatures;
  for (genvar i = 0; i < fs_pkg::NumStages; i++) begin : g_signature
    if (i == fs_pkg::StageRectify) begin : g_first
      fs_signature u_signature (
        .clk_i, .rst_ni, .stage_rst_ni(stage_rst_no), .en_i(en_o), .valid_i(first_valid),
        .sof_i(first_sof), .word_i({16'd0, first_data}), .busy_i(busy),
        .signature_o(signatures[32*i+:32])
      );
    end else if (i == fs_pkg::StageSpeckle) begin : g_last
      fs_signature u_signature (
        .clk_i, .rst_ni, .stage_rst_ni(stage_rst_no), .en_i(en_o), .valid_i(last_valid),
        .sof_i(last_sof), .word_i({16'd0, last_data}), .busy_i(busy),
        .signature_o(signatures[32*i+:32])
      );
    end else begin : g_none
      assign signatures[32*i+:32] = '0;
    end
  end

  logic [fs_pkg::ConfigBits-1:0] active;
  assign width_o = active[fs_pkg::ConfigWidthPixelsLsb+:12];
  assign height_o = active[fs_pkg::ConfigHeightRowsLsb+:12];
  logic [31:0] mesh_data;
  logic [3:0] mesh_node;
  logic mesh_we, mesh_right, uploading, unused;
  assign unused = ^{active, mesh_data, mesh_node, mesh_we, mesh_right, uploading};
  fs_registers #(.MaxWidth(MaxWidth), .LineRows(8), .MeshNodes(16)) u_registers (
    .clk_i, .rst_ni, .write_i, .read_i, .address_i, .data_i, .read_valid_o, .data_o,
    .config_o(active), .pending_o(pending), .apply_i(apply_o),
    .mesh_we_o(mesh_we), .mesh_right_o(mesh_right), .mesh_node_o(mesh_node),
    .mesh_data_o(mesh_data), .uploading_o(uploading),
    .busy_i(busy), .frame_in_i(frame_in), .frame_out_i(frame_out_o), .cut_frame_i(cut_frame),
    .long_frame_i(long_frame), .buffer_left_i(buffer_error), .buffer_right_i(1'b0),
    .buffer_frame_i(buffer_frame), .signatures_i(signatures)
  );
endmodule
