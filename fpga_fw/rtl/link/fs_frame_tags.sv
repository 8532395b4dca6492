// Stores what is known of a pair of images when it begins at the input: the streams that send it,
// its id, timestamp, size and configuration id. The sources of later streams read these tags when
// the frame reaches them.
//
// Formula   registers.md: STREAMS, FRAME_INTERVAL, MID_EXPOSURE, CONFIGURATION. One in `pairs`
//           pairs is sent; of those, one in `raw` is sent with its raw images. A write of
//           FRAME_INTERVAL restarts the counting with the next pair. Without a host nothing is
//           sent.
// Schedule  frame_in_i  captures everything, then writes one word per clock into the memory: Words
//           req_i       serves one source at a time: one word per clock, starting 3 clocks later
// Handshake req_i is held until the last word has come; valid_o has one bit per source. The words
//           are send (bit s for stream s), frame_id low, high, timestamp low, high, size,
//           configuration.
// Limits    MaxFrames as in fs_input: frames in flight. Frames begin at least Words clocks apart.
module fs_frame_tags #(
  parameter int MaxFrames = 64,
  parameter int Sources = 5,
  localparam int FrameBits = $clog2(MaxFrames)
) (
  input  logic                         clk_i,
  input  logic                         rst_ni,
  // The frame that begins.
  input  logic                         frame_in_i,
  input  logic                         from_host_i,
  input  logic [63:0]                  host_id_i,
  input  logic [63:0]                  host_time_i,
  input  logic [63:0]                  us_i,
  input  logic [11:0]                  width_i,
  input  logic [11:0]                  height_i,
  // Settings.
  input  logic                         alive_i,
  input  logic [7:0]                   streams_i,
  input  logic [15:0]                  pairs_i,
  input  logic [15:0]                  raw_i,
  input  logic                         interval_i,
  input  logic [23:0]                  mid_exposure_i,
  input  logic [31:0]                  configuration_i,
  // Requests of the sources.
  input  logic [Sources-1:0]           req_i,
  input  logic [Sources*FrameBits-1:0] number_i,
  output logic [Sources-1:0]           valid_o,
  output logic [31:0]                  word_o
);
  localparam int Words = 7;
  localparam logic [7:0] Raw =
      8'd1 << fs_pkg::StreamRawLeft | 8'd1 << fs_pkg::StreamRawRight;

  // Decides which pairs are sent.
  logic [15:0] pairs_q, raw_q;  // pairs to skip before the next one
  logic sends, sends_raw;
  assign sends = alive_i & pairs_q == '0;
  assign sends_raw = sends & raw_q == '0;
  function automatic logic [15:0] passes(input logic [15:0] interval);
    passes = interval == '0 ? '0 : interval - 16'd1;
  endfunction
  always_ff @(posedge clk_i) begin
    if (!rst_ni | interval_i) begin
      pairs_q <= '0;
      raw_q <= '0;
    end else if (frame_in_i & alive_i) begin
      pairs_q <= sends ? passes(pairs_i) : pairs_q - 16'd1;
      if (sends) raw_q <= sends_raw ? passes(raw_i) : raw_q - 16'd1;
    end
  end

  // The tags of the frame that begins.
  logic [63:0] id_q, time_q, tag_id_q, tag_time_q, exposed_q;
  logic [7:0] tag_send_q;
  logic [31:0] tag_configuration_q, tag_size_q;
  logic [FrameBits-1:0] write_frame_q;
  logic [2:0] write_q;  // next word; Words: idle
  logic [31:0] write_word;
  always_ff @(posedge clk_i) begin
    time_q <= us_i;
    exposed_q <= time_q - 64'(mid_exposure_i);
    if (!rst_ni) begin
      id_q <= {32'hFFFFFFFF, fs_pkg::LinkFirstFrame};
      write_frame_q <= '1;
      write_q <= 3'(Words);
    end else begin
      if (frame_in_i & ~from_host_i) id_q <= id_q + 64'd1;
      if (frame_in_i) write_frame_q <= write_frame_q + 1'b1;
      if (frame_in_i) write_q <= '0;
      else if (write_q != 3'(Words)) write_q <= write_q + 3'd1;
    end
    if (frame_in_i) begin
      tag_send_q <= (sends ? streams_i : '0) & ~(sends_raw ? '0 : Raw);
      tag_id_q <= from_host_i ? host_id_i : id_q;
      tag_time_q <= from_host_i ? host_time_i : exposed_q;
      tag_configuration_q <= configuration_i;
      tag_size_q <= {4'd0, height_i, 4'd0, width_i};
    end
  end
  always_comb begin
    case (write_q)
      3'd0: write_word = 32'(tag_send_q);
      3'd1: write_word = tag_id_q[31:0];
      3'd2: write_word = tag_id_q[63:32];
      3'd3: write_word = tag_time_q[31:0];
      3'd4: write_word = tag_time_q[63:32];
      3'd5: write_word = tag_size_q;
      default: write_word = tag_configuration_q;
    endcase
  end

  // Serves the requests one after the other.
  logic [Sources-1:0] turn_q, asking, first;
  logic [2:0] read_q;
  logic [FrameBits-1:0] read_frame;
  logic [Sources-1:0] valid_1q;
  assign asking = req_i;
  assign first = asking & (~asking + 1'b1);  // the lowest one
  always_comb begin
    read_frame = '0;
    for (int k = 0; k < Sources; k++)
      read_frame = read_frame | (turn_q[k] ? number_i[FrameBits*k+:FrameBits] : '0);
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      turn_q <= '0;
      read_q <= '0;
      valid_1q <= '0;
      valid_o <= '0;
    end else begin
      if (turn_q == '0) begin
          // Waits until the last words of the previous request are out.
        if (valid_1q == '0 & valid_o == '0) turn_q <= first;
        read_q <= '0;
      end else begin
        read_q <= read_q + 3'd1;
        if (read_q == 3'(Words - 1)) turn_q <= '0;
      end
      valid_1q <= turn_q;
      valid_o <= valid_1q;
    end
  end

  // A source asks for a frame when its first pixels arrive, long after the tags have been written.
  (* no_rw_check, ram_style = "block" *) logic [31:0] memory[0:8*MaxFrames-1];
  logic [31:0] memory_q;
  always_ff @(posedge clk_i) begin
    if (write_q != 3'(Words)) memory[{write_frame_q, write_q}] <= write_word;
    memory_q <= memory[{read_frame, read_q}];
    word_o <= memory_q;
  end
endmodule
