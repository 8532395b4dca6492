// The stereo pipeline: takes one pair of raw pixels per clock and returns one disparity per clock.
//
//   fs_input -> rectify -> census -> match -> select -> check -> subpixel -> speckle -> fs_output
//
// C++ twin  Pipeline in src/core/pipeline.cpp; src/core/stages.hpp
// Schedule  fs_input turns incoming pixels into ticks (en); fs_enable distributes the ticks. The
//           stages pass each other the raster: every tick is the next position in a row of width
//           ticks, rows follow each other without a gap, and three tags accompany the data:
//             valid  the row belongs to a frame (otherwise it is a bubble row, which only moves
//                    frames along, and separates them: CorrelationWindow / 2 follow each frame)
//             sof    first pixel of a frame
//             sol    first tick of a row, also of a bubble row
//           Each stage outputs the same raster, delayed by its latency. Nothing else stalls, and no
//           stage has to handle blanking.
// Latency   rectify: T_s pixels; census: Reach rows; match: CorrelationWindow / 2 rows; speckle:
//           its look-ahead and a few more rows; see fpga_fw/README.md.
// Handshake valid/ready streams at both ends (fs_stream_fifo). Registers are on a plain bus; the
//           answer comes two clocks after read_i (fs_registers). After a write of CONTROL.apply the
//           configuration takes effect between two frames. Frames of which a part is rectified
//           between the first write to a mesh and that moment are bad.
// Limits    see the stages.
module fs_top #(
  parameter int MaxWidth = fs_pkg::DefaultMaxWidth,
  parameter int Disparities = fs_pkg::DefaultDisparities,
  parameter int CensusWindow = fs_pkg::DefaultCensusWindow,
  parameter int CorrelationWindow = fs_pkg::DefaultCorrelationWindow,
  parameter int CensusFull = 0,
  parameter int LineRows = fs_pkg::DefaultLineRows,    // rows of the line buffer
  parameter int MeshNodes = fs_pkg::DefaultMeshNodes,  // nodes of one mesh
  parameter int Primitives = 0,  // 0: behavioural arithmetic, 1: carry chains of the ECP5
  parameter int MaxFrames = 64,  // maximum frames in flight; a further one waits
  localparam int Reach = CensusFull != 0 ? CensusWindow / 2 : CensusWindow / 4 * 2,
  localparam int Side = CensusFull != 0 ? CensusWindow : Reach + 1,
  localparam int CensusBits = Side * Side - 1,
  localparam int SumBits = $clog2(CorrelationWindow * CorrelationWindow * CensusBits + 1),
  localparam int DBits = $clog2(Disparities)
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // Registers.
  input  logic        write_i,
  input  logic        read_i,
  input  logic [7:0]  address_i,
  input  logic [31:0] data_i,
  output logic        read_valid_o,
  output logic [31:0] data_o,
  // Raw pixels.
  input  logic        valid_i,
  output logic        ready_o,
  input  logic        sof_i,
  input  logic        eol_i,
  input  logic [7:0]  left_i,
  input  logic [7:0]  right_i,
  // Disparities.
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic        eof_o,
  output logic        bad_o,
  output logic [15:0] disparity_o,
  // For a link (fs_link). No tick begins without room_i; no bubble that can wait begins without
  // bubble_room_i. The outputs are pulses for events at the input, the size in effect, and the
  // images before and after rectify, one clock after their ticks.
  input  logic        room_i,
  input  logic        bubble_room_i,
  output logic        pending_o,  // a configuration waits to be applied
  output logic        applied_o,  // the configuration has taken effect
  output logic        frame_in_o,
  output logic        cut_frame_o,  // the frame that began last was cut
  output logic        long_frame_o,
  output logic [11:0] width_o,
  output logic [11:0] height_o,
  output logic        raw_valid_o,
  output logic        raw_sof_o,
  output logic [7:0]  raw_left_o,
  output logic [7:0]  raw_right_o,
  output logic        rectified_valid_o,
  output logic        rectified_sof_o,
  output logic        rectified_error_o,  // the pixel is not the one that the mesh asks for
  output logic [7:0]  rectified_left_o,
  output logic [7:0]  rectified_right_o
);
  // Copies of the tick per stage, and the index of each stage's first copy.
  localparam int RectifyCopies = 5, CensusCopies = 5, MatchCopies = 2 + Disparities / 4;
  localparam int SelectCopies = 2 + (Disparities + 15) / 16;
  localparam int CensusAt = RectifyCopies, MatchAt = CensusAt + CensusCopies;
  localparam int SelectAt = MatchAt + MatchCopies, CheckAt = SelectAt + SelectCopies;
  localparam int SubpixelAt = CheckAt + 1, SpeckleAt = SubpixelAt + 1, OutputAt = SpeckleAt + 1;
  localparam int SignaturesAt = OutputAt + 1;
  logic [SignaturesAt:0] en;
  logic [fs_pkg::NumStages+1:0] stage_rst_n;  // one per stage, then output, signatures
  logic first_en, first_rst_n, room;  // tick; stages run; room after the last stage

  // Registers and the configuration in effect. The bus comes from far away, so it is registered.
  logic write_q, read_q;
  logic [7:0] address_q;
  logic [31:0] data_q;
  always_ff @(posedge clk_i) begin
    write_q <= rst_ni & write_i;
    read_q <= rst_ni & read_i;
    address_q <= address_i;
    data_q <= data_i;
  end
  logic [fs_pkg::ConfigBits-1:0] active;
  logic [11:0] width, height;
  assign width = active[fs_pkg::ConfigWidthPixelsLsb+:12];
  assign height = active[fs_pkg::ConfigHeightRowsLsb+:12];
  logic mesh_we, mesh_right, uploading;
  logic [$clog2(MeshNodes)-1:0] mesh_node;
  logic [31:0] mesh_data;
  logic pending, apply, busy, frame_in, frame_out, frame_bad, cut_frame, long_frame;
  logic buffer_frame, left_error, right_error;
  logic [32*fs_pkg::NumStages-1:0] signatures;
  fs_registers #(
    .MaxWidth(MaxWidth), .Disparities(Disparities), .CensusWindow(CensusWindow),
    .CorrelationWindow(CorrelationWindow), .CensusFull(CensusFull), .LineRows(LineRows),
    .MeshNodes(MeshNodes)
  ) u_registers (
    .clk_i, .rst_ni, .write_i(write_q), .read_i(read_q), .address_i(address_q), .data_i(data_q),
    .read_valid_o, .data_o,
    .config_o(active), .pending_o(pending), .apply_i(apply),
    .mesh_we_o(mesh_we), .mesh_right_o(mesh_right), .mesh_node_o(mesh_node),
    .mesh_data_o(mesh_data), .uploading_o(uploading),
    .busy_i(busy), .frame_in_i(frame_in), .frame_out_i(frame_out), .cut_frame_i(cut_frame),
    .long_frame_i(long_frame), .buffer_left_i(left_error & en[0]),
    .buffer_right_i(right_error & en[0]), .buffer_frame_i(buffer_frame), .signatures_i(signatures)
  );

  // The settings for the stages. They change only while the stages are in reset, but timing
  // analysis still requires short paths across the chip. Kept, like the copies in fs_enable.
  localparam int SizeRectify = 0, SizeCensus = 1, SizeSpeckle = 2, SizeMatch = 3;
  logic [4*12-1:0] width_q;
  logic [3*12-1:0] height_q;  // match needs none
  for (genvar k = 0; k < 4; k++) begin : g_size
    (* keep *) always_ff @(posedge clk_i) width_q[12*k+:12] <= width;
    if (k != SizeMatch) begin : g_height
      (* keep *) always_ff @(posedge clk_i) height_q[12*k+:12] <= height;
    end
  end
  logic [fs_pkg::ConfigBits-1:0] config_q;
  always_ff @(posedge clk_i) config_q <= active;

  // From the stream to the raster.
  logic first_valid, first_sof, first_sol;
  logic [7:0] first_left, first_right;
  fs_input #(.GapRows(CorrelationWindow / 2), .MaxFrames(MaxFrames)) u_input (
    .clk_i, .rst_ni, .width_i(width), .height_i(height),
    .valid_i, .ready_o, .sof_i, .eol_i, .left_i, .right_i,
    .stage_rst_no(first_rst_n), .en_o(first_en), .valid_o(first_valid), .sof_o(first_sof),
    .sol_o(first_sol), .left_o(first_left), .right_o(first_right),
    .room_i(room), .bubble_room_i,
    .frame_out_i(frame_out), .frame_in_o(frame_in), .frame_bad_o(frame_bad),
    .apply_i(pending), .apply_o(apply), .busy_o(busy),
    .cut_frame_o(cut_frame), .long_frame_o(long_frame)
  );

  logic raw_valid, raw_sof, raw_sol;
  logic [7:0] raw_left, raw_right;
  fs_enable #(.Copies(SignaturesAt + 1), .Resets(fs_pkg::NumStages + 2)) u_enable (
    .clk_i, .rst_ni, .stage_rst_ni(first_rst_n), .en_i(first_en),
    .valid_i(first_valid), .sof_i(first_sof), .sol_i(first_sol),
    .left_i(first_left), .right_i(first_right),
    .stage_rst_no(stage_rst_n), .en_o(en), .valid_o(raw_valid), .sof_o(raw_sof), .sol_o(raw_sol),
    .left_o(raw_left), .right_o(raw_right)
  );

  logic rectify_valid, rectify_sof, rectify_sol, buffer_left, buffer_right;
  logic [7:0] left, right;
  fs_rectify #(
    .MaxWidth(MaxWidth), .LineRows(LineRows), .MeshNodes(MeshNodes), .Copies(RectifyCopies)
  ) u_rectify (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageRectify]),
    .en_i(en[0+:RectifyCopies]),
    .width_i(width_q[12*SizeRectify+:12]), .height_i(height_q[12*SizeRectify+:12]),
    .read_rows_i(config_q[fs_pkg::ConfigReadStartRowsLsb+:8]),
    .read_pixels_i(config_q[fs_pkg::ConfigReadStartPixelsLsb+:12]),
    .mesh_we_i(mesh_we), .mesh_right_i(mesh_right), .mesh_node_i(16'(mesh_node)),
    .mesh_data_i(mesh_data),
    .valid_i(raw_valid), .sof_i(raw_sof), .sol_i(raw_sol), .left_i(raw_left), .right_i(raw_right),
    .valid_o(rectify_valid), .sof_o(rectify_sof), .sol_o(rectify_sol),
    .left_o(left), .right_o(right), .left_error_o(buffer_left), .right_error_o(buffer_right)
  );
  assign left_error = (buffer_left | uploading) & rectify_valid;
  assign right_error = (buffer_right | uploading) & rectify_valid;

  logic census_valid, census_sof, census_sol;
  logic [CensusBits-1:0] enter_left, enter_right, leave_left, leave_right;
  fs_census #(
    .MaxWidth(MaxWidth), .CensusWindow(CensusWindow), .CorrelationWindow(CorrelationWindow),
    .Full(CensusFull), .Copies(CensusCopies)
  ) u_census (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageCensus]),
    .en_i(en[CensusAt+:CensusCopies]),
    .width_i(width_q[12*SizeCensus+:12]), .height_i(height_q[12*SizeCensus+:12]),
    .valid_i(rectify_valid), .sof_i(rectify_sof), .sol_i(rectify_sol),
    .left_i(left), .right_i(right),
    .valid_o(census_valid), .sof_o(census_sof), .sol_o(census_sol),
    .enter_left_o(enter_left), .enter_right_o(enter_right),
    .leave_left_o(leave_left), .leave_right_o(leave_right)
  );

  logic match_valid, match_sof, match_sol;
  logic [Disparities*SumBits-1:0] sums;
  fs_match #(
    .MaxWidth(MaxWidth), .Disparities(Disparities), .CensusBits(CensusBits),
    .CorrelationWindow(CorrelationWindow), .Primitives(Primitives), .Copies(MatchCopies)
  ) u_match (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageMatch]),
    .en_i(en[MatchAt+:MatchCopies]),
    .width_i(width_q[12*SizeMatch+:12]),
    .valid_i(census_valid), .sof_i(census_sof), .sol_i(census_sol),
    .enter_left_i(enter_left), .enter_right_i(enter_right),
    .leave_left_i(leave_left), .leave_right_i(leave_right),
    .valid_o(match_valid), .sof_o(match_sof), .sol_o(match_sol), .sums_o(sums)
  );

  logic select_valid, select_sof, select_sol;
  logic [DBits-1:0] winner, right_winner;
  logic [SumBits-1:0] winner_sum, runner_up_sum;
  logic [5*SumBits-1:0] around;
  fs_select #(
    .Disparities(Disparities), .SumBits(SumBits), .Copies(SelectCopies)
  ) u_select (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageSelect]),
    .en_i(en[SelectAt+:SelectCopies]),
    .valid_i(match_valid), .sof_i(match_sof), .sol_i(match_sol), .sums_i(sums),
    .valid_o(select_valid), .sof_o(select_sof), .sol_o(select_sol),
    .winner_o(winner), .right_winner_o(right_winner), .winner_sum_o(winner_sum),
    .runner_up_sum_o(runner_up_sum), .around_o(around)
  );

  logic check_valid, check_sof, check_sol, kept;
  logic [DBits-1:0] check_winner;
  logic [5*SumBits-1:0] check_around;
  fs_check #(.Disparities(Disparities), .SumBits(SumBits)) u_check (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageCheck]),
    .en_i(en[CheckAt]), .config_i(config_q),
    .valid_i(select_valid), .sof_i(select_sof), .sol_i(select_sol),
    .winner_i(winner), .right_winner_i(right_winner), .winner_sum_i(winner_sum),
    .runner_up_sum_i(runner_up_sum), .around_i(around),
    .valid_o(check_valid), .sof_o(check_sof), .sol_o(check_sol),
    .kept_o(kept), .winner_o(check_winner), .around_o(check_around)
  );

  logic subpixel_valid, subpixel_sof, subpixel_sol;
  logic [15:0] refined;
  fs_subpixel #(.Disparities(Disparities), .SumBits(SumBits)) u_subpixel (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageSubpixel]),
    .en_i(en[SubpixelAt]), .config_i(config_q),
    .valid_i(check_valid), .sof_i(check_sof), .sol_i(check_sol),
    .kept_i(kept), .winner_i(check_winner), .around_i(check_around),
    .valid_o(subpixel_valid), .sof_o(subpixel_sof), .sol_o(subpixel_sol),
    .disparity_o(refined)
  );

  logic speckle_valid, speckle_sof, speckle_sol;
  logic [15:0] disparity;
  fs_speckle #(
    .MaxWidth(MaxWidth), .DisparityBits($clog2(Disparities * fs_pkg::DisparityScale))
  ) u_speckle (
    .clk_i, .rst_ni(stage_rst_n[fs_pkg::StageSpeckle]),
    .en_i(en[SpeckleAt]),
    .width_i(width_q[12*SizeSpeckle+:12]), .height_i(height_q[12*SizeSpeckle+:12]),
    .config_i(config_q),
    .valid_i(subpixel_valid), .sof_i(subpixel_sof), .sol_i(subpixel_sol), .disparity_i(refined),
    .valid_o(speckle_valid), .sof_o(speckle_sof), .sol_o(speckle_sol), .disparity_o(disparity)
  );

  // From the raster to the stream.
  fs_output #(.MaxFrames(MaxFrames), .EnableClocks(2)) u_output (
    .clk_i, .rst_ni, .width_i(width), .height_i(height),
    .stage_rst_ni(stage_rst_n[fs_pkg::NumStages]), .en_i(en[OutputAt]),
    .valid_i(speckle_valid), .sof_i(speckle_sof), .sol_i(speckle_sol), .disparity_i(disparity),
    .room_i, .room_o(room),
    .frame_out_o(frame_out), .frame_in_i(frame_in), .frame_bad_i(frame_bad),
    .buffer_sof_i(rectify_sof), .buffer_error_i(left_error | right_error),
    .buffer_frame_o(buffer_frame),
    .valid_o, .ready_i, .sof_o, .eol_o, .eof_o, .bad_o, .disparity_o
  );

  // Additional outputs for a link.
  assign pending_o = pending;
  assign applied_o = apply;
  assign frame_in_o = frame_in;
  assign cut_frame_o = cut_frame;
  assign long_frame_o = long_frame;
  assign width_o = width;
  assign height_o = height;
  always_ff @(posedge clk_i) begin
    raw_valid_o <= rst_ni & stage_rst_n[fs_pkg::NumStages] & en[OutputAt] & raw_valid;
    raw_sof_o <= raw_sof;
    raw_left_o <= raw_left;
    raw_right_o <= raw_right;
    rectified_valid_o <= rst_ni & stage_rst_n[fs_pkg::NumStages] & en[OutputAt] & rectify_valid;
    rectified_sof_o <= rectify_sof;
    rectified_error_o <= left_error | right_error;
    rectified_left_o <= left;
    rectified_right_o <= right;
  end

  // One signature per stage.
  fs_signatures #(
    .Disparities(Disparities), .CensusBits(CensusBits), .SumBits(SumBits)
  ) u_signatures (
    .clk_i, .rst_ni, .stage_rst_ni(stage_rst_n[fs_pkg::NumStages+1]),
    .en_i(en[SignaturesAt]), .busy_i(busy),
    .valid_i({speckle_valid, subpixel_valid, check_valid, select_valid, match_valid, census_valid,
              rectify_valid}),
    .sof_i({speckle_sof, subpixel_sof, check_sof, select_sof, match_sof, census_sof, rectify_sof}),
    .left_i(left), .right_i(right), .census_left_i(enter_left), .census_right_i(enter_right),
    .sums_i(sums), .winner_i(winner), .right_winner_i(right_winner), .winner_sum_i(winner_sum),
    .runner_up_sum_i(runner_up_sum), .around_i(around), .kept_i(kept), .refined_i(refined),
    .disparity_i(disparity), .signatures_o(signatures)
  );
endmodule
