// The top of fpga_fw/boards/ulx3s_85f, small, between the chips that its pins lead to: sensors, the
// FT232H, a serial line.
#include "Board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/frame_assembler.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/request.hpp"
#include "rtl/link/ft245_chip.hpp"
#include "rtl/link/sensor_port.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

using link::Assembled;
using link::PacketType;
using link::Request;
using link::Stream;

constexpr int kWidth = 64, kHeight = 48, kFar = 6, kNear = 12;
constexpr int kSensorWidth = 72, kSensorHeight = 52;
constexpr int kLeft = 1, kRight = 0;     // in the vectors of ports
constexpr int kBitClocks = 32;           // of the serial line
constexpr std::uint8_t kAddress = 0x48;  // of the sensors
constexpr std::uint32_t kDisparityStream = 1U << 1;

/// The registers of the sensors, as fs_mt9v034 has them.
const std::vector<std::pair<int, int>> kSensorTable = {
    {0x07, 0x0388}, {0x01, 1},  {0x02, 4},      {0x03, 480}, {0x04, 752},
    {0x05, 835},    {0x06, 45}, {0x0D, 0x0300}, {0x0B, 236}, {0xAF, 0x0002}};

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
  void run_until(const std::function<bool()>& done, int max_clocks = 400000) {
    for (; !done(); max_clocks -= 50) {
      if (max_clocks < 0) throw std::runtime_error("nothing more comes");
      run(50);
    }
  }

  /// A request and its answer, by the line that the switch chooses.
  link::Header ask(const Request& request) {
    link::Header header;
    header.type = request.type;
    header.index = ++id_;
    header.sequence = sequence_++;
    std::vector<std::uint8_t> bytes;
    link::append_packet(header, request.payload.data(), request.payload.size(), bytes);
    for (const std::uint8_t byte : bytes) {
      if (serial()) {
        serial_out_.push_back(byte);
      } else {
        usb.give(byte);
      }
    }
    answered_ = false;
    run_until([&] { return answered_; });
    EXPECT_EQ(answer_.index, id_);
    return answer_;
  }
  std::uint32_t read(std::uint32_t address) {
    ask(link::read_request({address}));
    return values_.at(0).value;
  }
  void write(std::uint32_t address, std::uint32_t value) {
    EXPECT_EQ(ask(link::write_request({{address, value}})).type, PacketType::kWritten);
  }
  link::Identity identity() {
    ask(link::read_request(link::Identity::registers()));
    return link::Identity::from_values(values_);
  }
  void configure(const GatewareBuild& build) {
    const auto made = make_gateware_configuration(build, parameters, rectification);
    ASSERT_TRUE(made) << made.error().message;
    for (const bool right : {false, true}) {
      const auto& mesh = made->mesh[right ? 1 : 0];
      ASSERT_LE(mesh.size(), link::kMaxNodes);
      EXPECT_EQ(ask(link::mesh_request(right, mesh, 0, mesh.size())).type, PacketType::kWritten);
    }
    EXPECT_EQ(ask(link::write_request(made->registers)).type, PacketType::kWritten);
    const std::uint32_t before = read(spec::kRegConfiguration);
    write(spec::kRegControl, 1);
    run_until([&] { return read(spec::kRegConfiguration) == before + 1; });
  }
  cv::Mat1w software(const cv::Mat1b& left, const cv::Mat1b& right) {
    return pipeline_.process(left, right, rectification, parameters, 1).disparity.clone();
  }
  /// What came before a reset, and may have been cut.
  void forget() { decoder_ = {}; }
  std::int64_t clocks() const { return clocks_; }
  /// Until one more frame has come.
  Assembled next_frame() {
    const std::size_t have = frames.size();
    run_until([&] { return frames.size() > have; });
    return frames[have];
  }

  Board board;
  Ft245Chip<Board> usb;
  SensorPort sensors[2];
  TwoWireSensor registers[2] = {TwoWireSensor(kAddress), TwoWireSensor(kAddress)};
  Parameters parameters;
  StereoRectification rectification;
  std::vector<Assembled> frames;

 private:
  bool serial() const { return (board.sw_i & 2) != 0; }

  /// A clock of the core; about five of the FT232H's, so that its line is faster than the pixels,
  /// and a third of one of the sensors', each of which has a phase of its own.
  void clock() {
    serial_line();
    const bool sensor = ++clocks_ % 3 == 0;
    board.clk_i = 1;
    if (sensor) board.pixclk_i = 2;
    board.eval();
    board.clk_i = 0;
    for (int k = 0; k < 5; ++k) usb_clock();
    if (sensor) board.pixclk_i = 1;
    board.eval();
    board.pixclk_i = 0;
    if (sensor) show_pixels();
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
  void show_pixels() {
    for (int k = 0; k < 2; ++k) {
      const SensorPort::Pins pins = sensors[k].next();
      const unsigned bit = 1U << k;
      board.frame_valid_i = (board.frame_valid_i & ~bit) | (pins.frame ? bit : 0);
      board.line_valid_i = (board.line_valid_i & ~bit) | (pins.line ? bit : 0);
      board.data_pixels_i = (board.data_pixels_i & ~(0xFF << 8 * k)) | pins.data << 8 * k;
    }
  }
  /// 8N1 both ways.
  void serial_line() {
    if (out_at_ == 0 && !serial_out_.empty()) {
      out_bits_ = 0x200U | serial_out_.front() << 1;
      serial_out_.erase(serial_out_.begin());
      out_at_ = 10 * kBitClocks;
    }
    board.rxd_i =
        out_at_ == 0 ? 1 : out_bits_ >> (10 - (out_at_ + kBitClocks - 1) / kBitClocks) & 1;
    out_at_ -= out_at_ > 0 ? 1 : 0;
    if (in_at_ < 0) {
      if (!board.txd_o) in_at_ = 0, in_bits_ = 0;
      return;
    }
    if (++in_at_ % kBitClocks != kBitClocks / 2) return;
    in_bits_ |= static_cast<unsigned>(board.txd_o) << in_at_ / kBitClocks;
    if (in_at_ / kBitClocks == 9) {
      EXPECT_EQ(in_bits_ >> 9, 1U) << "a stop bit that is none";
      serial_in_.push_back(static_cast<std::uint8_t>(in_bits_ >> 1));
      in_at_ = -1;
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
        answer_ = packet->header, answered_ = true;
      }
    }
  }

  link::Decoder decoder_;
  link::FrameAssembler assembler_;
  ReferencePipeline pipeline_;
  std::uint32_t sequence_ = kLinkFirstSequence;
  std::uint16_t id_ = 7;
  link::Header answer_;
  std::vector<RegisterWrite> values_;
  bool answered_ = false;
  std::int64_t clocks_ = 0;
  std::vector<std::uint8_t> serial_out_, serial_in_;
  int out_at_ = 0, in_at_ = -1;  // clocks
  unsigned out_bits_ = 0, in_bits_ = 0;
};

