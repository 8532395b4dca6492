// The top module of fpga_fw/boards/ulx3s_85f between models of the chips at its pins (two sensors,
// the FT232H and a serial line), and a host at the other end of the link.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

#include "Board.h"
#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "link/frame_assembler.hpp"
#include "link/request.hpp"
#include "rtl/link/ft245_chip.hpp"
#include "rtl/link/sensor_port.hpp"

namespace fpga_stereo::test {

using link::AssembledFrame;
using link::PacketType;
using link::Request;

constexpr int kWidth = 64, kHeight = 48;
constexpr int kBitClocks = 32;           // of the serial line
constexpr std::uint8_t kAddress = 0x48;  // of the sensors on the two-wire bus

/// The board, its chips and a host that sends requests and collects frames.
class BoardRig {
 public:
  explicit BoardRig(int switches = 0) : usb(board, 1) {
    board.btn_i = 1;
    board.sw_i = switches;
    board.rxd_i = 1;
    Parameters& p = parameters;
    p.disparity_range = 16;
    p.speckle_size = 30;
    StereoGeometry geometry;
    geometry.image_size = {kWidth, kHeight};
    rectification = identity_rectification(geometry, 0);
    run(300);
  }

  void run(int clocks) {
    for (; clocks > 0 && !testing::Test::HasFatalFailure(); --clocks) clock();
  }
  /// Runs until `done`; throws after `max_clocks`.
  void run_until(const std::function<bool()>& done, int max_clocks = 400000) {
    for (; !done(); max_clocks -= 50) {
      if (max_clocks < 0) throw std::runtime_error("timeout while waiting for the board");
      run(50);
    }
  }

  /// Sends a request over the line that the switch selects; returns the header of its answer.
  link::Header request(const Request& message) {
    link::Header header;
    header.type = message.type;
    header.index = ++request_id_;
    header.sequence = sequence_++;
    std::vector<std::uint8_t> bytes;
    link::append_packet(header, message.payload.data(), message.payload.size(), bytes);
    for (const std::uint8_t byte : bytes) {
      if (uses_serial_line()) {
        serial_out_.push_back(byte);
      } else {
        usb.give(byte);
      }
    }
    has_answer_ = false;
    run_until([&] { return has_answer_; });
    EXPECT_EQ(answer_.index, request_id_);
    return answer_;
  }
  std::uint32_t read(std::uint32_t address) {
    request(link::read_request({address}));
    return values_.at(0).value;
  }
  void write(std::uint32_t address, std::uint32_t value) {
    EXPECT_EQ(request(link::write_request({{address, value}})).type, PacketType::kWritten);
  }
  link::Identity identity() {
    request(link::read_request(link::Identity::registers()));
    return link::Identity::from_values(values_);
  }
  /// Sends meshes and registers, applies them and waits until they take effect.
  void apply_configuration(const GatewareBuild& build) {
    const auto configuration = make_gateware_configuration(build, parameters, rectification);
    ASSERT_TRUE(configuration) << configuration.error().message;
    for (const bool right : {false, true}) {
      const auto& mesh = configuration->mesh[right ? 1 : 0];
      ASSERT_LE(mesh.size(), link::kMaxNodes);
      EXPECT_EQ(request(link::mesh_request(right, mesh, 0, mesh.size())).type,
                PacketType::kWritten);
    }
    EXPECT_EQ(request(link::write_request(configuration->registers)).type, PacketType::kWritten);
    const std::uint32_t before = read(spec::kRegConfiguration);
    write(spec::kRegControl, 1);
    run_until([&] { return read(spec::kRegConfiguration) == before + 1; });
  }
  /// Returns the disparities of the reference pipeline.
  cv::Mat1w run_reference(const cv::Mat1b& left, const cv::Mat1b& right) {
    return pipeline_.process(left, right, rectification, parameters, 1).disparity.clone();
  }
  /// Discards a packet that a reset may have cut short.
  void discard_partial_packet() { decoder_ = {}; }
  std::int64_t clocks() const { return clocks_; }
  /// Runs until one more frame has arrived.
  AssembledFrame next_frame() {
    const std::size_t have = frames.size();
    run_until([&] { return frames.size() > have; });
    return frames[have];
  }

  Board board;
  Ft245Chip<Board> usb;
  SensorPort sensors[2];
  TwoWireSensor registers[2] = {TwoWireSensor(kAddress), TwoWireSensor(kAddress)};
  Parameters parameters = window_parameters();
  StereoRectification rectification;
  std::vector<AssembledFrame> frames;

