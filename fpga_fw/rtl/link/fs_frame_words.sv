// Packs the pixels of a tap into words of 32 bits, and computes the signature of each frame.
//
// Formula   word = 32 / PixelBits pixels, the first in the low bits; a row is padded with zeros to
//           a whole word. Signature as in fs_signature.
// C++ twin  append_row() in src/link/frame_assembler.cpp; image_signature() in
//           src/core/signature.cpp
// Schedule  A word enters the FIFO 1 clock after its last pixel. signature_o belongs to the frame
//           of the last eof at the input, and stays until the next one.
// Handshake Pixels in whenever valid_i is high; a stream of words out: sof marks a frame's first
//           word, eol a row's last, eof a frame's last.
// Limits    Depth words must suffice while the reader waits: the pixels cannot be stalled.
module fs_frame_words #(
  parameter int PixelBits = 8,  // or 16
  parameter int Depth = 32
) (
  input  logic                 clk_i,
  input  logic                 rst_ni,
  input  logic                 valid_i,
  input  logic                 sof_i,
  input  logic                 eol_i,
  input  logic                 eof_i,
  input  logic [PixelBits-1:0] pixel_i,
  output logic                 valid_o,
  input  logic                 ready_i,
  output logic                 sof_o,
  output logic                 eol_o,
  output logic                 eof_o,
  output logic [31:0]          word_o,
  output logic [31:0]          signature_o
);
  localparam int Lanes = 32 / PixelBits;
  localparam int LaneBits = $clog2(Lanes);
  logic [LaneBits-1:0] lane_q;
  logic [31:0] gathered_q, gathered;
  logic sof_q, push_q, push_sof_q, push_eol_q, push_eof_q, full, unused_ready;
  logic [31:0] push_word_q;
  logic [$clog2(Depth):0] unused_count;
  assign full = lane_q == LaneBits'(Lanes - 1) | eol_i;
  assign gathered = gathered_q | 32'(pixel_i) << (PixelBits * 32'(lane_q));
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      lane_q <= '0;
      gathered_q <= '0;
      push_q <= 1'b0;
      sof_q <= 1'b0;
    end else begin
      push_q <= valid_i & full;
      if (valid_i) begin
        lane_q <= full ? '0 : lane_q + 1'b1;
        gathered_q <= full ? '0 : gathered;
        sof_q <= ~full & (sof_q | sof_i);
      end
    end
    push_word_q <= gathered;
    push_sof_q <= sof_q | sof_i;
    push_eol_q <= eol_i;
    push_eof_q <= eof_i;
  end
  fs_stream_fifo #(.Bits(35), .Depth(Depth)) u_fifo (
    .clk_i, .rst_ni,
    .valid_i(push_q), .ready_o(unused_ready),
    .data_i({push_sof_q, push_eol_q, push_eof_q, push_word_q}),
    .valid_o, .ready_i, .data_o({sof_o, eol_o, eof_o, word_o}), .count_o(unused_count)
  );

  logic [31:0] s, s_q, next_s;
  assign s = sof_i ? fs_pkg::SignatureStart : s_q;
  assign next_s = (s << 1) ^ (s[31] ? fs_pkg::SignaturePolynomial : '0) ^ 32'(pixel_i);
  always_ff @(posedge clk_i) begin
    if (valid_i) s_q <= next_s;
    if (valid_i & eof_i) signature_o <= next_s;
  end
endmodule
