// Assembles packets: arbitrates between the clients and adds sync, sequence, time and the CRCs.
//
// Formula   link.md "Packets"
// C++ twin  fpga_stereo::link::append_packet (src/link/packet.cpp)
// Words     a client sends {stream, flags, type, version}, {index, length}, frame_id low, high,
//           timestamp low, high, payload, and marks the last word of the packet. In packets other
//           than leaders the timestamp is replaced by the board's clock.
// Schedule  a client is selected 2 clocks after the end of a packet, then one word per clock
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
  logic [31:0] sequence_q, crc_q, crc, word;
  logic [63:0] time_q;

  // Selects a client: the lowest of the first ones; of the others, the next after the last served.
  logic [Clients-1:0] wanted, above, chosen, served_q;
  always_comb begin
    wanted = valid_i;
    for (int k = First; k < Clients; k++)
      if (|valid_i[First-1:0]) wanted[k] = 1'b0;
    above = wanted & ~served_q;
    chosen = above != '0 & wanted[First-1:0] == '0 ? above & (~above + 1'b1)
                                                   : wanted & (~wanted + 1'b1);
  end

  // The client's word, registered.
  logic client_q, client_last_q, fetch, use_word, have_q;
  logic [31:0] client_word, client_word_q;
  logic client_valid, client_last;
  always_comb begin
    client_word = '0;
    for (int k = 0; k < Clients; k++)
      client_word = client_word | (turn_q[k] ? word_i[32*k+:32] : '0);
    client_valid = |(turn_q & valid_i);
    client_last = |(turn_q & last_i);
  end
  assign fetch = client_q & client_valid & (~have_q | use_word);
  assign ready_o = fetch ? turn_q : '0;

  logic room, emit;
  always_comb begin
    use_word = 1'b0;
    emit = 1'b0;
    word = client_word_q;
    case (state_q)
      Sync: begin
        emit = room;
        word = fs_pkg::LinkSync;
      end
      Kind, Length, Payload: begin
        emit = room & have_q;
        use_word = emit;
      end
      Sequence: begin
        emit = room;
        word = sequence_q;
      end
      Tags: begin
        emit = room & have_q;
        use_word = emit;
        if (tag_q[1] & ~leader_q) word = tag_q[0] ? time_q[63:32] : time_q[31:0];
      end
      HeaderCrc: begin
        emit = room;
        word = ~crc_q;
      end
      default: ;
    endcase
    if (payload_crc_q) begin
      emit = room;
      use_word = 1'b0;
      word = ~crc_q;
    end
  end

  logic unused_residue, header_starts;
  assign header_starts = state_q == Sync | state_q == HeaderCrc;
  fs_crc32c #(.Bits(32)) u_crc (
    .crc_i(header_starts ? '1 : crc_q), .data_i(word), .crc_o(crc), .residue_o(unused_residue)
  );
  always_ff @(posedge clk_i) begin
    if (fetch) begin
      client_word_q <= client_word;
      client_last_q <= client_last;
    end
    if (emit) crc_q <= crc;
    if (state_q == Sync) time_q <= us_i;
    if (state_q == Kind & use_word) leader_q <= client_word_q[15:8] == fs_pkg::PacketLeader;
    if (state_q == Tags & use_word) empty_q <= client_last_q;
    if (!rst_ni) begin
      state_q <= Idle;
      turn_q <= '0;
      served_q <= '0;
      client_q <= 1'b0;
      have_q <= 1'b0;
      payload_crc_q <= 1'b0;
      tag_q <= '0;
      sequence_q <= fs_pkg::LinkFirstSequence;
    end else begin
      have_q <= fetch | (have_q & ~use_word);
      if (fetch & client_last) client_q <= 1'b0;
      case (state_q)
        Idle: begin
          turn_q <= chosen;
          client_q <= chosen != '0;
          if (chosen != '0) state_q <= Sync;
          // The clients up to the chosen one have had their turn.
          if (chosen[Clients-1:First] != '0) served_q <= chosen | (chosen - 1'b1);
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
          payload_crc_q <= ~payload_crc_q & client_last_q;
          if (payload_crc_q) state_q <= Idle;
        end
      endcase
    end
  end

  logic [4:0] unused_count;
  fs_stream_fifo #(.Bits(32), .Depth(16)) u_out (
    .clk_i, .rst_ni, .valid_i(emit), .ready_o(room), .data_i(word),
    .valid_o, .ready_i, .data_o(word_o), .count_o(unused_count)
  );
endmodule
