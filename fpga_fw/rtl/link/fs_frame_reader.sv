// Turns what fs_frame_writer has put into the ring of a stream into packets.
//
// Formula   link.md "Frames": leader, rows (one row per packet), trailer, all with the frame_id of
//           the leader
// C++ twin  fpga_stereo::link::pack(Leader), pack(Trailer), append_row
//           (src/link/frame_assembler.cpp)
// Schedule  a word per clock if the words of the ring are available
// Handshake In: kind of the next packet, and words of the ring, as streams; out: the words for
//           fs_packetizer.
module fs_frame_reader #(
  parameter logic [7:0] Stream = 8'd1,
  parameter int PixelBits = 16
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        kind_valid_i,
  output logic        kind_ready_o,
  input  logic [1:0]  kind_i,
  input  logic        valid_i,
  output logic        ready_o,
  input  logic [31:0] word_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic [31:0] word_o,
  output logic        last_o
);
  localparam logic [1:0] Leader = 2'd0, Trailer = 2'd2;
  localparam logic [15:0] Format =
      PixelBits == 16 ? 16'(fs_pkg::FormatDisparity) : 16'(fs_pkg::FormatGrey);
  localparam int Lanes = 32 / PixelBits;
  localparam int LaneBits = $clog2(Lanes);
  localparam logic [15:0] LeaderBytes = 16'(fs_pkg::LinkLeaderBytes);
  localparam logic [15:0] TrailerBytes = 16'(fs_pkg::LinkTrailerBytes);
  localparam int FirstOfPayload = 6;

  logic [3:0] step_q;  // word of the packet; 8: from the third of the payload on
  logic [63:0] id_q;
  logic [9:0] row_words_q, left_q;
  logic [11:0] row_q;
  logic leader, trailer, needs, uses, last, go, move;
  logic [31:0] word;
  logic [7:0] type_now;
  logic [15:0] length, index;
  assign leader = kind_i == Leader;
  assign trailer = kind_i == Trailer;
  assign type_now = leader ? fs_pkg::PacketLeader : trailer ? fs_pkg::PacketTrailer :
                                                              fs_pkg::PacketRows;
  assign length = leader ? LeaderBytes : trailer ? TrailerBytes : {4'd0, row_words_q, 2'd0};
  assign index = leader | trailer ? '0 : 16'(row_q);

  always_comb begin
    needs = 1'b0;  // a word of the ring
    uses = 1'b0;   // and consumes it
    last = 1'b0;
    word = word_i;
    case (step_q)
      4'd0: word = {Stream, 8'd0, type_now, fs_pkg::LinkVersion};
      4'd1: word = {index, length};
      4'd2: begin
        needs = leader;
        uses = leader;
        if (!leader) word = id_q[31:0];
      end
      4'd3: begin
        needs = leader;
        uses = leader;
        if (!leader) word = id_q[63:32];
      end
      4'd4, 4'd5: begin
        needs = leader;
        uses = leader;
      end
      4'd6: begin
        needs = 1'b1;
        uses = ~trailer;
        if (trailer) word = {20'd0, word_i[11:0]};
        last = ~leader & ~trailer & left_q == 10'd1;
      end
      4'd7: begin
        needs = ~leader;
        uses = ~leader;
        if (leader) word = {16'd0, Format};
        if (trailer) word = {28'd0, word_i[19:16]};
        last = ~leader & ~trailer & left_q == 10'd1;
      end
      default: begin
        needs = 1'b1;
        uses = 1'b1;
        last = leader | trailer | left_q == 10'd1;
      end
    endcase
  end
  assign go = ~valid_o | ready_i;
  assign move = kind_valid_i & go & (~needs | valid_i);
  assign ready_o = move & uses;
  assign kind_ready_o = move & last;

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_o <= 1'b0;
      step_q <= '0;
    end else begin
      if (go) valid_o <= move;
      if (move) step_q <= last ? '0 : step_q == 4'd8 ? 4'd8 : step_q + 4'd1;
    end
    if (go) begin
      word_o <= word;
      last_o <= last;
    end
    if (move) begin
      if (leader & step_q == 4'd2) id_q[31:0] <= word_i;
      if (leader & step_q == 4'd3) id_q[63:32] <= word_i;
      if (leader & step_q == 4'd6) row_words_q <= 10'((word_i[11:0] + 12'(Lanes - 1)) >> LaneBits);
      left_q <= step_q < 4'(FirstOfPayload) ? row_words_q : left_q - 10'd1;
      if (leader) row_q <= '0;
      else if (last) row_q <= row_q + 12'd1;
    end
  end
endmodule