/// The pattern as its header defines it.
std::pair<cv::Mat1b, cv::Mat1b> pattern() {
  std::uint32_t bits = 0x2C9F51B3;
  cv::Mat1b left(kHeight, kWidth), right(kHeight, kWidth);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    const int x = k % kWidth, y = k / kWidth;
    right(y, x) = static_cast<std::uint8_t>((bits >> 23) ^ (bits >> 20));
    bits = ((bits << 8) | right(y, x)) & 0x7FFFFFFF;
    const bool middle =
        x >= kWidth / 4 && x < 3 * (kWidth / 4) && y >= kHeight / 4 && y < 3 * (kHeight / 4);
    const int from = k - (middle ? kNear : kFar);
    left(y, x) = from < 0 ? 0 : right(from / kWidth, from % kWidth);
  }
  return {left, right};
}

void expect_build(const link::Identity& identity) {
  EXPECT_TRUE(identity.check()) << identity.check().error().message;
  EXPECT_EQ(identity.build.max_width, 64);
  EXPECT_EQ(identity.build.disparities, 16);
  EXPECT_EQ(identity.streams, 0x7E);
  EXPECT_EQ(identity.clock_hz, 10000000U);
}

TEST(Board, CamerasToUsb) {
  BoardRig rig;
  const link::Identity identity = rig.identity();
  expect_build(identity);
  rig.configure(identity.build);
  rig.write(spec::kRegStreams, kDisparityStream);
  std::mt19937 random(3);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    // The right image is the left one, moved; the window is the middle of the sensors' images.
    cv::Mat1b left(kSensorHeight, kSensorWidth), right(kSensorHeight, kSensorWidth);
    for (auto& pixel : left) pixel = static_cast<std::uint8_t>(random());
    for (int x = 0; x < kSensorWidth; ++x) left.col((x + 5) % kSensorWidth).copyTo(right.col(x));
    const SensorPort::Blanking blanking = {5, 20, 2000};
    rig.sensors[kLeft].frame(left, blanking);
    rig.sensors[kRight].frame(right, blanking);
    const Assembled frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, Assembled::Verdict::kGood) << frame.text();
    const cv::Rect window((kSensorWidth - kWidth) / 2, (kSensorHeight - kHeight) / 2, kWidth,
                          kHeight);
    const cv::Mat1w expected = rig.software(left(window).clone(), right(window).clone());
    EXPECT_TRUE(same("disparity", expected, cv::Mat1w(frame.image)));
    EXPECT_GT(cv::countNonZero(expected == 5 * kDisparityScale), kWidth * kHeight / 2);
  }
  EXPECT_EQ(rig.read(spec::kRegFramesOut), 3U);
  EXPECT_EQ(rig.read(spec::kRegErrors), 0U);

  rig.run_until([&] { return rig.registers[0].writes.size() == kSensorTable.size(); });
  rig.run(1000);
  for (const auto& sensor : rig.registers) EXPECT_EQ(sensor.writes, kSensorTable);
  // LEDs: no trouble, both sensors answer, the chip's clock runs, bytes both ways.
  EXPECT_EQ(rig.board.led_o & 0xBE, 0x3E);
  EXPECT_EQ(rig.board.wifi_en_o, 0);
  // A line is missing: no frame is called good, and the board says so.
  const cv::Mat1b black(kSensorHeight, kSensorWidth, std::uint8_t{0});
  rig.sensors[kLeft].frame(black.rowRange(1, kSensorHeight), {5, 20, 2000});
  rig.sensors[kRight].frame(black, {5, 20, 2000});
  rig.sensors[kLeft].idle(kSensorWidth + 20);
  for (auto& sensor : rig.sensors) sensor.frame(black, {5, 20, 2000});
  const Assembled cut = rig.next_frame();
  EXPECT_EQ(cut.verdict, Assembled::Verdict::kFlagged);
  EXPECT_EQ(cut.flags, link::kCutFrame);
  EXPECT_EQ(rig.next_frame().verdict, Assembled::Verdict::kGood);
  EXPECT_EQ(rig.board.led_o >> 7, 1);
  rig.board.btn_i = 3;
  rig.run(20);
  EXPECT_GT(rig.board.led_o, 0);
  EXPECT_LT(rig.board.led_o, 4);
  rig.board.btn_i = 5;
  rig.run(20);
  EXPECT_EQ(rig.board.led_o, 0);
}

