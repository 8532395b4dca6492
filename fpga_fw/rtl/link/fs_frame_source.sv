// One stream of frames: turns the pixels of a tap into packets, through a ring in block RAM.
//
//   fs_frame_words -> fs_frame_writer -> ring -> fs_frame_reader
//
// Formula   link.md "Frames". If the line is too slow, rows (FrameOverrun) or whole frames are
//           dropped; dropped_o reports either. Nothing of a dropped frame reaches the next frame.
// Latency   a row is sent when all of it is in the ring.
// Handshake Pixels in whenever valid_i is high. room_o: there is room for everything that is on its
//           way between fs_input and here, plus a leader and a trailer; a sender that obeys it
//           loses nothing. Packets out: the words for fs_packetizer.
// Limits    RingWords, a power of two, must hold a row and Slack more words; otherwise room_o could
//           stay low forever. At most MaxPackets packets in the ring.
module fs_frame_source #(
  parameter logic [7:0] Stream = 8'd1,
  parameter int PixelBits = 16,  // 16: disparities; 8: grey values
  parameter int MaxWidth = 640,
  parameter int RingWords = 2048,
  parameter int FrameBits = 6
) (
  input  logic                 clk_i,
  input  logic                 rst_ni,
  input  logic                 valid_i,
  input  logic                 sof_i,
  input  logic                 eol_i,
  input  logic                 eof_i,
  input  logic [PixelBits-1:0] pixel_i,
  output logic                 req_o,
  output logic [FrameBits-1:0] number_o,
  input  logic                 tag_valid_i,
  input  logic [31:0]          tag_i,
  input  logic [2:0]           flags_i,
  output logic                 room_o,
  output logic                 dropped_o,
  output logic                 valid_o,
  input  logic                 ready_i,
  output logic [31:0]          word_o,
  output logic                 last_o
);
  localparam int Bits = $clog2(RingWords);
  localparam int RowWords = (MaxWidth * PixelBits + 31) / 32;
  localparam int Slack = 72;  // 32 that wait before the ring, 10 in the pipeline, 8, and a margin
  localparam int Reserve = 4;  // a trailer, and one clock by which the room is outdated
  localparam int LeaderWords = 6;
  localparam int MaxPackets = 32;
  if (RingWords != 1 << Bits || RingWords < RowWords + Slack + 8)
    initial $fatal(1, "fs_frame_source: RingWords is %0d, allowed: a power of two from %0d on",
                   RingWords, RowWords + Slack + 8);

  logic words_valid, words_ready, words_sof, words_eol, words_eof;
  logic [31:0] words, signature;
  fs_frame_words #(.PixelBits(PixelBits), .Depth(32)) u_words (
    .clk_i, .rst_ni, .valid_i, .sof_i, .eol_i, .eof_i, .pixel_i,
    .valid_o(words_valid), .ready_i(words_ready), .sof_o(words_sof), .eol_o(words_eol),
    .eof_o(words_eof), .word_o(words), .signature_o(signature)
  );

  logic write, kind_push, room_q, leader_room_q;
  logic [Bits:0] write_at, commit, read;
  logic [31:0] data;
  logic [1:0] kind_in;
  fs_frame_writer #(
    .Stream(Stream), .PointerBits(Bits + 1), .FrameBits(FrameBits)
  ) u_writer (
    .clk_i, .rst_ni,
    .valid_i(words_valid), .ready_o(words_ready), .sof_i(words_sof), .eol_i(words_eol),
    .eof_i(words_eof), .word_i(words), .signature_i(signature),
    .req_o, .number_o, .tag_valid_i, .tag_i, .flags_i,
    .write_o(write), .at_o(write_at), .data_o(data), .commit_o(commit),
    .kind_valid_o(kind_push), .kind_o(kind_in), .room_i(room_q), .leader_room_i(leader_room_q),
    .dropped_o
  );

  // The ring, read ahead as far as packets are complete.
  logic [31:0] head;
  logic head_valid, head_ready;
  fs_ring_reader #(.Words(RingWords)) u_ring (
    .clk_i, .rst_ni, .write_i(write), .at_i(write_at), .data_i(data), .end_i(commit),
    .jump_i(1'b0), .to_i((Bits + 1)'(0)), .read_o(read), .valid_o(head_valid), .ready_i(head_ready),
    .data_o(head)
  );

  logic kind_valid, kind_ready, unused_kind_ready;
  logic [1:0] kind;
  logic [$clog2(MaxPackets):0] packets;
  fs_stream_fifo #(.Bits(2), .Depth(MaxPackets)) u_kinds (
    .clk_i, .rst_ni, .valid_i(kind_push), .ready_o(unused_kind_ready), .data_i(kind_in),
    .valid_o(kind_valid), .ready_i(kind_ready), .data_o(kind), .count_o(packets)
  );

  // Room. The values are some clocks old; up to two words and one packet may come meanwhile.
  logic [Bits:0] used_q;
  logic few_packets, some_packets;
  assign few_packets = packets <= ($clog2(MaxPackets) + 1)'(MaxPackets / 2);
  assign some_packets = packets <= ($clog2(MaxPackets) + 1)'(MaxPackets - 4);
  always_ff @(posedge clk_i) begin
    used_q <= write_at - read;
    room_q <= used_q <= (Bits + 1)'(RingWords - Reserve - 2) & some_packets;
    leader_room_q <= used_q <= (Bits + 1)'(RingWords - Reserve - LeaderWords - 2) & some_packets;
    room_o <= rst_ni & used_q <= (Bits + 1)'(RingWords - Slack) & few_packets;
  end

  logic read_valid, read_ready, read_last;
  logic [31:0] read_word;
  fs_frame_reader #(.Stream(Stream), .PixelBits(PixelBits)) u_reader (
    .clk_i, .rst_ni, .kind_valid_i(kind_valid), .kind_ready_o(kind_ready), .kind_i(kind),
    .valid_i(head_valid), .ready_o(head_ready), .word_i(head),
    .valid_o(read_valid), .ready_i(read_ready), .word_o(read_word), .last_o(read_last)
  );
  fs_stream_slice #(.Bits(33)) u_out (
    .clk_i, .rst_ni, .valid_i(read_valid), .ready_o(read_ready), .data_i({read_last, read_word}),
    .valid_o, .ready_i, .data_o({last_o, word_o})
  );
endmodule
