// Executes the host's requests on the register bus and answers them.
//
// Formula   link.md "Requests"
// C++ twin  expect_answer() in test/rtl/system_test.cpp
// Schedule  read   per address: its four bytes, the bus, then address and value into the answer
//           write  per register: eight bytes, the bus; after the last one the answer
//           mesh   as write, with MESH_ADDRESS first and MESH_DATA for every further word
// Latency   a write is on the bus 9 clocks after the first of its bytes if one byte comes per
//           clock.
// Handshake In: a packet of fs_packet_finder, while packet_i is high; done_o ends it. Out: the
//           words for fs_packetizer. Bus: read_valid_i and data_i come some clocks after read_o,
//           for one read at a time; data_i stays until the next read.
// Limits    addresses of 8 bits; a larger one reads 0, and a write to it has no effect.
module fs_commands (
  input  logic        clk_i,
  input  logic        rst_ni,
  // A request.
  input  logic        packet_i,
  input  logic [7:0]  version_i,
  input  logic [7:0]  type_i,
  input  logic [15:0] length_i,
  input  logic [15:0] index_i,
  input  logic        byte_valid_i,
  output logic        byte_ready_o,
  input  logic [7:0]  byte_i,
  output logic        done_o,
  // The bus.
  output logic        write_o,
  output logic        read_o,
  output logic [7:0]  address_o,
  output logic [31:0] data_o,
  input  logic        read_valid_i,
  input  logic [31:0] data_i,
  // The answer.
  output logic        valid_o,
  input  logic        ready_i,
  output logic [31:0] word_o,
  output logic        last_o
);
  localparam logic [15:0] MaxRegisters = 16'(fs_pkg::LinkMaxRequestRegisters);
  localparam logic [15:0] MaxMesh = 16'(4 * (1 + fs_pkg::LinkMaxRequestNodes));  // bytes
  localparam int HeaderWords = 6;

  typedef enum logic [3:0] {
    Idle, Decide, Head, Collect, Act, Answer, Why, Flush, Done
  } state_e;
  state_e state_q;
  logic is_read_q, is_write_q, is_mesh_q;
  logic length_ok_q;
  logic [7:0] answer_q;     // type
  logic [15:0] answer_length_q;
  logic [31:0] why_q;
  logic [10:0] left_q;      // bytes of payload left
  logic [31:0] collected_q;
  logic [1:0] byte_q;
  logic [2:0] head_q;       // words of the header
  logic address_known_q;    // of a write: address_q is complete
  logic [31:0] address_q;
  logic in_map, asked_q, got_q;
  assign in_map = address_q[31:8] == '0;

  // The words for fs_packetizer are registered.
  logic go, send, last;
  logic [31:0] word;
  assign go = ~valid_o | ready_i;
  always_comb begin
    send = 1'b0;
    last = 1'b0;
    word = '0;
    case (state_q)
      Head: begin
        send = 1'b1;
        last = head_q == 3'(HeaderWords - 1) & answer_length_q == '0;
        if (head_q == 3'd0) word = {16'd0, answer_q, fs_pkg::LinkVersion};
        if (head_q == 3'd1) word = {index_i, answer_length_q};
      end
      Act: begin
        send = is_read_q & ~asked_q;
        word = address_q;
      end
      Answer: begin
        send = read_valid_i | got_q;
        word = in_map ? data_i : '0;
        last = left_q == '0;
      end
      Why: begin
        send = 1'b1;
        word = why_q;
        last = 1'b1;
      end
      default: ;
    endcase
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_o <= 1'b0;
    end else if (go) begin
      valid_o <= send;
    end
    if (go) begin
      word_o <= word;
      last_o <= last;
    end
  end

  assign byte_ready_o = state_q == Collect;
  assign done_o = state_q == Done;
  logic collected;
  assign collected = byte_valid_i & byte_q == 2'd3;
  always_ff @(posedge clk_i) begin
    write_o <= 1'b0;
    read_o <= 1'b0;
    case (state_q)
      Idle: begin
        is_read_q <= type_i == fs_pkg::PacketReadRegisters;
        is_write_q <= type_i == fs_pkg::PacketWriteRegisters;
        is_mesh_q <= type_i == fs_pkg::PacketWriteMesh;
        left_q <= 11'(length_i);
        byte_q <= '0;
        head_q <= '0;
        address_known_q <= 1'b0;
        asked_q <= 1'b0;
        got_q <= 1'b0;
        case (type_i)
          fs_pkg::PacketReadRegisters:
            length_ok_q <= length_i != '0 & length_i <= MaxRegisters * 16'd4;
          fs_pkg::PacketWriteRegisters:
            length_ok_q <= length_i != '0 & length_i <= MaxRegisters * 16'd8 & ~length_i[2];
          default: length_ok_q <= length_i >= 16'd8 & length_i <= MaxMesh;
        endcase
        if (packet_i) state_q <= Decide;
      end
      Decide: begin
        answer_length_q <= '0;
        if (version_i != fs_pkg::LinkVersion | ~(is_read_q | is_write_q | is_mesh_q) |
            ~length_ok_q) begin
          answer_q <= fs_pkg::PacketRefused;
          answer_length_q <= 16'd4;
          why_q <= version_i != fs_pkg::LinkVersion ? fs_pkg::RefusedVersion :
                   is_read_q | is_write_q | is_mesh_q ? fs_pkg::RefusedLength : fs_pkg::RefusedType;
          is_read_q <= 1'b0;
          state_q <= Head;
        end else if (is_read_q) begin
          answer_q <= fs_pkg::PacketRegisters;
          answer_length_q <= length_i << 1;
          state_q <= Head;
        end else begin
          answer_q <= fs_pkg::PacketWritten;
          state_q <= Collect;
        end
      end
      Head: if (go) begin
        head_q <= head_q + 3'd1;
        if (head_q == 3'(HeaderWords - 1))
          state_q <= answer_length_q == '0 ? Flush : is_read_q ? Collect : Why;
      end
      Collect: if (byte_valid_i) begin
        collected_q <= {byte_i, collected_q[31:8]};
        byte_q <= byte_q + 2'd1;
        left_q <= left_q - 11'd1;
        if (collected) begin
          if (is_read_q | ~address_known_q) address_q <= {byte_i, collected_q[31:8]};
          if (is_mesh_q) address_q <= address_known_q ? 32'(fs_pkg::RegMeshData) :
                                                        32'(fs_pkg::RegMeshAddress);
          // The word was the address of a write; its value follows.
          address_known_q <= is_mesh_q | ~address_known_q;
          if (is_read_q | is_mesh_q | address_known_q) state_q <= Act;
        end
      end
      Act: begin
        if (is_read_q) begin
          if (go) asked_q <= 1'b1;
          if (asked_q) begin
            asked_q <= 1'b0;
            read_o <= 1'b1;
            state_q <= Answer;
          end
        end else begin
          write_o <= in_map;
          state_q <= left_q == '0 ? Head : Collect;
        end
      end
      Answer: begin
        // data_i stays on the bus until the next read.
        got_q <= (got_q | read_valid_i) & ~go;
        if ((read_valid_i | got_q) & go) state_q <= left_q == '0 ? Flush : Collect;
      end
      Why: if (go) state_q <= Flush;
      Flush: if (go) state_q <= Done;
      default: state_q <= Idle;  // Done
    endcase
    if (state_q == Act) begin
      address_o <= address_q[7:0];
      data_o <= collected_q;
    end
    if (!rst_ni) state_q <= Idle;
  end
endmodule
