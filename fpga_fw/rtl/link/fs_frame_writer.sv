// Writes the frames of a stream into its ring, packet by packet. The reader sees complete packets
// only.
//
// Formula   Of a frame that is to be sent: a leader (frame_id low, high, timestamp low, high, size,
//           configuration), its rows, a trailer ({flags, rows}, signature). Without room for the
//           leader the frame is dropped; without room for a row, the row and the rest of the frame
//           except for the trailer are dropped. Each case gives one dropped_o.
// Schedule  word with sof   req_o until all tags of the frame have come; those to be sent are
//                           written as they come
//           word            one word per clock
//           word with eof   followed by the two words of the trailer
// Handshake Stream of words in. kind_valid_o is high for a clock for each complete packet; commit_o
//           then points to its end. Room is reserved for trailers: room_i says that Reserve more
//           words and two more packets fit; it may be some clocks old.
// Limits    Flags of a frame are taken in the clock of its trailer.
module fs_frame_writer #(
  parameter logic [7:0] Stream = 8'd1,
  parameter int PointerBits = 11,
  parameter int FrameBits = 6
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  // Words of fs_frame_words.
  input  logic                   valid_i,
  output logic                   ready_o,
  input  logic                   sof_i,
  input  logic                   eol_i,
  input  logic                   eof_i,
  input  logic [31:0]            word_i,
  input  logic [31:0]            signature_i,
  // Tags and flags of the frame being written.
  output logic                   req_o,
  output logic [FrameBits-1:0]   number_o,
  input  logic                   tag_valid_i,
  input  logic [31:0]            tag_i,
  input  logic [2:0]             flags_i,  // cut, long, buffer: bits of the trailer's flags
  // The ring.
  output logic                   write_o,
  output logic [PointerBits-1:0] at_o,
  output logic [31:0]            data_o,
  output logic [PointerBits-1:0] commit_o,
  output logic                   kind_valid_o,
  output logic [1:0]             kind_o,
  input  logic                   room_i,         // for a word and one more packet
  input  logic                   leader_room_i,  // also for a leader
  output logic                   dropped_o
);
  localparam logic [1:0] Leader = 2'd0, Rows = 2'd1, Trailer = 2'd2;
  localparam int Tags = 7;
  typedef enum logic [1:0] {Words, Ask, Flags, Sign} state_e;
  state_e state_q;
  logic [PointerBits-1:0] at_q;
  logic begun_q;     // the tags of the frame have come
  logic send_q;      // its packets are written
  logic overrun_q;   // drop the rest of its rows
  logic [2:0] tag_q;
  logic [11:0] rows_q;

  logic write, keep;
  logic [31:0] data;
  assign ready_o = state_q == Words & (begun_q | ~sof_i);
  assign keep = send_q & ~overrun_q;
  assign req_o = state_q == Ask;
  always_comb begin
    write = 1'b0;
    data = word_i;
    case (state_q)
      Words: write = valid_i & ready_o & keep & room_i;
      Ask: begin
        write = tag_valid_i & send_q & tag_q != '0;
        data = tag_i;
      end
      Flags: begin
        write = 1'b1;
        data = {12'd0, overrun_q, flags_i, 4'd0, rows_q};
      end
      default: begin
        write = 1'b1;
        data = signature_i;
      end
    endcase
  end
  assign write_o = write;
  assign at_o = at_q;
  assign data_o = data;

  // A dropped row is taken back to the end of the last packet.
  always_ff @(posedge clk_i) begin
    kind_valid_o <= 1'b0;
    dropped_o <= 1'b0;
    if (write) at_q <= at_q + 1'b1;
    case (state_q)
      Words: if (valid_i & sof_i & ~begun_q) begin
        state_q <= Ask;
        number_o <= number_o + 1'b1;
        tag_q <= '0;
        send_q <= 1'b0;
        overrun_q <= 1'b0;
        rows_q <= '0;
      end else if (valid_i) begin
        if (keep & ~room_i) begin
          overrun_q <= 1'b1;
          at_q <= commit_o;
        end
        if (keep & room_i & eol_i) begin
          rows_q <= rows_q + 12'd1;
          commit_o <= at_q + 1'b1;
          kind_o <= Rows;
          kind_valid_o <= 1'b1;
        end
        if (eof_i) begin
          begun_q <= 1'b0;
          if (send_q) state_q <= Flags;
        end
      end
      Ask: if (tag_valid_i) begin
        tag_q <= tag_q + 3'd1;
        if (tag_q == '0) begin
          send_q <= tag_i[5'(Stream)] & leader_room_i;
          dropped_o <= tag_i[5'(Stream)] & ~leader_room_i;
        end
        if (tag_q == 3'(Tags - 1)) begin
          state_q <= Words;
          begun_q <= 1'b1;
          if (send_q) begin
            commit_o <= at_q + 1'b1;
            kind_o <= Leader;
            kind_valid_o <= 1'b1;
          end
        end
      end
      Flags: state_q <= Sign;
      default: begin  // Sign
        state_q <= Words;
        commit_o <= at_q + 1'b1;
        kind_o <= Trailer;
        kind_valid_o <= 1'b1;
        dropped_o <= overrun_q;
      end
    endcase
    if (!rst_ni) begin
      state_q <= Words;
      at_q <= '0;
      commit_o <= '0;
      begun_q <= 1'b0;
      send_q <= 1'b0;
      number_o <= '1;
    end
  end
endmodule