 private:
  bool uses_serial_line() const { return (board.sw_i & 2) != 0; }

  /// Runs one clock of the core, five clocks of the FT232H, so that USB is faster than the pixels,
  /// and a third of a sensor clock; each sensor has its own phase.
  void clock() {
    run_serial_line();
    const bool has_sensor_edge = ++clocks_ % 3 == 0;
    board.clk_i = 1;
    if (has_sensor_edge) board.pixclk_i = 2;
    board.eval();
    board.clk_i = 0;
    for (int k = 0; k < 5; ++k) usb_clock();
    if (has_sensor_edge) board.pixclk_i = 1;
    board.eval();
    board.pixclk_i = 0;
    if (has_sensor_edge) drive_sensor_pins();
    for (int k = 0; k < 2; ++k) {
      if (!board.sensor_rst_no) registers[k].reset();
      if (registers[k].clock(board.scl_o, (board.sda_o >> k & 1) != 0)) {
        board.sda_low_i |= 1 << k;
      } else {
        board.sda_low_i &= ~(1 << k);
      }
    }
    board.eval();
    receive();
  }
  void usb_clock() {
    board.eval();
    usb.before_edge();
    board.usb_clk_i = 1;
    board.eval();
    board.usb_clk_i = 0;
    board.eval();
    usb.after_edge();
  }
  void drive_sensor_pins() {
    for (int k = 0; k < 2; ++k) {
      const SensorPort::Pins pins = sensors[k].next();
      const unsigned bit = 1U << k;
      board.frame_valid_i = (board.frame_valid_i & ~bit) | (pins.frame ? bit : 0);
      board.line_valid_i = (board.line_valid_i & ~bit) | (pins.line ? bit : 0);
      board.data_pixels_i = (board.data_pixels_i & ~(0xFF << 8 * k)) | pins.data << 8 * k;
    }
  }
  /// Runs one clock of the serial line in both directions, 8N1.
  void run_serial_line() {
    if (out_clocks_left_ == 0 && !serial_out_.empty()) {
      out_bits_ = 0x200U | serial_out_.front() << 1;
      serial_out_.erase(serial_out_.begin());
      out_clocks_left_ = 10 * kBitClocks;
    }
    board.rxd_i = out_clocks_left_ == 0
                      ? 1
                      : out_bits_ >> (10 - (out_clocks_left_ + kBitClocks - 1) / kBitClocks) & 1;
    out_clocks_left_ -= out_clocks_left_ > 0 ? 1 : 0;
    if (in_clock_ < 0) {
      if (!board.txd_o) in_clock_ = 0, in_bits_ = 0;
      return;
    }
    if (++in_clock_ % kBitClocks != kBitClocks / 2) return;
    in_bits_ |= static_cast<unsigned>(board.txd_o) << in_clock_ / kBitClocks;
    if (in_clock_ / kBitClocks == 9) {
      EXPECT_EQ(in_bits_ >> 9, 1U) << "stop bit is low";
      serial_in_.push_back(static_cast<std::uint8_t>(in_bits_ >> 1));
      in_clock_ = -1;
    }
  }
  void receive() {
    decoder_.push(usb.from_fpga.data(), usb.from_fpga.size());
    decoder_.push(serial_in_.data(), serial_in_.size());
    usb.from_fpga.clear(), serial_in_.clear();
    while (const auto packet = decoder_.next()) {
      assembler_.add(*packet, frames);
      if (packet->header.type == PacketType::kRegisters) values_ = *unpack_registers(*packet);
      if (packet->header.type == PacketType::kRegisters ||
          packet->header.type == PacketType::kWritten) {
        answer_ = packet->header, has_answer_ = true;
      }
    }
  }

  link::Decoder decoder_;
  link::FrameAssembler assembler_;
  ReferencePipeline pipeline_;
  std::uint32_t sequence_ = kLinkFirstSequence;
  std::uint16_t request_id_ = 7;
  link::Header answer_;
  std::vector<RegisterWrite> values_;
  bool has_answer_ = false;
  std::int64_t clocks_ = 0;
  std::vector<std::uint8_t> serial_out_, serial_in_;
  int out_clocks_left_ = 0, in_clock_ = -1;  // clocks
  unsigned out_bits_ = 0, in_bits_ = 0;
};

}  // namespace fpga_stereo::test
