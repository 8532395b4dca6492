// A simulated board (fs_system) and a host that talks to it over the link.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "sim/gateware/system.hpp"
#include "top_rig.hpp"

namespace fpga_stereo::test {

using link::AssembledFrame;
using link::Header;
using link::PacketType;
using link::Stream;
using Words = std::vector<std::uint32_t>;
using Verdict = link::FrameVerdict;

/// Returns the path of the model under test; the environment variable FPGA_STEREO_SYSTEM_MODEL
/// overrides it.
inline std::string system_model_path() {
  const char* const path = std::getenv("FPGA_STEREO_SYSTEM_MODEL");
  if (path != nullptr) return path;
  return std::string(FPGA_STEREO_MODELS) + "/fs_system_64_16_11_15_0_10_80_100000_126_4.so";
}

/// Returns the words as bytes in the link's byte order.
inline std::vector<std::uint8_t> bytes_of(const Words& words) {
  std::vector<std::uint8_t> bytes(4 * words.size());
  for (std::size_t i = 0; i < words.size(); ++i) link::put_u32(&bytes[4 * i], words[i]);
  return bytes;
}

/// A received packet with its payload as words.
struct Received {
  Header header;
  Words payload;
};

class SystemRig {
 public:
  explicit SystemRig(std::uint32_t seed = 1) : system_(open_model(seed)) {}

  sim::SystemModel& system() { return system_; }
  const link::DecoderCounters& counters() const { return decoder_.counters(); }
  const link::FrameCounters& frame_counters() const { return assembler_.counters(); }

  /// Sends a packet from the host with the next sequence number; returns its bytes.
  std::vector<std::uint8_t> send(Header header, const std::vector<std::uint8_t>& payload) {
    header.sequence = sequence_++;
    std::vector<std::uint8_t> bytes;
    link::append_packet(header, payload.data(), payload.size(), bytes);
    system_.receive(bytes.data(), bytes.size());
    return bytes;
  }
  /// Skips sequence numbers, as if that many packets of the host had been lost.
  void skip_sequence_numbers(std::uint32_t count) { sequence_ += count; }
  /// Sends a request without waiting for its answer; returns its id.
  std::uint16_t send_request(PacketType type, const Words& payload) {
    Header header;
    header.type = type;
    header.index = ++id_;
    send(header, bytes_of(payload));
    return id_;
  }

  /// Runs the clock and sorts the packets that arrive.
  void run(std::int64_t clocks) {
    const std::int64_t end = system_.clocks() + clocks;
    while (system_.clocks() < end) {
      system_.run(end - system_.clocks());
      receive();
    }
  }
  /// Runs until `done`; throws after `max_clocks`.
  void run_until(const std::function<bool()>& done, std::int64_t max_clocks = 400000) {
    const std::int64_t end = system_.clocks() + max_clocks;
    constexpr std::int64_t kStep = 500;
    while (!done()) {
      if (system_.clocks() >= end) throw std::runtime_error("timeout while waiting for the board");
      system_.run(kStep);
      receive();
    }
  }
  void run_until_frames(std::size_t count) {
    run_until([&] { return frames.size() >= count; });
  }

  /// Sends a request and waits for its answer.
  Received request(PacketType type, const Words& payload) {
    const std::uint16_t id = send_request(type, payload);
    run_until([&] { return !answers.empty(); });
    const Received answer = answers.front();
    answers.erase(answers.begin());
    EXPECT_EQ(answer.header.index, id);
    return answer;
  }
  std::uint32_t read(std::uint32_t address) {
    const Received answer = request(PacketType::kReadRegisters, {address});
    EXPECT_EQ(answer.header.type, PacketType::kRegisters);
    return answer.payload.at(1);
  }
  void write(std::uint32_t address, std::uint32_t value) {
    EXPECT_EQ(request(PacketType::kWriteRegisters, {address, value}).header.type,
              PacketType::kWritten);
  }
  /// Sends all registers and, in packets of their own, the meshes; writes CONTROL.apply last.
  void apply_configuration(const Parameters& parameters, const StereoRectification& rectification) {
    const auto configuration =
        make_gateware_configuration(system_.build(), parameters, rectification);
    if (!configuration) throw std::runtime_error(configuration.error().message);
    constexpr std::size_t kMaxNodes = 255;
    Words mesh;
    const auto send_mesh = [&] {
      if (mesh.empty()) return;
      EXPECT_EQ(request(PacketType::kWriteMesh, mesh).header.type, PacketType::kWritten);
      mesh.clear();
    };
    for (const RegisterWrite& w : configuration->writes()) {
      if (w.address == spec::kRegMeshAddress) {
        send_mesh();
        mesh = {w.value};
      } else if (w.address == spec::kRegMeshData) {
        mesh.push_back(w.value);
        ASSERT_LE(mesh.size(), kMaxNodes);
      } else {
        send_mesh();
        write(w.address, w.value);
      }
    }
  }

  std::vector<Received> packets;  // all, in order of arrival
  std::vector<Received> answers;  // not yet returned by request()
  std::vector<AssembledFrame> frames;
  int heartbeats = 0;

 private:
  static sim::SystemModel open_model(std::uint32_t seed) {
    auto system = sim::SystemModel::open(system_model_path(), seed);
    if (!system) throw std::runtime_error(system.error().message);
    return std::move(*system);
  }
  void receive() {
    std::uint8_t bytes[4096];
    while (const std::size_t size = system_.transmit(bytes, sizeof(bytes))) {
      decoder_.push(bytes, size);
      while (const auto packet = decoder_.next()) sort(*packet);
    }
  }
  void sort(const link::Packet& packet) {
    Received received{packet.header, {}};
    for (int i = 0; i < packet.header.length; i += 4) {
      received.payload.push_back(link::get_u32(packet.payload + i));
    }
    packets.push_back(received);
    switch (packet.header.type) {
      case PacketType::kRegisters:
      case PacketType::kWritten:
      case PacketType::kRefused:
        answers.push_back(received);
        break;
      case PacketType::kHeartbeat:
        ++heartbeats;
        break;
      default:
        assembler_.add(packet, frames);
    }
  }

  sim::SystemModel system_;
  link::Decoder decoder_;
  link::FrameAssembler assembler_;
  std::uint32_t sequence_ = kLinkFirstSequence;
  std::uint16_t id_ = 0xFFF0;
};

/// Returns pipeline parameters that the model under test supports.
inline Parameters system_parameters() {
  Parameters p = window_parameters();
  p.disparity_range = 16;
  p.census_window_size = 11;
  p.census_pattern = CensusPattern::kSparse;
  p.correlation_window_size = 15;
  p.speckle_size = 30;
  return p;
}

/// Returns a stream's bit in the register STREAMS.
inline std::uint32_t stream_bit(Stream stream) { return 1U << static_cast<unsigned>(stream); }
constexpr std::uint32_t kAllStreams = 0x3E;

/// Returns the image that the board must send in this stream for a pair.
inline cv::Mat expected_image(Stream stream, const sim::GreyPair& pair, const Taps& taps) {
  switch (stream) {
    case Stream::kDisparity:
      return taps.disparity;
    case Stream::kRectifiedLeft:
      return taps.left;
    case Stream::kRectifiedRight:
      return taps.right;
    case Stream::kRawLeft:
      return pair.left;
    default:
      return pair.right;
  }
}

}  // namespace fpga_stereo::test
