// The registers of the link.
//
// Formula   fpga_fw/spec/registers.md, group Link
// C++ twin  fpga_stereo/core/spec.hpp
// Schedule  clock 1: the bus is registered; clock 2: written, or read_valid_o and data_o, as fs_top
// Handshake The bus of fs_top. Other addresses read 0, in both, so the two answers are combined by
//           an OR.
// Limits    bits of STREAMS for streams that are not built stay 0.
module fs_link_registers #(
  parameter int ClockHz = 100000000,
  parameter logic [7:0] Streams = 8'h7E,  // streams that are built: bit s for stream s
  parameter int Sources = 5
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               write_i,
  input  logic               read_i,
  input  logic [7:0]         address_i,
  input  logic [31:0]        data_i,
  output logic               read_valid_o,
  output logic [31:0]        data_o,
  // Settings.
  output logic [7:0]         streams_o,
  output logic [15:0]        pairs_o,
  output logic [15:0]        raw_o,
  output logic               interval_o,  // pulse: pairs_o and raw_o were written
  output logic               host_o,
  output logic [23:0]        mid_exposure_o,
  output logic [31:0]        configuration_o,
  // Pulses.
  input  logic               applied_i,
  input  logic [Sources-1:0] dropped_i,
  input  logic               bad_packet_i,
  input  logic               lost_i,
  input  logic [31:0]        lost_count_i,
  input  logic               input_error_i
);
  localparam logic [7:0] Fields =
      8'd1 << fs_pkg::StreamsDisparityLsb | 8'd1 << fs_pkg::StreamsRectifiedLeftLsb |
      8'd1 << fs_pkg::StreamsRectifiedRightLsb | 8'd1 << fs_pkg::StreamsRawLeftLsb |
      8'd1 << fs_pkg::StreamsRawRightLsb;
  logic write_q, read_q, clear;
  logic [7:0] address_q;
  logic [31:0] data_q;
  assign clear = write_q & address_q == fs_pkg::RegControl & data_q[fs_pkg::ControlClearLsb];

  logic [2:0] dropped, dropped_q;  // frames dropped in this clock
  always_comb begin
    dropped = '0;
    for (int k = 0; k < Sources; k++) dropped = dropped + 3'(dropped_i[k]);
  end

  logic [31:0] dropped_total_q, bad_total_q, lost_total_q, input_total_q, lost_count_q;
  logic bad_q, lost_q, input_q;
  always_ff @(posedge clk_i) begin
    write_q <= rst_ni & write_i;
    read_q <= rst_ni & read_i;
    address_q <= address_i;
    data_q <= data_i;
    dropped_q <= rst_ni ? dropped : '0;
    bad_q <= rst_ni & bad_packet_i;
    lost_q <= rst_ni & lost_i;
    lost_count_q <= lost_count_i;
    input_q <= rst_ni & input_error_i;
    interval_o <= write_q & address_q == fs_pkg::RegFrameInterval;
    if (!rst_ni) begin
      streams_o <= '0;
      pairs_o <= 16'(fs_pkg::RegFrameIntervalReset >> fs_pkg::FrameIntervalPairsLsb);
      raw_o <= 16'(fs_pkg::RegFrameIntervalReset >> fs_pkg::FrameIntervalRawLsb);
      host_o <= 1'b0;
      mid_exposure_o <= '0;
      configuration_o <= '0;
    end else begin
      if (write_q & address_q == fs_pkg::RegStreams) streams_o <= data_q[7:0] & Fields & Streams;
      if (write_q & address_q == fs_pkg::RegFrameInterval) begin
        pairs_o <= data_q[fs_pkg::FrameIntervalPairsLsb+:16];
        raw_o <= data_q[fs_pkg::FrameIntervalRawLsb+:16];
      end
      if (write_q & address_q == fs_pkg::RegInput) host_o <= data_q[fs_pkg::InputHostLsb];
      if (write_q & address_q == fs_pkg::RegMidExposure)
        mid_exposure_o <= data_q[fs_pkg::MidExposureUsLsb+:24];
      if (applied_i) configuration_o <= configuration_o + 32'd1;
    end
    // An event in the clock that clears is counted.
    dropped_total_q <= (clear | ~rst_ni ? '0 : dropped_total_q) + 32'(dropped_q);
    bad_total_q <= (clear | ~rst_ni ? '0 : bad_total_q) + 32'(bad_q);
    lost_total_q <= (clear | ~rst_ni ? '0 : lost_total_q) + (lost_q ? lost_count_q : '0);
    input_total_q <= (clear | ~rst_ni ? '0 : input_total_q) + 32'(input_q);
  end

  logic [31:0] value;
  always_comb begin
    value = '0;
    case (address_q)
      fs_pkg::RegBuildStreams: value = 32'(Streams);
      fs_pkg::RegBuildClock: value = 32'(ClockHz);
      fs_pkg::RegStreams: value = 32'(streams_o);
      fs_pkg::RegFrameInterval:
        value = 32'(pairs_o) << fs_pkg::FrameIntervalPairsLsb |
                32'(raw_o) << fs_pkg::FrameIntervalRawLsb;
      fs_pkg::RegInput: value = 32'(host_o) << fs_pkg::InputHostLsb;
      fs_pkg::RegMidExposure: value = 32'(mid_exposure_o) << fs_pkg::MidExposureUsLsb;
      fs_pkg::RegConfiguration: value = configuration_o;
      fs_pkg::RegFramesDropped: value = dropped_total_q;
      fs_pkg::RegBadPackets: value = bad_total_q;
      fs_pkg::RegLostPackets: value = lost_total_q;
      fs_pkg::RegInputErrors: value = input_total_q;
      default: ;
    endcase
  end
  always_ff @(posedge clk_i) begin
    read_valid_o <= rst_ni & read_q;
    if (read_q) data_o <= value;
  end
endmodule