TEST(Board, PatternToUsbAndReset) {
  BoardRig rig(1);
  const link::Identity identity = rig.identity();
  rig.configure(identity.build);
  rig.write(spec::kRegStreams, kDisparityStream);
  const auto [left, right] = pattern();
  const cv::Mat1w expected = rig.software(left, right);
  // The pattern is one that has disparities.
  EXPECT_GT(cv::countNonZero(expected == kDisparityScale * kNear), kWidth * kHeight / 16);
  EXPECT_GT(cv::countNonZero(expected == kDisparityScale * kFar), kWidth * kHeight / 16);
  for (int i = 0; i < 3; ++i) {
    const Assembled frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, Assembled::Verdict::kGood) << frame.text();
    EXPECT_TRUE(same("disparity", expected, cv::Mat1w(frame.image)));
  }
  rig.board.btn_i = 0;
  rig.run(50);
  rig.board.btn_i = 1;
  rig.run(300);
  rig.forget();
  EXPECT_EQ(rig.read(spec::kRegStreams), 0U);
}

TEST(Board, TheSwitchChangesBetweenFrames) {
  BoardRig rig;
  rig.configure(rig.identity().build);
  rig.write(spec::kRegStreams, kDisparityStream);
  const cv::Mat1b black(kSensorHeight, kSensorWidth, std::uint8_t{0});
  const auto send = [&] {
    for (auto& sensor : rig.sensors) sensor.frame(black, {5, 20, 2000});
  };
  const cv::Mat1w dark = rig.software(cv::Mat1b(kHeight, kWidth, std::uint8_t{0}),
                                      cv::Mat1b(kHeight, kWidth, std::uint8_t{0}));
  const auto [left, right] = pattern();
  const cv::Mat1w bright = rig.software(left, right);
  // To the pattern: the frame of the cameras is cut, all of the pattern's are whole.
  send();
  rig.run(5000);
  rig.board.sw_i = 1;
  EXPECT_EQ(rig.next_frame().flags, link::kCutFrame);
  for (int i = 0; i < 2; ++i) {
    const Assembled frame = rig.next_frame();
    ASSERT_EQ(frame.verdict, Assembled::Verdict::kGood) << frame.text();
    EXPECT_TRUE(same("disparity", bright, cv::Mat1w(frame.image)));
  }
  // Back to the cameras, in the middle of one of the pattern's and of one of theirs.
  send();
  rig.run(5000);
  rig.board.sw_i = 0;
  send();
  const std::size_t from = rig.frames.size();
  rig.run_until([&] { return rig.sensors[0].done(); });
  rig.run(20000);
  ASSERT_GE(rig.frames.size(), from + 2);
  for (std::size_t i = from; i < rig.frames.size(); ++i) {
    SCOPED_TRACE(i - from);
    const Assembled& frame = rig.frames[i];
    ASSERT_EQ(frame.verdict, Assembled::Verdict::kGood) << frame.text();
    const bool last = i + 1 == rig.frames.size();
    EXPECT_TRUE(same("disparity", last ? dark : bright, cv::Mat1w(frame.image)));
  }
}

