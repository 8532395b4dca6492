// Signature of the output of a stage: one number per frame.
//
// Formula   s = SignatureStart before a frame; for each of its pixels, in raster order,
//           s' = (s << 1) ^ (s[31] ? SignaturePolynomial : 0) ^ word
// C++ twin  Signature in src/core/signature.hpp
// Schedule  tick   the pixel enters s. signature_o is loaded from s with the first tick after the
//           frame (a bubble or the next frame's first pixel), or as soon as busy_i is low, because
//           there may be no tick after the last frame.
// Latency   1 tick, or until 2 clocks after busy_i has fallen.
// Handshake Raster, ignored while stage_rst_ni is low. signature_o keeps its value then; rst_ni
//           sets it to 0.
// Limits    busy_i must not fall before the frame's last pixel has arrived here. For the last stage
//           the word must be taken where fs_output takes its own, not later.
module fs_signature (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        stage_rst_ni,
  input  logic        en_i,
  input  logic        valid_i,
  input  logic        sof_i,
  input  logic [31:0] word_i,
  input  logic        busy_i,  // a frame is in flight: from fs_input
  output logic [31:0] signature_o
);
  logic [31:0] s, s_q;
  logic frame_q;  // s_q belongs to a frame that is not yet in signature_o
  logic take, done;
  assign take = en_i & stage_rst_ni & valid_i;
  assign done = frame_q & ((en_i & (~valid_i | sof_i)) | ~busy_i);
  assign s = sof_i ? fs_pkg::SignatureStart : s_q;
  always_ff @(posedge clk_i) begin
    if (take) s_q <= (s << 1) ^ (s[31] ? fs_pkg::SignaturePolynomial : '0) ^ word_i;
    if (!rst_ni) begin
      frame_q <= 1'b0;
      signature_o <= '0;
    end else begin
      frame_q <= take | (frame_q & ~done);
      if (done) signature_o <= s_q;
    end
  end
endmodule
