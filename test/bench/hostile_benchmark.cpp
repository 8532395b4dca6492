// How many bytes per second the decoder and a session take from a hostile device, beside those of
// an honest one. Fails if a case is more than 20 times slower: work must grow with the bytes
// received.
#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "link/session_rig.hpp"

namespace fpga_stereo::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using link::Header;
using link::PacketType;
using link::Stream;

constexpr double kFloor = 1.0 / 20;          // of the rate of honest frames
constexpr std::size_t kSize = 1 << 20;       // bytes of a case
constexpr std::size_t kReadBytes = 1 << 16;  // bytes that the device hands over at once
constexpr double kSeconds = 0.5;             // for one measurement

/// Repeats what `append` appends until there are kSize bytes.
Bytes repeat(const std::function<void(Bytes&)>& append) {
  Bytes bytes;
  while (bytes.size() < kSize) append(bytes);
  return bytes;
}

Bytes frames() {
  std::uint32_t sequence = 0;
  Header header;
  header.stream = Stream::kDisparity;
  const cv::Mat1w image(480, 640, std::uint16_t{77});
  return repeat([&](Bytes& bytes) {
    ++header.frame_id;
    link::append_frame(header, image, 1, 0, 8192, sequence, bytes);
  });
}

Bytes leaders(int step) {
  link::Leader leader;
  leader.width = 1280;
  leader.height = 1200;
  leader.configuration = 1;
  const auto contents = pack(leader);
  Header header;
  header.type = PacketType::kLeader;
  header.stream = Stream::kDisparity;
  return repeat([&](Bytes& bytes) {
    header.frame_id += static_cast<std::uint64_t>(step);
    link::append_packet(header, contents.data(), contents.size(), bytes);
  });
}

/// Headers that each claim the bytes of the next 200.
Bytes overlapping() {
  Header header;
  header.length = link::kMaxPayloadBytes;
  const auto claim = pack(header);
  return repeat([&](Bytes& bytes) { bytes.insert(bytes.end(), claim.begin(), claim.end()); });
}

Bytes sync_words() {
  return repeat([](Bytes& bytes) {
    bytes.resize(bytes.size() + 4);
    link::put_u32(&*(bytes.end() - 4), link::kSync);
  });
}

/// Headers that are wrong only in their CRC, as close to each other as the length permits.
Bytes damaged_headers() {
  return repeat([](Bytes& bytes) {
    bytes.resize(bytes.size() + 12);
    link::put_u32(&*(bytes.end() - 12), link::kSync);
  });
}

Bytes noise() {
  std::mt19937 random(1);
  return repeat([&](Bytes& bytes) { bytes.push_back(static_cast<std::uint8_t>(random())); });
}

Bytes versions() {
  Header header;
  return repeat([&](Bytes& bytes) {
    ++header.version;
    link::append_packet(header, nullptr, 0, bytes);
  });
}

/// Frames of a configuration that the host did not make.
Bytes foreign_frames() {
  std::uint32_t sequence = 0;
  Header header;
  header.stream = Stream::kDisparity;
  const cv::Mat1w image(1, 16, std::uint16_t{77});
  return repeat([&](Bytes& bytes) {
    ++header.frame_id;
    link::append_frame(header, image, static_cast<std::uint32_t>(header.frame_id) + 1000, 0, 8192,
                       sequence, bytes);
  });
}

double rate(const Bytes& bytes, const std::function<void(const std::uint8_t*, std::size_t)>& take) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  std::size_t taken = 0;
  std::chrono::duration<double> time{};
  while (time.count() < kSeconds) {
    for (std::size_t at = 0; at < bytes.size(); at += kReadBytes) {
      take(&bytes[at], std::min(kReadBytes, bytes.size() - at));
    }
    taken += bytes.size();
    time = Clock::now() - begin;
  }
  return static_cast<double>(taken) / time.count();
}

double decoder_rate(const Bytes& bytes) {
  link::Decoder decoder;
  return rate(bytes, [&](const std::uint8_t* part, std::size_t size) {
    decoder.push(part, size);
    while (decoder.next()) {
    }
  });
}

double session_rate(const Bytes& bytes) {
  SessionRig rig;
  rig.pairs = {SessionRig::pair(1)};
  rig.session.set_desired_state(rig.wanted(SessionRig::setting(1), 1, Stream::kDisparity));
  rig.run(500);
  return rate(bytes, [&](const std::uint8_t* part, std::size_t size) {
    rig.session.receive(part, size, rig.now, rig.host);
    (void)rig.session.take_received();
    (void)rig.session.take_notes();
  });
}

int run() {
  const std::pair<const char*, Bytes> cases[]{{"honest frames", frames()},
                                              {"leaders, rising ids", leaders(1)},
                                              {"leaders, falling ids", leaders(-1)},
                                              {"overlapping headers", overlapping()},
                                              {"sync words", sync_words()},
                                              {"damaged headers", damaged_headers()},
                                              {"noise", noise()},
                                              {"changing versions", versions()},
                                              {"foreign frames", foreign_frames()}};
  bool is_slow = false;
  double honest_decoder = 0, honest_session = 0;
  std::cout << fmt::format("{:<22}{:>14}{:>14}\n", "MB/s", "decoder", "session");
  for (const auto& [name, bytes] : cases) {
    const double decoder = decoder_rate(bytes), session = session_rate(bytes);
    if (honest_decoder == 0) honest_decoder = decoder, honest_session = session;
    std::cout << fmt::format("{:<22}{:>14.1f}{:>14.1f}\n", name, decoder / 1e6, session / 1e6);
    is_slow |= decoder < kFloor * honest_decoder || session < kFloor * honest_session;
  }
  if (is_slow) std::cout << "a case takes more than 20 times as long as honest frames\n";
  return is_slow ? 1 : 0;
}

}  // namespace
}  // namespace fpga_stereo::test

int main() { return fpga_stereo::test::run(); }
