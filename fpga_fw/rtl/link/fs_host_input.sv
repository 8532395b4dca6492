// Turns pairs of images from the host into the pixel stream, in place of the cameras.
//
// Formula   link.md "Frames", stream input: each row has the left image's pixels, then the right
//           one's. Rows come in order, one per packet. Rows that are missing when a later row, the
//           trailer, another leader or the end (no host, or INPUT back at the cameras) comes are
//           filled in: one black pixel with eol per row, which fs_input pads and flags as cut.
// C++ twin  send_pair() and RtlSystemInput in test/rtl/system_input_test.cpp
// Schedule  leader  its 12 bytes
//           row     width bytes into a buffer, then a pair of pixels for each further byte
// Handshake In: packets of fs_packet_finder while packet_i is high; done_o ends a packet. Out: the
//           stream of fs_top. frame_id_o and timestamp_o stay until held_i is low: the frame has
//           begun.
// Limits    A leader must be of stream input, grey, 16 to 1280 x 1 to 1200; others are ignored, and
//           so are rows and trailers that belong to no frame, and repeated rows.
module fs_host_input (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        enable_i,  // INPUT.host, and there is a host
  // A packet of a frame.
  input  logic        packet_i,
  input  logic [7:0]  type_i,
  input  logic [7:0]  stream_i,
  input  logic [15:0] length_i,
  input  logic [15:0] index_i,
  input  logic [63:0] frame_id_i,
  input  logic [63:0] timestamp_i,
  input  logic        byte_valid_i,
  output logic        byte_ready_o,
  input  logic [7:0]  byte_i,
  output logic        done_o,
  // Pixels.
  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o,
  // The frame.
  input  logic        held_i,   // a frame passed on, this or an earlier one, has not begun
  output logic        open_o,
  output logic [63:0] frame_id_o,
  output logic [63:0] timestamp_o,
  output logic        error_o   // pulse: the frame lacked rows or its trailer
);
  localparam int LeaderBytes = fs_pkg::LinkLeaderBytes;
  localparam int MaxWidth = fs_pkg::GatewareMaxWidth;
  localparam int WidthBits = $clog2(MaxWidth + 1);
  typedef enum logic [3:0] {
    Idle, Judge, Take, Open, Left, Right, Fill, Close, Wait, Done
  } state_e;
  state_e state_q;
  logic open_q, lacks_q;
  logic [WidthBits-1:0] width_q, before_last_q, x_q, x_d, next_x_q;  // before_last_q: width_q - 2
  logic at_last_q, next_last_q;  // x_q, next_x_q is the last column
  logic [11:0] height_q, row_q, fill_q;  // rows that are done; rows to fill up to
  logic [15:0] row_bytes_q;
  logic [8*LeaderBytes-1:0] leader_q;
  logic [3:0] count_q;
  logic closes_q;  // the frame ends after the filled rows
  logic packet_q;  // the packet that caused this is judged again

  // Kind of the packet, registered.
  logic is_leader_q, is_rows_q, is_trailer_q, same_q, row_length_q, later_q, next_q;
  logic [15:0] leader_width, leader_height;
  logic leader_ok_q;
  assign leader_width = leader_q[8*fs_pkg::LinkLeaderWidthAt+:16];
  assign leader_height = leader_q[8*fs_pkg::LinkLeaderHeightAt+:16];
  always_ff @(posedge clk_i) begin
    is_leader_q <= stream_i == fs_pkg::StreamInput & type_i == fs_pkg::PacketLeader;
    is_rows_q <= stream_i == fs_pkg::StreamInput & type_i == fs_pkg::PacketRows;
    is_trailer_q <= stream_i == fs_pkg::StreamInput & type_i == fs_pkg::PacketTrailer &
                    length_i == 16'(fs_pkg::LinkTrailerBytes);
    same_q <= frame_id_i == frame_id_o;
    row_length_q <= length_i == row_bytes_q;
    next_q <= index_i == 16'(row_q);
    later_q <= index_i > 16'(row_q) & index_i < 16'(height_q);
    row_bytes_q <= (16'(width_q) * 16'd2 + 16'd3) & 16'hFFFC;
    leader_ok_q <= leader_width >= 16'(fs_pkg::GatewareMinWidth) &
                   leader_width <= 16'(fs_pkg::GatewareMaxWidth) & leader_height != '0 &
                   leader_height <= 16'(fs_pkg::GatewareMaxHeight) &
                   leader_q[8*fs_pkg::LinkLeaderFormatAt+:8] == fs_pkg::FormatGrey;
  end

  // Buffer of the left row.
  // While a byte is written, the next one is read.
  (* no_rw_check *) logic [7:0] row[0:2047];
  logic [7:0] left_q;
  logic go, take_left, take_right;
  assign go = ~valid_o | ready_i;
  assign take_left = state_q == Left & byte_valid_i;
  assign take_right = state_q == Right & byte_valid_i & go;
  assign x_d = take_left | take_right ? next_x_q : x_q;
  always_ff @(posedge clk_i) begin
    before_last_q <= width_q - WidthBits'(2);
    if (state_q == Open) begin
      next_x_q <= WidthBits'(1);
      at_last_q <= 1'b0;
      next_last_q <= 1'b0;
    end else if (take_left | take_right) begin
      next_x_q <= next_last_q ? '0 : next_x_q + 1'b1;
      at_last_q <= next_last_q;
      next_last_q <= next_x_q == before_last_q;
    end
    if (take_left) row[11'(x_q)] <= byte_i;
    left_q <= row[11'(x_d)];
  end
  assign byte_ready_o = state_q == Take | state_q == Left | (state_q == Right & go);
  assign done_o = state_q == Done;
  assign open_o = open_q;

  logic fill;
  assign fill = state_q == Fill & go & row_q != fill_q;
  always_ff @(posedge clk_i) begin
    error_o <= 1'b0;
    x_q <= x_d;
    if (go) begin
      valid_o <= take_right | fill;
      sof_o <= row_q == '0 & x_q == '0;
      eol_o <= fill | at_last_q;
      left_o <= fill ? '0 : left_q;
      right_o <= fill ? '0 : byte_i;
    end
    case (state_q)
      Idle: begin
        count_q <= '0;
        packet_q <= packet_i;
        if (packet_i) begin
          state_q <= Wait;
        end else if (open_q & ~enable_i) begin
          lacks_q <= 1'b1;
          fill_q <= height_q;
          closes_q <= 1'b1;
          state_q <= Fill;
        end
      end
      Wait: state_q <= Judge;
      Judge: begin
        state_q <= Done;
        if (open_q & ((is_leader_q & ~same_q) | (is_trailer_q & same_q) | ~enable_i)) begin
          // Only a trailer says that nothing is missing.
          if (~is_trailer_q | ~same_q) lacks_q <= 1'b1;
          fill_q <= height_q;
          closes_q <= 1'b1;
          state_q <= Fill;
        end else if (is_leader_q & ~open_q & enable_i & length_i == 16'(LeaderBytes)) begin
          // Waits while the outputs still belong to the previous frame.
          state_q <= held_i ? Judge : Take;
        end else if (is_rows_q & open_q & same_q & row_length_q & later_q) begin
          fill_q <= index_i[11:0];
          closes_q <= 1'b0;
          state_q <= Fill;
        end else if (is_rows_q & open_q & same_q & row_length_q & next_q & row_q != height_q) begin
          state_q <= Left;
        end
      end
      Take: if (byte_valid_i) begin
        leader_q <= {byte_i, leader_q[8*LeaderBytes-1:8]};
        count_q <= count_q + 4'd1;
        if (count_q == 4'(LeaderBytes - 1)) state_q <= Open;
      end
      Open: begin
        count_q <= count_q + 4'd1;
        if (count_q == '1) begin
          state_q <= Done;
          open_q <= leader_ok_q;
          lacks_q <= 1'b0;
          row_q <= '0;
          x_q <= '0;
          width_q <= WidthBits'(leader_width);
          height_q <= 12'(leader_height);
          if (leader_ok_q) begin
            frame_id_o <= frame_id_i;
            timestamp_o <= timestamp_i;
          end
        end
      end
      Left: if (take_left & at_last_q) state_q <= Right;
      Right: if (take_right & at_last_q) begin
        row_q <= row_q + 12'd1;
        state_q <= Done;
      end
      Fill: begin
        if (fill) begin
          row_q <= row_q + 12'd1;
          lacks_q <= 1'b1;
        end
        if (row_q == fill_q) state_q <= closes_q ? Close : Wait;
      end
      Close: begin
        open_q <= 1'b0;
        error_o <= lacks_q;
        lacks_q <= 1'b0;
        // A trailer is done; a leader opens the next frame.
        state_q <= packet_q ? Wait : Idle;
      end
      default: state_q <= Idle;  // Done
    endcase
    if (!rst_ni) begin
      state_q <= Idle;
      open_q <= 1'b0;
      valid_o <= 1'b0;
      lacks_q <= 1'b0;
      width_q <= WidthBits'(fs_pkg::GatewareMinWidth);
    end
  end
  logic unused;
  assign unused = ^leader_q;
endmodule
