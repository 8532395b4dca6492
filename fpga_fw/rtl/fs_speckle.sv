// Removes the disparities of regions that are too small.
//
// Formula   A pixel of row y keeps its disparity iff its region, restricted to the rows 0..y+24,
//           has at least speckle_size pixels; regions are 4-connected, neighbours differ by at most
//           speckle_range. With speckle_size 0 every pixel keeps its disparity. Labels cannot run
//           out.
// C++ twin  fpga_stereo::speckle (src/core/speckle.cpp)
// Schedule  in row times; the input row r + 1 comes at r + 1
//             r+1   fs_speckle_link       links row r+1 to the regions of rows 0..r
//             r+1   fs_speckle_area       their areas up to row r; target of each region of row r
//             r+2   fs_speckle_targets    M1_r: pixel -> a pixel of row r+1 of the same region; or
//                                       its verdict: keep if it is large enough, drop if it ends
//             r+4   fs_speckle_compose    M2_r = M1_{r+1} o M1_r; likewise
//             r+7   M4_r = M2_{r+2} o M2_r           K5_r = K1_{r+4} o M4_r    (K1: M1 says keep)
//             r+12  M8_r = M4_{r+4} o M4_r           K9_r = K5_{r+4} o M4_r
//             r+21  M16_r = M8_{r+8} o M8_r
//             r+29  K25_r = K9_{r+16} o M16_r: the region is large enough by row r+24
//           Each of these is a stream in pixel order. The ticks within a row are those of the
//           sub-modules:
//             1 input  3 linked  6 links  9 areas  14 M1  17 M2  20 M4  23 K5  26 M8, K9  29 M16
//             32 K25  33 output
// Latency   29 rows and 33 ticks.
// Handshake the raster (see fs_top).
// Limits    width_i 16 to MaxWidth. Disparities are less than 2**DisparityBits - 1; bit 15 of
//           disparity_i is set iff the pixel has no disparity. LookAhead is 24.
module fs_speckle #(
  parameter int MaxWidth = 640,
  parameter int DisparityBits = 11,
  parameter int LookAhead = fs_pkg::SpeckleLookAhead,
  parameter int BlockVerdicts = 0  // verdict bits K1 and K9 in 2 more block RAMs, not in LUTs
) (
  input  logic                          clk_i,
  input  logic                          rst_ni,
  input  logic                          en_i,
  input  logic [11:0]                   width_i,
  input  logic [11:0]                   height_i,
  input  logic [fs_pkg::ConfigBits-1:0] config_i,
  input  logic                          valid_i,
  input  logic                          sof_i,
  input  logic                          sol_i,
  input  logic [15:0]                   disparity_i,
  output logic                          valid_o,
  output logic                          sof_o,
  output logic                          sol_o,
  output logic [15:0]                   disparity_o
);
  localparam int LatencyRows = 29;
  localparam int LatencyTicks = 33;
  localparam int WordBits = $clog2((MaxWidth + 2) / 3);
  localparam int Bits = WordBits + 2;
  localparam int LengthBits = $clog2(MaxWidth + 1);
  localparam int Tail = LatencyTicks - 2;  // input and output register
  localparam int TailBits = $clog2(MaxWidth + Tail + 1);
  localparam logic [Bits-1:0] Drop = Bits'(3);
  if (LookAhead != 24) initial $fatal(1, "fs_speckle: LookAhead is %0d, allowed: 24", LookAhead);
  if (MaxWidth < fs_pkg::GatewareMinWidth || MaxWidth > fs_pkg::GatewareMaxWidth)
    initial $fatal(1, "fs_speckle: MaxWidth is %0d, allowed: 16 to 1280", MaxWidth);
  if (DisparityBits < 8 || DisparityBits > 15)
    initial $fatal(1, "fs_speckle: DisparityBits is %0d, allowed: 8 to 15", DisparityBits);

  logic [9:0] speckle_size;   // px; 0: off
  logic [9:0] speckle_range;  // 1/32 px
  assign speckle_size = config_i[fs_pkg::ConfigSpeckleSizePixelsLsb+:10];
  assign speckle_range = config_i[fs_pkg::ConfigSpeckleRangeUnitsLsb+:10];

  fs_raster_delay #(.Rows(LatencyRows), .Ticks(LatencyTicks)) u_tags (
    .clk_i, .rst_ni, .en_i, .valid_i, .sof_i, .sol_i, .valid_o, .sof_o, .sol_o
  );
  // Row starts, by tick.
  logic [28:1] first_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) first_q <= '0;
    else if (en_i) first_q <= {first_q[27:1], sol_i};
  end

  // All delays by whole rows, in one line delay. From the lowest bit: disparities,
  // fs_speckle_linked, first links, names, M1, M2, M4, M8, M16.
  localparam int Disparities = 28 * DisparityBits;
  localparam int Names = Disparities + 2;
  localparam int DelayBits = Names + (1 + 2 + 3 + 5 + 9 + 8) * Bits;
  logic [DelayBits-1:0] delay_in, delay_out;
  fs_line_delay #(.Bits(DelayBits), .MaxLength(MaxWidth)) u_rows (
    .clk_i, .rst_ni, .en_i, .length_i(LengthBits'(width_i)), .data_i(delay_in), .data_o(delay_out)
  );

  // Tick 1: the pixel, its left neighbour and the pixel above.
  logic [DisparityBits-1:0] here_q, left_q, above;
  logic valid_1_q, left_valid_q, above_valid;
  logic frame_q, above_frame_q, top_q;  // this row, the row above is of a frame; row 0
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      frame_q <= 1'b0;
      above_frame_q <= 1'b0;
      valid_1_q <= 1'b0;
      left_valid_q <= 1'b0;
    end else if (en_i) begin
      if (sol_i) begin
        frame_q <= valid_i;
        above_frame_q <= frame_q;
      end
      valid_1_q <= valid_i & ~disparity_i[15];
      left_valid_q <= valid_1_q;
    end
    if (en_i) begin
      if (sol_i) top_q <= sof_i;
      here_q <= valid_i && !disparity_i[15] ? disparity_i[DisparityBits-1:0] : '1;
      left_q <= here_q;
    end
  end
  assign delay_in[Disparities-1:0] = {delay_out[Disparities-DisparityBits-1:0], here_q};
  assign above = delay_out[DisparityBits-1:0];
  assign above_valid = above_frame_q & ~&above;

  // Tick 3: links.
  logic link, above_link, up;
  fs_speckle_linked #(.Bits(DisparityBits)) u_link_left (
    .clk_i, .en_i, .range_i(speckle_range), .valid_i(valid_1_q & left_valid_q & ~first_q[1]),
    .a_i(here_q), .b_i(left_q), .linked_o(link)
  );
  fs_speckle_linked #(.Bits(DisparityBits)) u_link_up (
    .clk_i, .en_i, .range_i(speckle_range), .valid_i(valid_1_q & above_valid & ~top_q),
    .a_i(here_q), .b_i(above), .linked_o(up)
  );
  assign delay_in[Disparities] = link;
  assign above_link = delay_out[Disparities];
  logic [3:2] valid_q, above_valid_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_q <= '0;
      above_valid_q <= '0;
    end else if (en_i) begin
      valid_q <= {valid_q[2], valid_1_q};
      above_valid_q <= {above_valid_q[2], above_valid};
    end
  end

  // Tick 6: regions. Tick 9 and 11: areas.
  logic region, region_new, region_pop, region_push, region_close, first_link;
  fs_speckle_link #(.WordBits(WordBits), .StackDepth(MaxWidth / 2)) u_link (
    .clk_i, .rst_ni, .en_i, .first_i(sol_i), .valid_i(valid_q[3]), .link_i(link), .up_i(up),
    .above_valid_i(above_valid_q[3]), .above_link_i(above_link), .above_valid_o(region),
    .new_o(region_new), .pop_o(region_pop), .push_o(region_push), .close_o(region_close),
    .first_o(first_link)
  );
  logic named, target_valid;
  logic [Bits-1:0] name, target_name, target;
  fs_speckle_area #(.WordBits(WordBits), .StackDepth(MaxWidth / 2)) u_area (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[5]), .speckle_size_i(speckle_size),
    .above_valid_i(region), .new_i(region_new), .pop_i(region_pop), .push_i(region_push),
    .close_i(region_close), .first_link_i(first_link), .credited_o(delay_in[Disparities+1]),
    .credited_i(delay_out[Disparities+1]), .named_o(named), .name_o(name),
    .target_valid_o(target_valid), .target_name_o(target_name), .target_o(target)
  );
  assign delay_in[Names+:Bits] = named ? name : Drop;

  // Tick 14: M1. Then the composition over the rows below, in doubling steps.
  logic [Bits-1:0] m1, m2, m4, m8, m16;
  logic [Bits-1:0] m1_delayed, m2_delayed, m4_delayed, m8_delayed, m16_delayed;
  fs_speckle_targets #(.WordBits(WordBits)) u_targets (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[10]), .write_i(target_valid),
    .write_name_i(target_name), .write_target_i(target), .name_i(delay_out[Names+:Bits]),
    .target_o(m1)
  );

  localparam int M1 = Names + Bits, M2 = M1 + 2 * Bits, M4 = M2 + 3 * Bits, M8 = M4 + 5 * Bits,
      M16 = M8 + 9 * Bits;
  assign delay_in[M1+:2*Bits] = {delay_out[M1+:Bits], m1};
  assign delay_in[M2+:3*Bits] = {delay_out[M2+:2*Bits], m2};
  assign delay_in[M4+:5*Bits] = {delay_out[M4+:4*Bits], m4_23_q};
  assign delay_in[M8+:9*Bits] = {delay_out[M8+:8*Bits], m8};
  assign delay_in[M16+:8*Bits] = {delay_out[M16+:7*Bits], m16};
  assign m1_delayed = delay_out[M1+Bits+:Bits];
  assign m2_delayed = delay_out[M2+2*Bits+:Bits];
  assign m4_delayed = delay_out[M4+4*Bits+:Bits];
  assign m8_delayed = delay_out[M8+8*Bits+:Bits];
  assign m16_delayed = delay_out[M16+7*Bits+:Bits];

  // Delays verdicts until the positions that look them up arrive: K1 by 6 ticks, K9 by 3 ticks; M4
  // is delayed 3 ticks for K5.
  logic k5, k9, k25;
  logic [20:15] k1_q;
  logic [29:27] k9_q;
  logic [Bits-1:0] m4_21_q, m4_22_q, m4_23_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      k1_q <= {k1_q[19:15], m1 == {Bits{1'b1}}};
      k9_q <= {k9_q[28:27], k9};
      m4_21_q <= m4;
      m4_22_q <= m4_21_q;
      m4_23_q <= m4_22_q;
    end
  end

  logic [2:0] no_verdict;
  logic [2*Bits-1:0] no_code;
  logic [Bits-1:0] no_young;
  assign no_young = '0;
  fs_speckle_compose #(.WordBits(WordBits)) u_m2 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[13]), .young_i(m1), .young_verdict_i(1'b0),
    .index_i(m1_delayed), .code_o(m2), .verdict_o(no_verdict[0])
  );
  fs_speckle_compose #(.WordBits(WordBits)) u_m4 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[16]), .young_i(m2), .young_verdict_i(1'b0),
    .index_i(m2_delayed), .code_o(m4), .verdict_o(no_verdict[1])
  );
  fs_speckle_compose #(.WordBits(WordBits), .Codes(0), .Verdicts(1), .Block(BlockVerdicts != 0)
  ) u_k5 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[19]), .young_i(no_young), .young_verdict_i(k1_q[20]),
    .index_i(m4), .code_o(no_code[0+:Bits]), .verdict_o(k5)
  );
  fs_speckle_compose #(.WordBits(WordBits), .Verdicts(1)) u_m8 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[22]), .young_i(m4_23_q), .young_verdict_i(k5),
    .index_i(m4_delayed), .code_o(m8), .verdict_o(k9)
  );
  fs_speckle_compose #(.WordBits(WordBits)) u_m16 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[25]), .young_i(m8), .young_verdict_i(1'b0),
    .index_i(m8_delayed), .code_o(m16), .verdict_o(no_verdict[2])
  );
  fs_speckle_compose #(.WordBits(WordBits), .Codes(0), .Verdicts(1), .Block(BlockVerdicts != 0)
  ) u_k25 (
    .clk_i, .rst_ni, .en_i, .first_i(first_q[28]), .young_i(no_young), .young_verdict_i(k9_q[29]),
    .index_i(m16_delayed), .code_o(no_code[Bits+:Bits]), .verdict_o(k25)
  );

  // Ticks 32 and 33: selects the disparity or NoDisparity.
  logic [DisparityBits-1:0] disparity;
  logic [TailBits-1:0] tail_length;
  assign tail_length = TailBits'(width_i) + TailBits'(Tail);
  fs_line_delay #(.Bits(DisparityBits), .MaxLength(MaxWidth + Tail)) u_tail (
    .clk_i, .rst_ni, .en_i, .length_i(tail_length),
    .data_i(delay_out[Disparities-DisparityBits+:DisparityBits]), .data_o(disparity)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      disparity_o <= ~&disparity && k25 ? 16'(disparity) : fs_pkg::NoDisparity;
    end
  end

  logic unused;
  assign unused = ^{width_i, height_i, config_i, disparity_i, no_verdict, no_code};
endmodule
