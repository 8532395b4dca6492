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
//             Header   the rest of the header;  CheckHeader, three clocks
//             Payload  payload and its CRC;     CheckPayload, three clocks
//             Deliver  packet_o, payload bytes, until done_i
//           A byte at the head of the ring comes with the result of its comparison with the bytes
//           of the sync word. The header and the CRCs take a byte in the clock after it has left
//           the head; a jump of the reading position takes effect a clock after its decision.
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

  // The ring, with read-ahead into a small FIFO. At its head: the byte, and which of the sync's bytes
  // it equal.
  logic [7:0] ahead, head;
  logic [3:0] equal, same;
  logic ahead_valid, ahead_ready, head_valid, take;
  logic rewind, rewind_q, to_sync_q;
  logic [Bits:0] to, to_q, unused_read;
  fs_ring_reader #(.Bits(8), .Words(RingBytes)) u_ring (
    .clk_i, .rst_ni, .write_i(write), .at_i(write_q), .data_i, .end_i(write_q), .jump_i(rewind_q),
    .to_i(to_q), .read_o(unused_read), .valid_o(ahead_valid), .ready_i(ahead_ready), .data_o(ahead)
  );
  for (genvar k = 0; k < 4; k++) begin : g_equals
    assign equal[k] = ahead == fs_pkg::LinkSync[8*k+:8];
  end
  fs_stream_slice #(.Bits(12)) u_head (
    .clk_i, .rst_ni(rst_ni & ~rewind_q), .valid_i(ahead_valid), .ready_o(ahead_ready),
    .data_i({equal, ahead}), .valid_o(head_valid), .ready_i(take), .data_o({same, head})
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
      if (rewind_q) at_q <= to_q;
      else if (take) at_q <= at_q + 1'b1;
    end
  end

  // Silence: there is room for a byte, and none comes.
  logic [SilenceBits-1:0] silence_q;
  logic silent_q, waits_q;
  always_ff @(posedge clk_i) begin
    silent_q <= silence_q == SilenceBits'(SilenceMs);
    waits_q <= at_q == write_q;  // the next byte has not come
    if (!rst_ni | write | ~ready_q) silence_q <= '0;
    else if (ms_i & ~silent_q) silence_q <= silence_q + 1'b1;
  end

  typedef enum logic [2:0] {Sync, Header, CheckHeader, Payload, CheckPayload, Deliver} state_e;
  state_e state_q, state_d;
  logic [1:0] matched_q, settle_q;
  logic [15:0] left_q;  // bytes left of header, payload and CRC, or payload to deliver
  logic last_q, some_q; // left_q is 1; is not 0
  logic [8*(HeaderBytes-CrcBytes)-1:0] header_q;
  logic first, fits, bad, checks, byte_room, delivers;

  assign first = same[0];
  assign fits = same[matched_q];

  // A byte that comes between the decision to give up and its execution needs longer to reach the
  // head.
  logic give_up_q;
  always_ff @(posedge clk_i) begin
    give_up_q <= rst_ni & silent_q & waits_q & ~give_up_q & ~rewind_q &
                 (state_q == Header | state_q == Payload | (state_q == Sync & matched_q != 2'd0));
  end

  // The byte taken in the previous clock goes into the header and the CRCs. The payload's CRC starts
  // with that of the header.
  logic taken_q, of_header_q, starts_q;
  logic [7:0] byte_q;
  logic [31:0] header_crc_q, payload_crc_q, header_crc, payload_crc, start_crc;
  logic header_right, payload_right, header_right_q, payload_right_q, unused_start;
  fs_crc32c #(.Bits(8)) u_header_crc (
    .crc_i(header_crc_q), .data_i(byte_q), .crc_o(header_crc), .residue_o(header_right)
  );
  fs_crc32c #(.Bits(8)) u_payload_crc (
    .crc_i(payload_crc_q), .data_i(byte_q), .crc_o(payload_crc), .residue_o(payload_right)
  );
  // CRC register after the first byte of a sync.
  fs_crc32c #(.Bits(8)) u_start (
    .crc_i(32'hFFFFFFFF), .data_i(fs_pkg::LinkSync[7:0]), .crc_o(start_crc), .residue_o(unused_start)
  );
  always_ff @(posedge clk_i) begin
    taken_q <= take;
    byte_q <= head;
    starts_q <= state_q == Sync & first;
    of_header_q <= state_q == Sync | (state_q == Header & left_q > 16'(CrcBytes));
    if (taken_q) header_crc_q <= starts_q ? start_crc : header_crc;
    if (taken_q) payload_crc_q <= of_header_q ? '1 : payload_crc;
    if (taken_q & of_header_q) header_q <= {byte_q, header_q[8*(HeaderBytes-CrcBytes)-1:8]};
  end

  // Two clocks after the last byte of a header or payload was taken, its CRC is right or wrong; the
  // result and the length's are registered.
  logic length_right_q;
  logic [Bits:0] behind_sync, behind_header, behind_packet;
  assign checks = settle_q[1];
  always_ff @(posedge clk_i) begin
    settle_q <= state_q == CheckHeader | state_q == CheckPayload ? {settle_q[0] & ~checks, ~checks}
                                                                 : '0;
    header_right_q <= header_right;
    payload_right_q <= payload_right;
    length_right_q <= length_o[1:0] == 2'd0 & length_o <= MaxLength;
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
        if (head_valid & ~rewind_q & fits & matched_q == 2'd3) state_d = Header;
      end
      Header: begin
        take = 1'b1;
        if (head_valid & last_q) state_d = CheckHeader;
      end
      CheckHeader: begin
        if (checks) state_d = Payload;
        bad = checks & ~(header_right_q & length_right_q);
      end
      Payload: begin
        take = 1'b1;
        if (head_valid & last_q) state_d = CheckPayload;
      end
      CheckPayload: begin
        if (checks) state_d = Deliver;
        bad = checks & ~payload_right_q;
        rewind = checks;
        to = behind_header;
      end
      default: begin  // Deliver
        take = byte_room & some_q;
        if (done_i) begin
          state_d = Sync;
          rewind = 1'b1;
          to = behind_packet;
        end
      end
    endcase
    if (bad | give_up_q) begin
      state_d = Sync;
      rewind = 1'b1;
      to = behind_sync;
    end
    take = take & head_valid & ~rewind_q & ~give_up_q;
  end

  always_ff @(posedge clk_i) begin
    to_q <= to;
    to_sync_q <= state_d == Sync;
    if (!rst_ni) begin
      state_q <= Sync;
      matched_q <= 2'd0;
      base_q <= '0;
      rewind_q <= 1'b0;
    end else begin
      rewind_q <= rewind;
      state_q <= state_d;
      if (state_q != Sync | state_d != Sync | rewind) matched_q <= 2'd0;
      else if (take) matched_q <= fits ? matched_q + 2'd1 : {1'b0, first};
      // Advances to the first byte that may begin a sync.
      if (rewind_q & to_sync_q) base_q <= to_q;
      else if (state_q == Sync & take & (matched_q == 2'd0 | ~fits))
        base_q <= first ? at_q : at_q + 1'b1;
    end
    case (state_q)
      Sync: left_q <= 16'(HeaderBytes - 4);
      CheckHeader: left_q <= length_o + 16'(CrcBytes);
      CheckPayload: left_q <= length_o;
      default: if (take) left_q <= left_q - 16'd1;
    endcase
    if (state_q == CheckPayload) some_q <= length_o != '0;
    else if (take) some_q <= left_q != 16'd1;
    if (state_q == Header | state_q == Payload) begin
      if (take) last_q <= left_q == 16'd2;
    end else begin
      last_q <= 1'b0;
    end
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
  assign delivers = state_q == Deliver & take;
  fs_stream_slice #(.Bits(8)) u_byte (
    .clk_i, .rst_ni(rst_ni & packet_o), .valid_i(delivers), .ready_o(byte_room), .data_i(head),
    .valid_o(byte_valid_o), .ready_i(byte_ready_i), .data_o(byte_o)
  );

  // Sequence. A step backwards is a repeated or late packet, or a host that started again.
  logic [31:0] sequence_number, expected_q, gap_q;
  logic known_q, intact;
  assign sequence_number = header_q[8*fs_pkg::LinkHeaderSequenceAt+:32];
  assign intact = state_q == CheckPayload & checks & payload_right_q;
  always_ff @(posedge clk_i) begin
    gap_q <= sequence_number - expected_q;
    intact_o <= rst_ni & intact;
    bad_o <= rst_ni & (bad | (give_up_q & state_q == Payload));
    lost_o <= rst_ni & intact & known_q & ~gap_q[31];
    lost_count_o <= gap_q;
    if (!rst_ni) begin
      known_q <= 1'b0;
    end else if (intact) begin
      known_q <= 1'b1;
      expected_q <= sequence_number + 32'd1;
    end
  end
  logic unused;
  assign unused = ^header_q;
endmodule
