#include "fpga_stereo/link/recording_player.hpp"

#include <algorithm>
#include <utility>

#include "link/clock.hpp"
#include "link/decoder.hpp"
#include "link/frame_set_builder.hpp"
#include "link/recorded_board.hpp"
#include "link/recording.hpp"
#include "link/transport_name.hpp"

namespace fpga_stereo::link {
namespace {

using std::chrono::milliseconds;

/// Raw images accompany some pairs only.
bool has_all(const FrameSet& set, StreamSet expected) {
  const StreamSet optional{Stream::kRawLeft, Stream::kRawRight};
  const StreamSet required = expected - optional;
  const StreamSet wanted = required.empty() ? expected : required;
  for (const Stream stream : wanted) {
    if (set.image(stream).empty()) return false;
  }
  return true;
}

class Player : public RecordingPlayer {
 public:
  Player(RecordReader reader, double speed, StreamSet streams)
      : reader_(std::move(reader)), speed_(speed), clock_(speed), streams_(streams) {}

  Result<std::vector<Frames>> take(milliseconds timeout) override;
  const std::optional<Identity>& identity() const override { return board_.identity(); }
  double speed() const override { return speed_; }
  std::string description() const override { return reader_.description(); }
  DecoderCounters decoder_counters() const override { return from_board_.counters(); }
  FrameCounters frame_counters() const override { return builder_.counters(); }
  Transport::Counters transport_counters() const override { return {bytes_in_, bytes_out_, 0}; }

 private:
  void play(const RecordReader::Record& record);
  void take_from_host();
  void take_from_board();
  void add_frame_packet(const Packet& packet);
  /// Returns the streams that a complete frame set has.
  StreamSet expected() const { return streams_ & board_.streams().value_or(streams_); }
  /// Moves the frame sets that are complete to frames_.
  void collect(bool is_end);

  RecordReader reader_;
  const double speed_;
  const RecordClock clock_;
  const StreamSet streams_;
  RecordReader::Record record_;  // that waits until it is due
  std::optional<Error> end_;
  std::uint64_t bytes_in_ = 0, bytes_out_ = 0;
  Decoder from_board_, from_host_;
  RecordedBoard board_;
  FrameSetBuilder builder_;
  std::vector<FrameSet> sets_;
  std::vector<Frames> frames_;
};

Result<std::vector<RecordingPlayer::Frames>> Player::take(milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (frames_.empty() && !end_) {
    if (record_.bytes.empty()) {
      if (const Status next = reader_.next(record_); !next) {
        end_ = next.error();
        from_board_.discard_partial_packet();
        take_from_board();
        builder_.end(sets_);
        collect(true);
        break;
      }
    }
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
    if (!clock_.wait(record_.time, std::max(left, milliseconds(0)))) break;
    play(record_);
    record_.bytes.clear();
    if (Clock::now() >= deadline) break;
  }
  if (frames_.empty() && end_) return *end_;
  return std::exchange(frames_, {});
}

void Player::play(const RecordReader::Record& record) {
  if (record.is_from_host) {
    bytes_out_ += record.bytes.size();
    from_host_.push(record.bytes.data(), record.bytes.size());
    take_from_host();
  } else {
    bytes_in_ += record.bytes.size();
    from_board_.push(record.bytes.data(), record.bytes.size());
    take_from_board();
  }
}

void Player::take_from_host() {
  while (const auto packet = from_host_.next()) {
    board_.add_from_host(*packet);
  }
  const DecoderCounters& counters = from_host_.counters();
  if (counters.lost_packets + counters.bad_headers + counters.bad_payloads > 0) board_.forget();
}

void Player::take_from_board() {
  while (const auto packet = from_board_.next()) {
    switch (packet->header.type) {
      case PacketType::kLeader:
      case PacketType::kRows:
      case PacketType::kTrailer:
        add_frame_packet(*packet);
        break;
      default:
        board_.add_from_board(*packet);
    }
  }
}

void Player::add_frame_packet(const Packet& packet) {
  const Header& header = packet.header;
  if (static_cast<int>(header.stream) >= kNumStreams || !streams_.contains(header.stream)) return;
  builder_.add(packet, expected(), sets_);
  collect(false);
}

void Player::collect(bool is_end) {
  for (FrameSet& set : sets_) {
    // Where the recording breaks off, frames that had not begun are not lost. Without the host's
    // bytes, nobody knows which were to come.
    const bool is_cut = is_end && board_.streams() && !has_all(set, expected());
    if (is_cut && set.dropped.empty()) continue;
    auto configuration = board_.configuration(set.configuration);
    frames_.push_back({std::move(set), std::move(configuration)});
  }
  sets_.clear();
}

}  // namespace

Result<std::unique_ptr<RecordingPlayer>> RecordingPlayer::open(const std::string& name,
                                                               StreamSet streams) {
  const auto selection = parse_transport_name(name);
  if (!selection) return selection.error();
  if (selection->kind != TransportName::Kind::kReplay) {
    return Error{ErrorKind::kInvalid, "'" + name + "' is not a recording"};
  }
  auto reader = RecordReader::open(selection->path);
  if (!reader) return reader.error();
  return std::unique_ptr<RecordingPlayer>(
      std::make_unique<Player>(std::move(*reader), selection->number, streams));
}

}  // namespace fpga_stereo::link
