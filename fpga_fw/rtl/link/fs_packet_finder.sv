// Finds intact packets in the bytes that come from the host, whatever the line did to them.
//
// Formula   link.md "Finding packets": look for sync; header CRC and length; payload CRC. If one is
//           wrong, the search continues one byte after that sync, within the bytes already read.
// C++ twin  fpga_stereo::link::Decoder (src/link/decoder.cpp): finds the same packets and counts
//           the same, except that packets of more than LinkMaxHostPayloadBytes are rejected here
// Schedule  Bytes go into a ring. A packet is read twice: first to check that it is intact, then to
//           hand on its payload. The bytes after the sync stay in the ring until the check is done,
//           so that reading can go back.
//             Sync     look for the sync word, a byte a clock
//             Header   the rest of the header;  CheckHeader
//             Payload  payload and its CRC;     CheckPayload
//             Deliver  packet_o, payload bytes, until done_i
// Latency   about 2 clocks per byte of payload, so at most one byte per two clocks is taken.
// Handshake Bytes in: a stream. The fields of a packet are on the ports while packet_o is high; its
//           payload is a stream of bytes, which may be left unread; done_i ends the packet.
//           After SilenceMs without a byte a partial packet is discarded and its bytes are searched
//           again, as Decoder::give_up does.
// Limits    RingBytes, a power of two, is larger than the largest packet.
module fs_packet_finder #(
  parameter int RingBytes = 8192,
  parameter int SilenceMs = 100
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        ms_i,  // pulse, once a millisecond
  // Bytes.
  input  logic        valid_i,
  output logic        ready_o,
  input  logic [7:0]  data_i,
  // A packet.
  output logic        packet_o,
  output logic [7:0]  version_o,
  output logic [7:0]  type_o,
  output logic [7:0]  stream_o,
  output logic [15:0] length_o,  // of the payload, bytes
  output logic [15:0] index_o,
  output logic [63:0] frame_id_o,
  output logic [63:0] timestamp_o,
  input  logic        done_i,
  output logic        byte_valid_o,
  input  logic        byte_ready_i,
  output logic [7:0]  byte_o,
  // Pulses.
  output logic        intact_o,
  output logic        bad_o,
  output logic        lost_o,
  output logic [31:0] lost_count_o
);
  localparam int Bits = $clog2(RingBytes);
  localparam int HeaderBytes = fs_pkg::LinkHeaderBytes;
  localparam int CrcBytes = 4;
  localparam logic [15:0] MaxLength = 16'(fs_pkg::LinkMaxHostPayloadBytes);
  localparam int SilenceBits = $clog2(SilenceMs + 1);
  if (RingBytes != 1 << Bits || RingBytes < fs_pkg::LinkMaxHostPayloadBytes + 64)
    initial $fatal(1, "fs_packet_finder: RingBytes is %0d, allowed: 8192, 16384, ..", RingBytes);

  // Positions in the stream, one bit wider than a place in the ring: the next byte to write; the
  // next byte to take; the first byte that is not yet decided.
  logic [Bits:0] write_q, at_q, base_q;
  logic write, ready_q;
  assign ready_o = ready_q;
  assign write = valid_i & ready_q;

  // The ring, with read-ahead into a small FIFO.
  logic [7:0] head;
  logic rewind, head_valid, take;
  logic [Bits:0] to, unused_read;
  fs_ring_reader #(.Bits(8), .Words(RingBytes)) u_ring (
    .clk_i, .rst_ni, .write_i(write), .at_i(write_q), .data_i, .end_i(write_q), .jump_i(rewind),
    .to_i(to), .read_o(unused_read), .valid_o(head_valid), .ready_i(take), .data_o(head)
  );
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      write_q <= '0;
      at_q <= '0;
      ready_q <= 1'b0;
    end else begin
      if (write) write_q <= write_q + 1'b1;
      // One clock late: two bytes may come meanwhile.
      ready_q <= write_q - base_q < (Bits + 1)'(RingBytes - 4);
      if (rewind) at_q <= to;
      else if (take) at_q <= at_q + 1'b1;
    end
  end

  // Silence: there is room for a byte, and none comes.
  logic [SilenceBits-1:0] silence_q;
  logic silent, waits;
  assign silent = silence_q == SilenceBits'(SilenceMs);
  assign waits = at_q == write_q;  // the next byte has not come
  always_ff @(posedge clk_i) begin
    if (!rst_ni | write | ~ready_q) silence_q <= '0;
    else if (ms_i & ~silent) silence_q <= silence_q + 1'b1;
  end

  typedef enum logic [2:0] {Sync, Header, CheckHeader, Payload, CheckPayload, Deliver} state_e;
  state_e state_q, state_d;
  logic [1:0] matched_q;
  logic [15:0] left_q;  // bytes left of header, payload and CRC, or payload to deliver
  logic [8*(HeaderBytes-CrcBytes)-1:0] header_q;
  logic [31:0] header_crc_q, payload_crc_q, header_crc, payload_crc;
  logic header_right, payload_right, first, fits, give_up, bad;

  assign first = head == fs_pkg::LinkSync[7:0];
  assign fits = head == fs_pkg::LinkSync[8*matched_q+:8];
  assign give_up = silent & waits &
                   (state_q == Header | state_q == Payload | (state_q == Sync & matched_q != 2'd0));
  fs_crc32c #(.Bits(8)) u_header_crc (
    .crc_i(header_crc_q), .data_i(head), .crc_o(header_crc), .residue_o(header_right)
  );
  fs_crc32c #(.Bits(8)) u_payload_crc (
    .crc_i(payload_crc_q), .data_i(head), .crc_o(payload_crc), .residue_o(payload_right)
  );
  logic [31:0] start_crc;
  logic unused_start;
  // CRC register after the first byte of a sync.
  fs_crc32c #(.Bits(8)) u_start (
    .crc_i(32'hFFFFFFFF), .data_i(fs_pkg::LinkSync[7:0]), .crc_o(start_crc), .residue_o(unused_start)
  );

  logic length_right;
  assign length_right = length_o[1:0] == 2'd0 & length_o <= MaxLength;
  logic [Bits:0] behind_sync, behind_header, behind_packet;
  always_ff @(posedge clk_i) begin
    behind_sync <= base_q + 1'b1;
    behind_header <= base_q + (Bits + 1)'(HeaderBytes);
    behind_packet <= behind_header + (Bits + 1)'(length_o) + (Bits + 1)'(CrcBytes);
  end

  always_comb begin
    state_d = state_q;
    take = 1'b0;
    rewind = 1'b0;
    to = behind_sync;
    bad = 1'b0;
    case (state_q)
      Sync: begin
        take = 1'b1;
        if (head_valid & fits & matched_q == 2'd3) state_d = Header;
      end
      Header: begin
        take = 1'b1;
        if (head_valid & left_q == 16'd1) state_d = CheckHeader;
      end
      CheckHeader: begin
        state_d = Payload;
        bad = ~header_right | ~length_right;
      end
      Payload: begin
        take = 1'b1;
        if (head_valid & left_q == 16'd1) state_d = CheckPayload;
      end
      CheckPayload: begin
        state_d = Deliver;
        bad = ~payload_right;
        rewind = 1'b1;
        to = behind_header;
      end
      default: begin  // Deliver
        take = byte_ready_i & left_q != '0;
        if (done_i) begin
          state_d = Sync;
          rewind = 1'b1;
          to = behind_packet;
        end
      end
    endcase
    if (bad | give_up) begin
      state_d = Sync;
      take = 1'b0;
      rewind = 1'b1;
      to = behind_sync;
    end
    take = take & head_valid;
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q <= Sync;
      matched_q <= 2'd0;
      base_q <= '0;
    end else begin
      state_q <= state_d;
      if (state_d != Sync | rewind) matched_q <= 2'd0;
      else if (take) matched_q <= fits ? matched_q + 2'd1 : {1'b0, first};
      // Advances to the first byte that may begin a sync.
      if (rewind & state_d == Sync) base_q <= to;
      else if (state_q == Sync & take & (matched_q == 2'd0 | ~fits))
        base_q <= first ? at_q : at_q + 1'b1;
    end
    if (state_q == Sync & take & first) header_crc_q <= start_crc;
    else if (take) header_crc_q <= header_crc;
    if (state_q == Header & left_q > 16'(CrcBytes)) payload_crc_q <= '1;
    else if (take) payload_crc_q <= payload_crc;
    if (take & (state_q == Sync | (state_q == Header & left_q > 16'(CrcBytes))))
      header_q <= {head, header_q[8*(HeaderBytes-CrcBytes)-1:8]};
    case (state_q)
      Sync: left_q <= 16'(HeaderBytes - 4);
      CheckHeader: left_q <= length_o + 16'(CrcBytes);
      CheckPayload: left_q <= length_o;
      default: if (take) left_q <= left_q - 16'd1;
    endcase
  end

  // Fields of the header, by their offset.
  assign version_o = header_q[8*fs_pkg::LinkHeaderVersionAt+:8];
  assign type_o = header_q[8*fs_pkg::LinkHeaderTypeAt+:8];
  assign stream_o = header_q[8*fs_pkg::LinkHeaderStreamAt+:8];
  assign length_o = header_q[8*fs_pkg::LinkHeaderLengthAt+:16];
  assign index_o = header_q[8*fs_pkg::LinkHeaderIndexAt+:16];
  assign frame_id_o = header_q[8*fs_pkg::LinkHeaderFrameIdAt+:64];
  assign timestamp_o = header_q[8*fs_pkg::LinkHeaderTimestampAt+:64];
  assign packet_o = state_q == Deliver;
  assign byte_valid_o = state_q == Deliver & head_valid & left_q != '0;
  assign byte_o = head;

  // Sequence. A step backwards is a repeated or late packet, or a host that started again.
  logic [31:0] sequence_number, expected_q, gap;
  logic known_q;
  assign sequence_number = header_q[8*fs_pkg::LinkHeaderSequenceAt+:32];
  assign gap = sequence_number - expected_q;
  always_ff @(posedge clk_i) begin
    intact_o <= rst_ni & state_q == CheckPayload & payload_right;
    bad_o <= rst_ni & (bad | (give_up & state_q == Payload));
    lost_o <= rst_ni & state_q == CheckPayload & payload_right & known_q & ~gap[31];
    lost_count_o <= gap;
    if (!rst_ni) begin
      known_q <= 1'b0;
    end else if (state_q == CheckPayload & payload_right) begin
      known_q <= 1'b1;
      expected_q <= sequence_number + 32'd1;
    end
  end
  logic unused;
  assign unused = ^header_q;
endmodule
