// Assembles packets: arbitrates between the clients and adds sync, sequence, time and the CRCs.
//
// Formula   link.md "Packets"
// C++ twin  fpga_stereo::link::append_packet (src/link/packet.cpp)
// Words     a client sends {stream, flags, type, version}, {index, length}, frame_id low, high,
//           timestamp low, high, payload, and marks the last word of the packet. In packets other
//           than leaders the timestamp is replaced by the board's clock.
// Schedule  a client is selected 3 clocks after the end of a packet, then one word per clock:
//             1  the client's word, in a register slice
//             2  the word of the packet, or the place of a CRC
//             3  CRC, into the FIFO
// Handshake Streams in and out. A client's packet is not interrupted: it should have its words
//           ready. Clients 0 .. First - 1 have priority, in this order; the others take turns.
module fs_packetizer #(
  parameter int Clients = 7,
  parameter int First = 2
) (
  input  logic                  clk_i,
  input  logic                  rst_ni,
  input  logic [63:0]           us_i,
  input  logic [Clients-1:0]    valid_i,
  output logic [Clients-1:0]    ready_o,
  input  logic [32*Clients-1:0] word_i,
  input  logic [Clients-1:0]    last_i,
  output logic                  valid_o,
  input  logic                  ready_i,
  output logic [31:0]           word_o
);
  typedef enum logic [2:0] {Idle, Sync, Kind, Length, Sequence, Tags, HeaderCrc, Payload} state_e;
  state_e state_q;
  logic payload_crc_q;        // the last word has been sent: its CRC follows
  logic [Clients-1:0] turn_q;
  logic [1:0] tag_q;          // index among the words of frame_id and timestamp
  logic leader_q, empty_q;
  logic [31:0] sequence_q, word;
  logic [63:0] time_q;

  // Selects a client: the lowest of the first ones; of the others, the next after the last served.
  // The clients that want a turn are registered; once valid, they stay so until they are served.
  logic [Clients-1:0] wanted_q, above_q, chosen, served_q, served_d;
  logic looked_q;  // wanted_q and above_q are of clients after the last packet
  always_comb begin
    for (int k = 0; k < Clients; k++) begin
      // The lowest one, without an adder; served_d: up to the chosen one.
      chosen[k] = wanted_q[First-1:0] == '0 & above_q != '0
          ? above_q[k] & (above_q & Clients'((1 << k) - 1)) == '0
          : wanted_q[k] & (wanted_q & Clients'((1 << k) - 1)) == '0;
      served_d[k] = |(chosen >> k);
    end
  end
  always_ff @(posedge clk_i) begin
    wanted_q <= valid_i;
    above_q <= valid_i & ~served_q;
    looked_q <= rst_ni & state_q == Idle & ~looked_q;
  end

  // The client's word. The clients see a register as ready.
  logic client_q, client_valid, client_last, fetch, fetches, have, use_word, word_last;
  logic [31:0] client_word, packet_word;
  always_comb begin
    client_word = '0;
    for (int k = 0; k < Clients; k++)
      client_word = client_word | (turn_q[k] ? word_i[32*k+:32] : '0);
    client_valid = client_q & |(turn_q & valid_i);
    client_last = |(turn_q & last_i);
  end
  assign fetch = client_valid & fetches;
  assign ready_o = turn_q & {Clients{client_q & fetches}};
  fs_stream_slice #(.Bits(33)) u_word (
    .clk_i, .rst_ni, .valid_i(client_valid), .ready_o(fetches),
    .data_i({client_last, client_word}), .valid_o(have), .ready_i(use_word),
    .data_o({word_last, packet_word})
  );

  logic room_q, emit, is_crc;
  always_comb begin
    use_word = 1'b0;
    emit = 1'b0;
    is_crc = 1'b0;
    word = packet_word;
    case (state_q)
      Sync: begin
        emit = room_q;
        word = fs_pkg::LinkSync;
      end
      Kind, Length: begin
        emit = room_q & have;
        use_word = emit;
      end
      Sequence: begin
        emit = room_q;
        word = sequence_q;
      end
      Tags: begin
        emit = room_q & have;
        use_word = emit;
        if (tag_q[1] & ~leader_q) word = tag_q[0] ? time_q[63:32] : time_q[31:0];
      end
      HeaderCrc: begin
        emit = room_q;
        is_crc = 1'b1;
      end
      Payload: begin
        emit = room_q & (have | payload_crc_q);
        use_word = room_q & have & ~payload_crc_q;
        is_crc = payload_crc_q;
      end
      default: ;  // Idle
    endcase
  end

  // The word goes out, or the CRC in its place. The CRC of the payload starts with the header's.
  logic emit_q, is_crc_q, starts_q, unused_residue, unused_ready;
  logic [31:0] word_q, crc_q, crc, out;
  logic [4:0] count;
  assign out = is_crc_q ? ~crc_q : word_q;
  fs_crc32c #(.Bits(32)) u_crc (
    .crc_i(starts_q ? '1 : crc_q), .data_i(out), .crc_o(crc), .residue_o(unused_residue)
  );
  fs_stream_fifo #(.Bits(32), .Depth(16)) u_out (
    .clk_i, .rst_ni, .valid_i(emit_q), .ready_o(unused_ready), .data_i(out),
    .valid_o, .ready_i, .data_o(word_o), .count_o(count)
  );
  always_ff @(posedge clk_i) begin
    // Two words may be on the way when the FIFO's count is read.
    room_q <= rst_ni & count <= 5'd12;
    emit_q <= rst_ni & emit;
    word_q <= word;
    is_crc_q <= is_crc;
    starts_q <= state_q == Sync | state_q == HeaderCrc;
    if (emit_q) crc_q <= crc;
  end

  always_ff @(posedge clk_i) begin
    if (state_q == Sync) time_q <= us_i;
    if (state_q == Kind & use_word) leader_q <= packet_word[15:8] == fs_pkg::PacketLeader;
    if (state_q == Tags & use_word) empty_q <= word_last;
    if (!rst_ni) begin
      state_q <= Idle;
      turn_q <= '0;
      served_q <= '0;
      client_q <= 1'b0;
      payload_crc_q <= 1'b0;
      tag_q <= '0;
      sequence_q <= fs_pkg::LinkFirstSequence;
    end else begin
      if (fetch & client_last) client_q <= 1'b0;
      case (state_q)
        Idle: if (looked_q) begin
          turn_q <= chosen;
          client_q <= wanted_q != '0;
          if (wanted_q != '0) state_q <= Sync;
          // The clients up to the chosen one have had their turn.
          if (chosen[Clients-1:First] != '0) served_q <= served_d;
        end
        Sync: if (emit) state_q <= Kind;
        Kind: if (emit) state_q <= Length;
        Length: if (emit) state_q <= Sequence;
        Sequence: if (emit) begin
          state_q <= Tags;
          sequence_q <= sequence_q + 32'd1;
        end
        Tags: if (emit) begin
          tag_q <= tag_q + 2'd1;
          if (tag_q == 2'd3) state_q <= HeaderCrc;
        end
        HeaderCrc: if (emit) begin
          state_q <= Payload;
          payload_crc_q <= empty_q;
        end
        default: if (emit) begin  // Payload
          payload_crc_q <= ~payload_crc_q & word_last;
          if (payload_crc_q) state_q <= Idle;
        end
      endcase
    end
  end
endmodule
