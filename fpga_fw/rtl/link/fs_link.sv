// The board's end of the link: receives requests and frames of the host, sends answers and frames.
//
//   bytes  -> fs_packet_finder -> fs_commands   -> registers
//                              -> fs_host_input -> fs_input_select -> pixels
//   pixels -> fs_tap -> fs_frame_source, one for each stream -> fs_packetizer -> words
//
// Formula   fpga_fw/spec/link.md, fpga_fw/spec/registers.md
// C++ twin  src/link/decoder.cpp, src/link/frame_assembler.cpp: the host's end
// Schedule  see the modules
// Handshake rx: stream of bytes; tx: stream of words of 32 bits, the low byte first. With the
//           cameras as input their pixels never wait for the line. If the line is too slow, rows
//           and frames are dropped; only the tail of a frame that is still in the pipeline waits
//           (bubble_room_o). With the host as input, room_o holds the whole pipeline.
// Limits    The ring of each stream has RingRows rows of MaxWidth, or the minimum for a row and its
//           packets, rounded up to a power of two.
module fs_link #(
  parameter int MaxWidth = 640,
  parameter int ClockHz = 100000000,
  parameter logic [7:0] Streams = 8'h7E,  // streams to build: bit s for stream s
  parameter int RingRows = 6,
  parameter int MaxFrames = 64  // frames in flight in fs_top
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  // The line.
  input  logic        rx_valid_i,
  output logic        rx_ready_o,
  input  logic [7:0]  rx_data_i,
  output logic        tx_valid_o,
  input  logic        tx_ready_i,
  output logic [31:0] tx_data_o,
  // The cameras: {sof, eol, left, right}.
  input  logic        camera_valid_i,
  output logic        camera_ready_o,
  input  logic [17:0] camera_i,
  // To and from fs_top.
  output logic        write_o,
  output logic        read_o,
  output logic [7:0]  address_o,
  output logic [31:0] data_o,
  input  logic        read_valid_i,
  input  logic [31:0] data_i,
  output logic        pixels_valid_o,
  input  logic        pixels_ready_i,
  output logic [17:0] pixels_o,
  output logic        room_o,
  output logic        bubble_room_o,
  output logic        streaming_o,     // STREAMS is not 0
  input  logic        applied_i,
  input  logic        frame_in_i,
  input  logic        cut_frame_i,
  input  logic        long_frame_i,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  input  logic        raw_valid_i,
  input  logic        raw_sof_i,
  input  logic [15:0] raw_i,           // {right, left}
  input  logic        rectified_valid_i,
  input  logic        rectified_sof_i,
  input  logic        rectified_error_i,
  input  logic [15:0] rectified_i,     // {right, left}
  input  logic        disparity_valid_i,
  input  logic        disparity_sof_i,
  input  logic        disparity_eol_i,
  input  logic        disparity_eof_i,
  input  logic [15:0] disparity_i
);
  localparam int Sources = 5;
  localparam int FrameBits = $clog2(MaxFrames);
  localparam int SilenceMs = 100;
  localparam logic [7:0] Built = Streams & 8'h7E;
  localparam logic TakesInput = Built[3'(fs_pkg::StreamInput)];

  logic [63:0] us;
  logic ms, alive;
  fs_time #(.ClockHz(ClockHz)) u_time (.clk_i, .rst_ni, .us_o(us), .ms_o(ms));

  // Packets from the host.
  logic packet, done, intact, bad, lost, byte_valid, byte_ready;
  logic [7:0] version, kind, stream, payload;
  logic [15:0] length, index;
  logic [63:0] frame_id, timestamp;
  logic [31:0] lost_count;
  fs_packet_finder #(.SilenceMs(SilenceMs)) u_packet_finder (
    .clk_i, .rst_ni, .ms_i(ms), .valid_i(rx_valid_i), .ready_o(rx_ready_o), .data_i(rx_data_i),
    .packet_o(packet), .version_o(version), .type_o(kind), .stream_o(stream), .length_o(length),
    .index_o(index), .frame_id_o(frame_id), .timestamp_o(timestamp), .done_i(done),
    .byte_valid_o(byte_valid), .byte_ready_i(byte_ready), .byte_o(payload),
    .intact_o(intact), .bad_o(bad), .lost_o(lost), .lost_count_o(lost_count)
  );
  logic of_frame, commands_ready, commands_done, input_ready, input_done;
  // A clock late: the header is complete before its packet is announced.
  always_ff @(posedge clk_i)
    of_frame <= version == fs_pkg::LinkVersion &
                (kind == fs_pkg::PacketLeader | kind == fs_pkg::PacketRows |
                 kind == fs_pkg::PacketTrailer);
  assign byte_ready = of_frame ? input_ready : commands_ready;
  assign done = commands_done | input_done;

  // Clients of the packetizer: answers, heartbeats, frames.
  localparam int Clients = 2 + Sources;
  logic [Clients-1:0] client_valid, client_ready, client_last;
  logic [32*Clients-1:0] client_word;

  // Requests. The registers of fs_top and those of the link read 0 at each other's addresses.
  logic [31:0] link_data;
  logic link_read_valid;
  fs_commands u_commands (
    .clk_i, .rst_ni, .packet_i(packet & ~of_frame), .version_i(version), .type_i(kind),
    .length_i(length), .index_i(index), .byte_valid_i(byte_valid & ~of_frame),
    .byte_ready_o(commands_ready), .byte_i(payload), .done_o(commands_done),
    .write_o, .read_o, .address_o, .data_o,
    .read_valid_i(read_valid_i & link_read_valid), .data_i(data_i | link_data),
    .valid_o(client_valid[0]), .ready_i(client_ready[0]), .word_o(client_word[31:0]),
    .last_o(client_last[0])
  );
  logic [7:0] streams;
  logic [15:0] pairs, raw_pairs;
  logic interval, host;
  logic [23:0] mid_exposure;
  logic [31:0] configuration;
  logic [Sources-1:0] dropped;
  logic input_error;
  fs_link_registers #(.ClockHz(ClockHz), .Streams(Built), .Sources(Sources)) u_registers (
    .clk_i, .rst_ni, .write_i(write_o), .read_i(read_o), .address_i(address_o), .data_i(data_o),
    .read_valid_o(link_read_valid), .data_o(link_data),
    .streams_o(streams), .pairs_o(pairs), .raw_o(raw_pairs), .interval_o(interval), .host_o(host),
    .mid_exposure_o(mid_exposure), .configuration_o(configuration),
    .applied_i, .dropped_i(dropped), .bad_packet_i(bad), .lost_i(lost), .lost_count_i(lost_count),
    .input_error_i(input_error)
  );
  fs_heartbeat u_heartbeat (
    .clk_i, .rst_ni, .ms_i(ms), .intact_i(intact), .alive_o(alive),
    .valid_o(client_valid[1]), .ready_i(client_ready[1]), .word_o(client_word[63:32]),
    .last_o(client_last[1])
  );

  // Input: the cameras or the host.
  logic from_host, held, open, input_valid, input_pixel_ready, selected_valid, selected_ready;
  logic [17:0] input_pixel, selected;
  logic [63:0] host_id, host_time;
  if (TakesInput) begin : g_input
    fs_host_input u_host_input (
      .clk_i, .rst_ni, .enable_i(host & alive), .packet_i(packet & of_frame), .type_i(kind),
      .stream_i(stream), .length_i(length), .index_i(index), .frame_id_i(frame_id),
      .timestamp_i(timestamp), .byte_valid_i(byte_valid & of_frame), .byte_ready_o(input_ready),
      .byte_i(payload), .done_o(input_done),
      .valid_o(input_valid), .ready_i(input_pixel_ready), .sof_o(input_pixel[17]),
      .eol_o(input_pixel[16]), .left_o(input_pixel[15:8]), .right_o(input_pixel[7:0]),
      .held_i(held | ~from_host), .open_o(open), .frame_id_o(host_id), .timestamp_o(host_time),
      .error_o(input_error)
    );
  end else begin : g_no_input
    assign input_ready = 1'b0;
    assign input_done = packet & of_frame;
    assign input_valid = 1'b0;
    assign input_pixel = '0;
    assign open = 1'b0;
    assign host_id = '0;
    assign host_time = '0;
    assign input_error = 1'b0;
    logic unused;
    assign unused = ^{stream, frame_id, timestamp, held, input_pixel_ready};
  end
  fs_input_select #(.SilenceMs(SilenceMs)) u_input_select (
    .clk_i, .rst_ni, .ms_i(ms), .host_i(host & TakesInput), .height_i, .open_i(open), .frame_in_i,
    .host_o(from_host), .held_o(held),
    .camera_valid_i, .camera_ready_o, .camera_i,
    .input_valid_i(input_valid), .input_ready_o(input_pixel_ready), .input_i(input_pixel),
    .valid_o(selected_valid), .ready_i(selected_ready), .data_o(selected)
  );
  fs_stream_slice #(.Bits(18)) u_pixels (
    .clk_i, .rst_ni, .valid_i(selected_valid), .ready_o(selected_ready), .data_i(selected),
    .valid_o(pixels_valid_o), .ready_i(pixels_ready_i), .data_o(pixels_o)
  );

  // Tags and flags of each frame.
  logic [Sources-1:0] req, tag_valid;
  logic [Sources*FrameBits-1:0] number;
  logic [31:0] tag;
  fs_frame_tags #(.MaxFrames(MaxFrames), .Sources(Sources)) u_frame_tags (
    .clk_i, .rst_ni, .frame_in_i, .from_host_i(from_host), .host_id_i(host_id),
    .host_time_i(host_time), .us_i(us), .width_i, .height_i, .alive_i(alive), .streams_i(streams),
    .pairs_i(pairs), .raw_i(raw_pairs), .interval_i(interval), .mid_exposure_i(mid_exposure),
    .configuration_i(configuration), .req_i(req), .number_i(number), .valid_o(tag_valid),
    .word_o(tag)
  );
  logic [2*Sources-1:0] input_flags;
  logic [Sources-1:0] buffer_flags;
  fs_frame_flags #(.MaxFrames(MaxFrames), .Flags(2), .Readers(Sources)) u_input_flags (
    .clk_i, .rst_ni, .began_i(frame_in_i), .told_i({long_frame_i, cut_frame_i}), .number_i(number),
    .flags_o(input_flags)
  );
  fs_frame_flags #(.MaxFrames(MaxFrames), .Flags(1), .Readers(Sources)) u_buffer_flags (
    .clk_i, .rst_ni, .began_i(rectified_valid_i & rectified_sof_i),
    .told_i(rectified_valid_i & rectified_error_i), .number_i(number), .flags_o(buffer_flags)
  );

  // The taps: disparity, rectified, raw.
  logic [2:0] tap_valid, tap_sof, tap_eol, tap_eof;
  logic [47:0] tap;
  assign {tap_valid[0], tap_sof[0], tap_eol[0], tap_eof[0], tap[15:0]} =
      {disparity_valid_i, disparity_sof_i, disparity_eol_i, disparity_eof_i, disparity_i};
  fs_tap #(.Bits(16)) u_rectified (
    .clk_i, .rst_ni, .width_i, .height_i, .valid_i(rectified_valid_i), .sof_i(rectified_sof_i),
    .pixel_i(rectified_i), .valid_o(tap_valid[1]), .sof_o(tap_sof[1]), .eol_o(tap_eol[1]),
    .eof_o(tap_eof[1]), .pixel_o(tap[31:16])
  );
  fs_tap #(.Bits(16)) u_raw (
    .clk_i, .rst_ni, .width_i, .height_i, .valid_i(raw_valid_i), .sof_i(raw_sof_i),
    .pixel_i(raw_i), .valid_o(tap_valid[2]), .sof_o(tap_sof[2]), .eol_o(tap_eol[2]),
    .eof_o(tap_eof[2]), .pixel_o(tap[47:32])
  );

  // One source per stream, 1 to 5.
  logic [Sources-1:0] source_room;
  for (genvar k = 0; k < Sources; k++) begin : g_source
    localparam int Tap = (k + 1) / 2;
    localparam int PixelBits = k == 0 ? 16 : 8;
    localparam int First = 16 * Tap + (k == 2 || k == 4 ? 8 : 0);
    localparam int RowWords = (MaxWidth * PixelBits + 31) / 32;
    localparam int Words = (RingRows - 1) * RowWords > 80 ? RingRows * RowWords : RowWords + 80;
    if (Built[k+1]) begin : g_built
      fs_frame_source #(
        .Stream(8'(k + 1)), .PixelBits(PixelBits), .MaxWidth(MaxWidth),
        .RingWords(1 << $clog2(Words)), .FrameBits(FrameBits)
      ) u_source (
        .clk_i, .rst_ni, .valid_i(tap_valid[Tap]), .sof_i(tap_sof[Tap]), .eol_i(tap_eol[Tap]),
        .eof_i(tap_eof[Tap]), .pixel_i(tap[First+:PixelBits]),
        .req_o(req[k]), .number_o(number[FrameBits*k+:FrameBits]), .tag_valid_i(tag_valid[k]),
        .tag_i(tag), .flags_i({Tap != 2 & buffer_flags[k], input_flags[2*k+:2]}),
        .room_o(source_room[k]), .dropped_o(dropped[k]),
        .valid_o(client_valid[2+k]), .ready_i(client_ready[2+k]),
        .word_o(client_word[32*(2+k)+:32]), .last_o(client_last[2+k])
      );
    end else begin : g_none
      assign req[k] = 1'b0;
      assign number[FrameBits*k+:FrameBits] = '0;
      assign source_room[k] = 1'b1;
      assign dropped[k] = 1'b0;
      assign client_valid[2+k] = 1'b0;
      assign client_word[32*(2+k)+:32] = '0;
      assign client_last[2+k] = 1'b0;
      logic unused;
      assign unused = ^{tag_valid[k], client_ready[2+k], buffer_flags[k], input_flags[2*k+:2],
                        tap[First+:PixelBits]};
    end
  end
  always_ff @(posedge clk_i) begin
    room_o <= ~from_host | &source_room;
    bubble_room_o <= &source_room;
    streaming_o <= streams != '0;
  end

  fs_packetizer #(.Clients(Clients), .First(2)) u_packetizer (
    .clk_i, .rst_ni, .us_i(us), .valid_i(client_valid), .ready_o(client_ready),
    .word_i(client_word), .last_i(client_last),
    .valid_o(tx_valid_o), .ready_i(tx_ready_i), .word_o(tx_data_o)
  );
endmodule
