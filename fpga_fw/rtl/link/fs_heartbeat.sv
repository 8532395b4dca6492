// Detects whether a host is present, and sends the heartbeat.
//
// Formula   alive_o is high from an intact packet of the host until HostTimeoutMs pass without one.
//           While it is high a heartbeat is sent every HeartbeatMs, the first one at once.
// Handshake packet: the words for fs_packetizer.
module fs_heartbeat (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        ms_i,
  input  logic        intact_i,
  output logic        alive_o,
  output logic        valid_o,
  input  logic        ready_i,
  output logic [31:0] word_o,
  output logic        last_o
);
  localparam int HostBits = $clog2(fs_pkg::HostTimeoutMs + 1);
  localparam int BeatBits = $clog2(fs_pkg::HeartbeatMs);
  localparam int Words = 6;  // up to the end of the header
  logic [HostBits-1:0] silent_q;  // ms
  logic [BeatBits-1:0] beat_q;
  logic [2:0] word_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      alive_o <= 1'b0;
      silent_q <= '0;
      beat_q <= '0;
      valid_o <= 1'b0;
      word_q <= '0;
    end else begin
      if (intact_i) silent_q <= '0;
      else if (ms_i & alive_o) silent_q <= silent_q + 1'b1;
      if (intact_i) alive_o <= 1'b1;
      else if (silent_q == HostBits'(fs_pkg::HostTimeoutMs)) alive_o <= 1'b0;
      if (!alive_o) beat_q <= '0;
      else if (ms_i) beat_q <= beat_q == BeatBits'(fs_pkg::HeartbeatMs - 1) ? '0 : beat_q + 1'b1;
      if (alive_o & ms_i & beat_q == '0) valid_o <= 1'b1;
      else if (ready_i & last_o) valid_o <= 1'b0;
      if (valid_o & ready_i) word_q <= last_o ? '0 : word_q + 3'd1;
    end
  end
  assign last_o = word_q == 3'(Words - 1);
  assign word_o = word_q == '0 ? {16'd0, fs_pkg::PacketHeartbeat, fs_pkg::LinkVersion} : '0;
endmodule
