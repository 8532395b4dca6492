// libFuzzer target for a session. The input is a list of commands, one byte and operands each: the
// virtual board answers, packets with right CRCs and any contents arrive, time passes, or the link
// is lost.
#include <algorithm>
#include <optional>
#include <set>

#include "fuzz/budget.hpp"
#include "link/session_rig.hpp"

namespace {

using fpga_stereo::link::Header;
using fpga_stereo::link::PacketType;
using fpga_stereo::link::Session;
using fpga_stereo::link::Stream;
using fpga_stereo::link::StreamSet;
using fpga_stereo::test::Budget;
using fpga_stereo::test::require;
using fpga_stereo::test::SessionRig;

constexpr StreamSet kStreams = StreamSet::all() - Stream::kInput;
constexpr std::size_t kMaxOutgoing = 8192;  // bytes: one request with its retries

class Program {
 public:
  Program(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool left() const { return size_ > 0; }
  std::uint8_t next() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// Makes a packet of the board from the input.
std::vector<std::uint8_t> packet(Program& program) {
  Header header;
  const std::uint8_t kinds[] = {0x81, 0x82, 0x83, 0x84, 0x10, 0x11, 0x12, program.next()};
  header.type = static_cast<PacketType>(kinds[program.next() % 8]);
  header.stream = static_cast<Stream>(program.next() % 8);
  header.version = program.next() % 16 == 0 ? program.next() : 1;
  header.index = program.next();
  header.frame_id = program.next();
  header.timestamp = std::uint64_t{program.next()} << (program.next() % 64);
  std::vector<std::uint8_t> payload(4 * (program.next() % 20U));
  for (std::uint8_t& byte : payload) byte = program.next();
  std::vector<std::uint8_t> bytes;
  fpga_stereo::link::append_packet(header, payload.data(), payload.size(), bytes);
  return bytes;
}

/// Checks that the images of a set have their stream's type and one size, and that a configuration
/// of the host made them.
void check(const fpga_stereo::link::ReceivedFrames& received, const std::set<std::uint64_t>& tags) {
  require(tags.count(received.tag) != 0, "a configuration of the host made the frames");
  std::optional<cv::Size> size;
  for (int s = 0; s < fpga_stereo::link::kNumStreams; ++s) {
    const cv::Mat& image = received.set.image(static_cast<Stream>(s));
    if (image.empty()) continue;
    require(kStreams.contains(static_cast<Stream>(s)), "the stream is one of a board");
    require(image.type() == (static_cast<Stream>(s) == Stream::kDisparity ? CV_16UC1 : CV_8UC1),
            "the image has the type of its stream");
    require(image.size() == size.value_or(image.size()), "the images have one size");
    size = image.size();
  }
}

/// Checks that a lost link answers every pending request.
void check_lost_line(Session& session, int& unanswered) {
  session.ask(fpga_stereo::link::read_request({0}), [&](const auto&) { --unanswered; });
  ++unanswered;
  session.closed();
  require(unanswered == 0, "every request is answered");
  bool refused = false;
  session.ask(fpga_stereo::link::read_request({0}), [&](const auto& r) { refused = !r; });
  require(refused, "requests without a board are refused");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const cv::Size small(24, 8);  // what computes the frames is not what is tested
  static const SessionRig::Setting settings[] = {SessionRig::setting(1, small),
                                                 SessionRig::setting(2, small)};
  static const auto pair = SessionRig::pair(1, small);
  // A byte of input may let 255 ms pass.
  const Budget budget(size, {0.1, 2e-3, 32 << 20, 1 << 20});
  SessionRig rig;
  Program program(data, size);
  bool answers = false;
  std::set<std::uint64_t> tags;
  int unanswered = 0;
  rig.to_host = [&](std::vector<std::uint8_t>& bytes) {
    if (!answers) bytes.clear();
  };
  for (int steps = 0; program.left() && steps < 40; ++steps) {
    switch (program.next() % 8) {
      case 0:
      case 1:
        answers = true;
        rig.run(1 + program.next() % 30);
        break;
      case 2:
        answers = false;
        rig.run(1 + program.next() % 100);
        break;
      case 3: {
        const auto bytes = packet(program);
        rig.session.receive(bytes.data(), bytes.size(), rig.now, rig.host);
        break;
      }
      case 4: {
        const SessionRig::Setting& setting = settings[program.next() % 2];
        const std::uint8_t tag = program.next();
        tags.insert(tag);
        rig.session.set_desired_state(rig.wanted(setting, tag, kStreams));
        break;
      }
      case 5:
        rig.pairs = {pair};
        break;
      case 6:
        check_lost_line(rig.session, unanswered);
        if (program.next() % 2 == 0) rig.board.reset();
        rig.session.opened(rig.now);
        break;
      default:
        rig.session.ask(fpga_stereo::link::read_request({program.next()}),
                        [&](const auto&) { --unanswered; });
        ++unanswered;
        break;
    }
    require(rig.session.outgoing().size() <= kMaxOutgoing, "one request waits to be sent");
  }
  check_lost_line(rig.session, unanswered);
  for (auto& note : rig.session.take_notes()) rig.notes.push_back(std::move(note));
  require(rig.notes.size() <= 100 + size, "notes are few");
  for (auto& r : rig.session.take_received()) rig.received.push_back(std::move(r));
  for (const fpga_stereo::link::ReceivedFrames& r : rig.received) check(r, tags);
  return 0;
}
