// Signatures of all stages: makes one word per pixel and stage, as fpga_fw/spec/registers.md
// defines, and accumulates the words over a frame.
//
// C++ twin  stage_signatures() in src/core/signature.cpp
// Latency   a signature is available some clocks after the last pixel of a frame has left its
//           stage.
// Handshake the raster of each stage; valid_i and sof_i have one bit per stage.
module fs_signatures #(
  parameter int Disparities = 64,
  parameter int CensusBits = 24,
  parameter int SumBits = 13,
  localparam int DBits = $clog2(Disparities)
) (
  input  logic                            clk_i,
  input  logic                            rst_ni,
  input  logic                            stage_rst_ni,
  input  logic                            en_i,
  input  logic                            busy_i,
  input  logic [fs_pkg::NumStages-1:0]    valid_i,
  input  logic [fs_pkg::NumStages-1:0]    sof_i,
  input  logic [7:0]                      left_i,
  input  logic [7:0]                      right_i,
  input  logic [CensusBits-1:0]           census_left_i,
  input  logic [CensusBits-1:0]           census_right_i,
  input  logic [Disparities*SumBits-1:0]  sums_i,
  input  logic [DBits-1:0]                winner_i,
  input  logic [DBits-1:0]                right_winner_i,
  input  logic [SumBits-1:0]              winner_sum_i,
  input  logic [SumBits-1:0]              runner_up_sum_i,
  input  logic [5*SumBits-1:0]            around_i,
  input  logic                            kept_i,
  input  logic [15:0]                     refined_i,
  input  logic [15:0]                     disparity_i,
  output logic [32*fs_pkg::NumStages-1:0] signatures_o
);
  // Words of the narrow outputs are computed here, in one register; those of the wide outputs have
  // their own modules.
  function automatic logic [31:0] rotated(input logic [31:0] word, input int by);
    rotated = by == 0 ? word : (word << by) | (word >> (32 - by));
  endfunction

  logic [31:0] around;
  always_comb begin
    around = '0;
    for (int k = 0; k < 5; k++) begin
      around = around ^ rotated(32'(around_i[SumBits*k+:SumBits]), 5 * k);
    end
  end

  logic [fs_pkg::NumStages-1:0] valid, sof;
  logic [32*fs_pkg::NumStages-1:0] words;
  logic [fs_pkg::NumStages-1:0] valid_q, sof_q;
  logic [31:0] rectify_q, select_q;
  logic kept_q;
  logic [15:0] refined_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni || !stage_rst_ni) begin
      valid_q <= '0;
      sof_q <= '0;
    end else if (en_i) begin
      valid_q <= valid_i;
      sof_q <= sof_i;
    end
    if (en_i) begin
      rectify_q <= 32'({left_i, right_i});
      select_q <= 32'(winner_i) ^ (32'(right_winner_i) << 8) ^ (32'(winner_sum_i) << 16) ^
          rotated(32'(runner_up_sum_i), 8) ^ around;
      kept_q <= kept_i;
      refined_q <= refined_i;
    end
  end

  logic stage_rst_n;
  assign stage_rst_n = rst_ni & stage_rst_ni;
  fs_fold_census #(.Bits(CensusBits)) u_census (
    .clk_i, .rst_ni(stage_rst_n), .en_i,
    .valid_i(valid_i[fs_pkg::StageCensus]), .sof_i(sof_i[fs_pkg::StageCensus]),
    .left_i(census_left_i), .right_i(census_right_i),
    .valid_o(valid[fs_pkg::StageCensus]), .sof_o(sof[fs_pkg::StageCensus]),
    .word_o(words[32*fs_pkg::StageCensus+:32])
  );
  fs_fold_match #(.Disparities(Disparities), .SumBits(SumBits)) u_match (
    .clk_i, .rst_ni(stage_rst_n), .en_i,
    .valid_i(valid_i[fs_pkg::StageMatch]), .sof_i(sof_i[fs_pkg::StageMatch]), .sums_i,
    .valid_o(valid[fs_pkg::StageMatch]), .sof_o(sof[fs_pkg::StageMatch]),
    .word_o(words[32*fs_pkg::StageMatch+:32])
  );
  assign words[32*fs_pkg::StageRectify+:32] = rectify_q;
  assign words[32*fs_pkg::StageSelect+:32] = select_q;
  assign words[32*fs_pkg::StageCheck+:32] = 32'(kept_q);
  assign words[32*fs_pkg::StageSubpixel+:32] = 32'(refined_q);
  // There may be no tick after the last pixel of the last frame, so its word is not registered.
  assign words[32*fs_pkg::StageSpeckle+:32] = 32'(disparity_i);

  for (genvar k = 0; k < fs_pkg::NumStages; k++) begin : g_stage
    if (k == fs_pkg::StageSpeckle) begin : g_last
      assign valid[k] = valid_i[k];
      assign sof[k] = sof_i[k];
    end else if (k != fs_pkg::StageCensus && k != fs_pkg::StageMatch) begin : g_word
      assign valid[k] = valid_q[k];
      assign sof[k] = sof_q[k];
    end
    fs_signature u_signature (
      .clk_i, .rst_ni, .stage_rst_ni, .en_i, .busy_i,
      .valid_i(valid[k]), .sof_i(sof[k]), .word_i(words[32*k+:32]),
      .signature_o(signatures_o[32*k+:32])
    );
  end
  logic unused;
  assign unused = ^{valid_q, sof_q};
endmodule
