// Selects the pixels for fs_top: the cameras' or the host's. Switches between frames.
//
// Formula   Leaves the cameras when the frame's last line has ended, or after SilenceMs without a
//           pixel of a frame; leaves the host when none of its frames is open. In both cases it
//           first waits until every frame passed on has begun, because the tags record the source.
//           Pixels of the source that is not selected are dropped; a camera that has just been
//           selected starts with a whole frame.
// C++ twin  none
// Handshake Streams. held_o: a frame was passed on that has not begun.
// Limits    none
module fs_input_select #(
  parameter int SilenceMs = 100
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        ms_i,
  input  logic        host_i,     // INPUT.host
  input  logic [11:0] height_i,
  input  logic        open_i,     // a frame of the host is in progress
  input  logic        frame_in_i, // a frame has begun
  output logic        host_o,     // the host is selected
  output logic        held_o,
  // Cameras, host, and output: {sof, eol, left, right}.
  input  logic        camera_valid_i,
  output logic        camera_ready_o,
  input  logic [17:0] camera_i,
  input  logic        input_valid_i,
  output logic        input_ready_o,
  input  logic [17:0] input_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic [17:0] data_o
);
  localparam int SilenceBits = $clog2(SilenceMs + 1);
  logic host_q, synced_q;       // host selected; a camera frame has begun since
  logic [11:0] lines_q;         // lines that the camera's frame still lacks
  logic [4:0] held_q;           // frames passed on that have not begun
  logic [SilenceBits-1:0] silence_q;
  logic between, wants, camera_sof, passes, moved, begins;
  assign camera_sof = camera_i[17];
  assign between = lines_q == '0 | silence_q == SilenceBits'(SilenceMs);
  assign wants = host_i & ~host_q;  // to leave the cameras
  assign passes = ~(wants & between) & (camera_sof | synced_q);
  assign valid_o = host_q ? input_valid_i : camera_valid_i & passes;
  assign data_o = host_q ? input_i : camera_i;
  assign camera_ready_o = host_q | ready_i | ~passes;
  assign input_ready_o = host_q & ready_i;
  assign moved = valid_o & ready_i;
  assign begins = moved & data_o[17];
  assign host_o = host_q;
  assign held_o = held_q != '0;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      host_q <= 1'b0;
      synced_q <= 1'b0;
      lines_q <= '0;
      held_q <= '0;
      silence_q <= '0;
    end else begin
      held_q <= held_q + 5'(begins) - 5'(frame_in_i);
      if (host_q | (camera_valid_i & moved)) silence_q <= '0;
      else if (ms_i & silence_q != SilenceBits'(SilenceMs)) silence_q <= silence_q + 1'b1;
      if (!host_q & moved) begin
        synced_q <= 1'b1;
        // sof sets the lines of the frame; eol takes one off.
        if (camera_sof) lines_q <= height_i - 12'(camera_i[16]);
        else if (camera_i[16] & lines_q != '0) lines_q <= lines_q - 12'd1;
      end
      if (wants & between) begin
        host_q <= held_q == '0;
        synced_q <= 1'b0;
        lines_q <= '0;
      end
      if (host_q & ~host_i & ~open_i & ~input_valid_i & held_q == '0) begin
        host_q <= 1'b0;
      end
    end
  end
endmodule