TEST(Board, ThePatternOverTheSerialLineHoldsNoSettingsUp) {
  BoardRig rig(2);
  // Two bytes and more for a pixel.
  const std::int64_t line_clocks = std::int64_t{kWidth} * kHeight * 20 * kBitClocks;
  // Two requests over this line take less than a tenth of that.
  const auto apply = [&] {
    const std::uint32_t before = rig.read(spec::kRegConfiguration);
    const std::int64_t start = rig.clocks();
    rig.write(spec::kRegControl, 1);
    EXPECT_EQ(rig.read(spec::kRegConfiguration), before + 1);
    EXPECT_LT(rig.clocks() - start, line_clocks / 10);
  };
  rig.write(spec::kRegWidth, kWidth);
  rig.write(spec::kRegHeight, kHeight);
  apply();
  rig.board.sw_i = 3;
  rig.run(10000);
  apply();
  rig.write(spec::kRegStreams, kDisparityStream);
  rig.run(10000);
  // A frame that somebody asked for is as slow as the line; not so once settings wait for its end.
  const std::uint32_t frames = rig.read(spec::kRegFramesIn);
  rig.run(20000);
  EXPECT_EQ(rig.read(spec::kRegFramesIn), frames);
  rig.write(spec::kRegUniqueness, 500);
  apply();
  EXPECT_GT(rig.read(spec::kRegFramesIn), frames);
}

TEST(Board, RegistersOverTheSerialLine) {
  BoardRig rig(2);
  expect_build(rig.identity());
  rig.write(spec::kRegUniqueness, 500);
  EXPECT_EQ(rig.read(spec::kRegUniqueness), 500U);
  // And by USB again, with nothing lost but the line.
  rig.board.sw_i = 0;
  rig.run(300);
  EXPECT_EQ(rig.read(spec::kRegUniqueness), 500U);
}

}  // namespace
}  // namespace fpga_stereo::test
