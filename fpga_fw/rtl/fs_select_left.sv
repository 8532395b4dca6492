// Finds the left winner and its neighbours, and prepares the search for the runner-up.
//
// Formula   dL = the d with the smallest S(d), the lowest such d
//           C(k) = S(dL + k), k = -2..2; 0 where dL + k is not in 0..Disparities-1
// C++ twin  fpga_stereo::select (src/core/select.cpp), winner and around
// Schedule  tick 1   pairs of disparities: the smaller sum
//           tick 2   quads (four disparities): the smallest sum
//           tick 3   segments (four quads): all pairs compared, the smallest selected
//           tick 4   all segments, all pairs compared: the winner, as select signals for tick 5
//           tick 5   window: the two quads that hold dL-2..dL+2, selected from the sums of tick 0
//           tick 6   C: five of the eight sums of the window
//           All sums must be registered in every tick until the winner is known. Four-way
//           comparisons in ticks 3 and 4 keep these ticks few.
//           The window begins at disparity 4 k, k = floor((dL - 2) / 4) = -1..D/4-1; it extends
//           below the range for k = -1 and above it for k = D/4-1.
// Latency   see the ports.
module fs_select_left #(
  parameter int Disparities = 64,
  parameter int SumBits = 13,
  parameter int Copies = 1,  // of the tick, distributed over the sums
  localparam int DBits = $clog2(Disparities),
  localparam int Segments = (Disparities + 15) / 16
) (
  input  logic                           clk_i,
  input  logic [Copies-1:0]              en_i,
  input  logic [Disparities*SumBits-1:0] sums_i,       // tick 0
  output logic [Disparities*SumBits-1:0] sums_o,       // tick 1
  output logic [DBits-1:0]               winner_o,     // tick 6
  output logic [5*SumBits-1:0]           around_o,     // tick 6
  // For the runner-up.
  output logic [4*Segments*SumBits-1:0]  quads_o,      // tick 4: smallest sum of each quad
  output logic [6*Segments-1:0]          below_o,      // tick 4: their order, see fs_select_order
  output logic [4*Segments-1:0]          in_window_o,  // tick 4: quads inside the window
  output logic [8*SumBits-1:0]           window_o,     // tick 5
  output logic [1:0]                     begin_o,      // tick 5: position of dL-2 in the window
  output logic                           low_out_o,    // tick 5: its first quad is below the range
  output logic                           high_out_o    // tick 5: its second quad is above the range
);
  localparam int Quads = Disparities / 4;
  localparam int S = SumBits;

  // The sums, delayed until the winner is known.
  logic [Disparities*S-1:0] sums2_q, sums3_q, sums4_q;
  for (genvar i = 0; i < Quads; i++) begin : g_sums
    always_ff @(posedge clk_i) begin
      if (en_i[i*Copies/Quads]) begin
        sums_o[4*i*S+:4*S] <= sums_i[4*i*S+:4*S];
        sums2_q[4*i*S+:4*S] <= sums_o[4*i*S+:4*S];
        sums3_q[4*i*S+:4*S] <= sums2_q[4*i*S+:4*S];
        sums4_q[4*i*S+:4*S] <= sums3_q[4*i*S+:4*S];
      end
    end
  end

  // Tick 1. The smaller sum is not registered: the sums themselves are.
  logic [2*Quads-1:0] pair_at_q;  // the second of the two is smaller
  logic [2*Quads*S-1:0] pair;     // tick 2: the smaller sum
  for (genvar i = 0; i < 2 * Quads; i++) begin : g_pair
    logic second;
    fs_select_less #(.Bits(S)) u_less (
      .a_i(sums_i[(2*i+1)*S+:S]), .b_i(sums_i[2*i*S+:S]), .less_o(second)
    );
    always_ff @(posedge clk_i) if (en_i[i*Copies/(2*Quads)]) pair_at_q[i] <= second;
    assign pair[i*S+:S] = pair_at_q[i] ? sums_o[(2*i+1)*S+:S] : sums_o[2*i*S+:S];
  end

  // Tick 2. Quads above the range have the largest sum and lose every tie.
  logic [4*Segments*S-1:0] quad;
  logic [8*Segments-1:0] quad_at;  // which of the four
  for (genvar i = 0; i < 4 * Segments; i++) begin : g_quad
    if (i < Quads) begin : g_in
      logic second;
      logic [S-1:0] quad_q;
      logic [1:0] quad_at_q;
      fs_select_less #(.Bits(S)) u_less (
        .a_i(pair[(2*i+1)*S+:S]), .b_i(pair[2*i*S+:S]), .less_o(second)
      );
      always_ff @(posedge clk_i) begin
        if (en_i[i*Copies/Quads]) begin
          quad_q <= second ? pair[(2*i+1)*S+:S] : pair[2*i*S+:S];
          quad_at_q <= {second, second ? pair_at_q[2*i+1] : pair_at_q[2*i]};
        end
      end
      assign quad[i*S+:S] = quad_q;
      assign quad_at[2*i+:2] = quad_at_q;
    end else begin : g_out
      assign quad[i*S+:S] = '1;
      assign quad_at[2*i+:2] = '0;
    end
  end

  // Tick 3. Candidate of a quad: its smallest sum, and which of its four disparities has it.
  localparam int Bits = S + 2;
  logic [4*Segments*S-1:0] quad3_q;
  logic [6*Segments-1:0] below, below3_q;
  logic [Segments*S-1:0] segment_q;
  logic [4*Segments-1:0] segment_at_q;  // which of the sixteen
  for (genvar s = 0; s < Segments; s++) begin : g_segment
    logic [4*Bits-1:0] candidate;
    for (genvar j = 0; j < 4; j++) begin : g_second
      assign candidate[j*Bits+:Bits] = {quad_at[8*s+2*j+:2], quad[(4*s+j)*S+:S]};
      for (genvar i = 0; i < j; i++) begin : g_first
        localparam int Bit = i == 0 ? j - 1 : i + j;
        fs_select_less #(.Bits(S)) u_less (
          .a_i(quad[(4*s+j)*S+:S]), .b_i(quad[(4*s+i)*S+:S]), .less_o(below[6*s+Bit])
        );
      end
    end
    logic low, high, half;
    // Kept: synthesis would otherwise save some of these LUTs by a longer path.
    (* keep *) logic [Bits-1:0] low_candidate, high_candidate;
    fs_select_order u_order (
      .below_i(below[6*s+:6]), .masked_i(4'b0), .low_o(low), .high_o(high), .half_o(half)
    );
    assign low_candidate = low ? candidate[Bits+:Bits] : candidate[0+:Bits];
    assign high_candidate = high ? candidate[3*Bits+:Bits] : candidate[2*Bits+:Bits];
    always_ff @(posedge clk_i) begin
      if (en_i[s*Copies/Segments]) begin
        {segment_at_q[4*s+:2], segment_q[s*S+:S]} <= half ? high_candidate : low_candidate;
        segment_at_q[4*s+2+:2] <= {half, half ? high : low};
      end
    end
  end

  // Tick 4. Per segment, the two quads that the window holds if the segment's candidate wins: bit 0
  // is the quad before the segment, bit 5 the quad after it. Kept, so that `holds` is ready when
  // `wins` is.
  (* keep *) logic [6*Segments-1:0] holds;
  localparam int Last = Segments - 1;
  localparam int Above = (Quads - 1) % 4 + 2;  // the bit of `holds` for the quad above the range
  logic [Segments-1:0] wins, wins_q;
  logic [4*Segments-1:0] segment4_at_q;
  logic [4*Segments-1:0] in_window;
  logic low_out_q, high_out_q;
  for (genvar s = 0; s < Segments; s++) begin : g_wins
    logic [Segments-1:0] beats;
    for (genvar i = 0; i < Segments; i++) begin : g_other
      if (i == s) begin : g_self
        assign beats[i] = 1'b1;
      end else if (i < s) begin : g_before
        fs_select_less #(.Bits(S)) u_less (
          .a_i(segment_q[s*S+:S]), .b_i(segment_q[i*S+:S]), .less_o(beats[i])
        );
      end else begin : g_behind
        assign beats[i] = ~g_wins[i].beats[s];
      end
    end
    assign wins[s] = &beats;
    assign holds[6*s+:6] = (segment_at_q[4*s+1] ? 6'd6 : 6'd3) << segment_at_q[4*s+2+:2];
  end
  logic unused;  // a single segment has no other to beat
  assign unused = ^segment_q;
  always_comb begin
    for (int s = 0; s < Segments; s++) begin
      in_window[4*s+:4] = {4{wins[s]}} & holds[6*s+1+:4];
      if (s > 0) in_window[4*s] = in_window[4*s] | (wins[s-1] & holds[6*s-1]);
      if (s < Last) in_window[4*s+3] = in_window[4*s+3] | (wins[s+1] & holds[6*s+6]);
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      quad3_q <= quad;
      quads_o <= quad3_q;
      below3_q <= below;
      below_o <= below3_q;
      wins_q <= wins;
      segment4_at_q <= segment_at_q;
      in_window_o <= in_window;
      low_out_q <= wins[0] & holds[0];
      high_out_q <= wins[Last] & holds[6*Last+Above];
    end
  end

  // Tick 5. The first quad of the window is quad 0, 1, 2 or 3 of a segment if in_window_o of quads
  // 1, 2, 3 of that segment is 100, 110, 011 or 001; the second quad likewise by quads 0, 1, 2.
  // These are the controls of fs_select_pick. A quad out of range is in no segment: result 0.
  logic [16*Segments*S-1:0] sums4;  // padded to whole segments
  logic [4*Segments*S-1:0] firsts, seconds;
  logic [4*S-1:0] first, second, first_q, second_q;
  logic [DBits-1:0] winner, winner_q;
  assign sums4 = (16 * Segments * S)'(sums4_q);
  for (genvar s = 0; s < Segments; s++) begin : g_window
    fs_select_pick #(.Bits(4 * S)) u_first (
      .near_i(in_window_o[4*s+1]), .pick_i(in_window_o[4*s+2]), .far_i(in_window_o[4*s+3]),
      .words_i(sums4[16*s*S+:16*S]), .word_o(firsts[4*s*S+:4*S])
    );
    fs_select_pick #(.Bits(4 * S)) u_second (
      .near_i(in_window_o[4*s]), .pick_i(in_window_o[4*s+1]), .far_i(in_window_o[4*s+2]),
      .words_i(sums4[16*s*S+:16*S]), .word_o(seconds[4*s*S+:4*S])
    );
  end
  always_comb begin
    winner = '0;
    first = '0;
    second = '0;
    for (int s = 0; s < Segments; s++) begin
      if (wins_q[s]) winner = winner | DBits'(16 * s + 32'(segment4_at_q[4*s+:4]));
      first = first | firsts[4*s*S+:4*S];
      second = second | seconds[4*s*S+:4*S];
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      winner_q <= winner;
      first_q <= first;
      second_q <= second;
      low_out_o <= low_out_q;
      high_out_o <= high_out_q;
    end
  end
  assign window_o = {second_q, first_q};
  assign begin_o = {~winner_q[1], winner_q[0]};  // (dL - 2) mod 4

  // Tick 6.
  logic [5*S-1:0] around;
  fs_select_pick #(.Bits(5 * S)) u_around (
    .near_i(~begin_o[1]), .pick_i(^begin_o), .far_i(begin_o[1]),
    .words_i({window_o[3*S+:5*S], window_o[2*S+:5*S], window_o[S+:5*S], window_o[0+:5*S]}),
    .word_o(around)
  );
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      winner_o <= winner_q;
      around_o <= around;
    end
  end
endmodule
