#include "sim/virtual_board/software_board.hpp"

#include <algorithm>

#include "core/reference_pipeline.hpp"
#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::sim {
namespace {

using link::Header;
using link::Packet;
using link::PacketType;
using link::Stream;

constexpr std::uint64_t kUsPerMs = 1000;
constexpr std::uint64_t kStartTimeUs = 0 - std::uint64_t{10000000};  // wraps after 10 s

std::vector<std::uint32_t> payload_words(const Packet& packet) {
  std::vector<std::uint32_t> words;
  for (std::size_t at = 0; at < packet.header.length; at += 4) {
    words.push_back(link::get_u32(packet.payload + at));
  }
  return words;
}

/// Returns why a request of this type may not have `num_words` words; 0 if it may.
std::uint32_t refusal(PacketType type, std::size_t num_words) {
  switch (type) {
    case PacketType::kReadRegisters:
      return num_words >= 1 && num_words <= link::kMaxReads ? 0 : kRefusedLength;
    case PacketType::kWriteRegisters:
      return num_words >= 2 && num_words % 2 == 0 && num_words <= 2 * link::kMaxWrites
                 ? 0
                 : kRefusedLength;
    case PacketType::kWriteMesh:
      return num_words >= 2 && num_words <= link::kMaxNodes + 1 ? 0 : kRefusedLength;
    default:
      return kRefusedType;
  }
}

bool is_signature(std::uint32_t address) {
  return address >= spec::kRegSignatureRectify &&
         address < spec::kRegSignatureRectify + kNumGatewareStages;
}

}  // namespace

SoftwareBoard::Options::Options() = default;

SoftwareBoard::SoftwareBoard(const Options& options) : options_(options), registers_(options) {
  reset();
}

void SoftwareBoard::reset() {
  registers_.reset();
  has_heard_host_ = false;
  time_us_ = last_byte_us_ = last_packet_us_ = next_heartbeat_us_ = kStartTimeUs;
  sequence_ = kLinkFirstSequence;
  next_frame_id_ = ~std::uint64_t{0} << 32 | kLinkFirstFrame;
  num_pairs_ = num_sent_pairs_ = 0;
  decoder_.reset();
  input_.reset(input_frames_);
  input_frames_.clear();
  queue_.clear();
  queue_read_ = 0;
  cache_.clear();
  last_pair_.reset();
}

std::uint32_t SoftwareBoard::peek(std::uint32_t address) const { return registers_[address % 256]; }

// Bytes and time.

bool SoftwareBoard::is_host_alive() const {
  return has_heard_host_ && time_us_ - last_packet_us_ < kUsPerMs * kHostTimeoutMs;
}

void SoftwareBoard::run(std::chrono::microseconds time) {
  time_us_ += static_cast<std::uint64_t>(time.count());
  if (time_us_ - last_byte_us_ > kUsPerMs * kBoardSilenceMs) {
    last_byte_us_ = time_us_;
    decoder_.discard_partial_packet();
    receive(nullptr, 0);
  }
  if (!is_host_alive() || static_cast<std::int64_t>(time_us_ - next_heartbeat_us_) < 0) return;
  next_heartbeat_us_ = time_us_ + kUsPerMs * kHeartbeatMs;
  answer({}, PacketType::kHeartbeat, {});
}

std::size_t SoftwareBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const link::DecoderCounters before = decoder_.counters();
  if (size > 0) last_byte_us_ = time_us_;
  decoder_.push(bytes, size);
  while (const auto packet = decoder_.next()) handle(*packet);
  const link::DecoderCounters& after = decoder_.counters();
  registers_[spec::kRegBadPackets] += static_cast<std::uint32_t>(
      after.bad_headers + after.bad_payloads - before.bad_headers - before.bad_payloads);
  registers_[spec::kRegLostPackets] +=
      static_cast<std::uint32_t>(after.lost_packets - before.lost_packets);
  return size;
}

std::size_t SoftwareBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  const std::size_t n = std::min(size, queue_.size() - queue_read_);
  std::copy_n(queue_.begin() + static_cast<std::ptrdiff_t>(queue_read_), n, bytes);
  queue_read_ += n;
  if (queue_read_ == queue_.size()) {
    queue_.clear();
    queue_read_ = 0;
  } else if (queue_read_ > options_.max_queued_bytes) {
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(queue_read_));
    queue_read_ = 0;
  }
  return n;
}

// Packets from the host.

void SoftwareBoard::handle(const Packet& packet) {
  has_heard_host_ = true;
  last_packet_us_ = time_us_;
  if (packet.header.version != options_.packet_version) {
    return refuse(packet.header, kRefusedVersion);
  }
  switch (packet.header.type) {
    case PacketType::kLeader:
    case PacketType::kRows:
    case PacketType::kTrailer:
      return handle_input(packet);
    default:
      return handle_request(packet);
  }
}

void SoftwareBoard::handle_request(const Packet& packet) {
  const std::vector<std::uint32_t> words = payload_words(packet);
  if (const std::uint32_t reason = refusal(packet.header.type, words.size()); reason != 0) {
    return refuse(packet.header, reason);
  }
  if (packet.header.type == PacketType::kReadRegisters) {
    if (std::any_of(words.begin(), words.end(), is_signature)) update_signatures();
    std::vector<std::uint8_t> payload(8 * words.size());
    for (std::size_t i = 0; i < words.size(); ++i) {
      link::put_u32(&payload[8 * i], words[i]);
      link::put_u32(&payload[8 * i + 4], registers_.read(words[i]));
    }
    return answer(packet.header, PacketType::kRegisters, payload);
  }
  if (packet.header.type == PacketType::kWriteRegisters) {
    for (std::size_t i = 0; i < words.size(); i += 2) registers_.write(words[i], words[i + 1]);
  } else {
    registers_.write(spec::kRegMeshAddress, words[0]);
    for (std::size_t i = 1; i < words.size(); ++i) registers_.write(spec::kRegMeshData, words[i]);
  }
  answer(packet.header, PacketType::kWritten, {});
}

void SoftwareBoard::answer(const Header& request, PacketType type,
                           const std::vector<std::uint8_t>& payload) {
  Header header;
  header.version = options_.packet_version;
  header.type = type;
  header.index = request.index;
  header.sequence = sequence_++;
  header.timestamp = time_us_;
  link::append_packet(header, payload.data(), payload.size(), queue_);
}

void SoftwareBoard::refuse(const Header& request, std::uint32_t reason) {
  std::vector<std::uint8_t> payload(4);
  link::put_u32(payload.data(), reason);
  answer(request, PacketType::kRefused, payload);
}

void SoftwareBoard::handle_input(const Packet& packet) {
  if (packet.header.stream != Stream::kInput) return refuse(packet.header, kRefusedType);
  input_.add(packet, input_frames_);
  for (link::AssembledFrame& in : input_frames_) {
    if (in.verdict != link::FrameVerdict::kGood) {
      ++registers_[spec::kRegInputErrors];
      continue;
    }
    if (spec::kInputHost.get(registers_[spec::kRegInput]) == 0) continue;
    const int width = in.image.cols / 2;
    const GreyPair pair{in.image.colRange(0, width).clone(),
                        in.image.colRange(width, 2 * width).clone()};
    process(pair, {in.frame_id, in.timestamp});
  }
  input_frames_.clear();
}

// Frames.

void SoftwareBoard::feed(const GreyPair& pair) {
  const std::uint64_t id = next_frame_id_++;
  if (spec::kInputHost.get(registers_[spec::kRegInput]) != 0) return;
  process(pair, {id, time_us_ - spec::kMidExposureUs.get(registers_[spec::kRegMidExposure])});
}

void SoftwareBoard::update_signatures() {
  if (!last_pair_ || last_pair_configuration_ != registers_[spec::kRegConfiguration]) return;
  const BoardRegisters::Active& active = registers_.active();
  ReferencePipeline pipeline;
  const Taps& taps = pipeline.process(last_pair_->left, last_pair_->right, active.rectification,
                                      active.parameters, options_.num_threads);
  std::uint32_t address = spec::kRegSignatureRectify;
  for (const std::uint32_t signature : stage_signatures(taps, active.parameters)) {
    if (options_.overrides.count(address) == 0) registers_[address] = signature;
    ++address;
  }
  last_pair_.reset();
}

/// Counts the frame, and sends what the streams and intervals select of it.
void SoftwareBoard::process(const GreyPair& pair, FrameHeader header) {
  ++registers_[spec::kRegFramesIn];
  ++registers_[spec::kRegFramesOut];
  if (!has_valid_size(pair)) return;
  last_pair_ = pair;
  last_pair_configuration_ = registers_[spec::kRegConfiguration];
  if (has_buffer_error()) {
    ++registers_[spec::kRegBufferErrors];
    registers_[spec::kRegErrors] |= spec::kErrorsBufferLeft.mask();
  }
  if (!is_host_alive()) return;
  const auto interval = [this](spec::Field f) {
    return std::max(1U, f.get(registers_[spec::kRegFrameInterval]));
  };
  if (num_pairs_++ % interval(spec::kFrameIntervalPairs) != 0) return;
  if (num_sent_pairs_++ % interval(spec::kFrameIntervalRaw) == 0) {
    if (is_wanted(Stream::kRawLeft)) send(Stream::kRawLeft, pair.left, header);
    if (is_wanted(Stream::kRawRight)) send(Stream::kRawRight, pair.right, header);
  }
  send_results(pair, header);
}

/// Records the error if the pair does not have the configured size.
bool SoftwareBoard::has_valid_size(const GreyPair& pair) {
  const cv::Size size = registers_.active().rectification.geometry.image_size;
  if (pair.left.size() == size && pair.right.size() == size) return true;
  const bool is_cut = pair.left.total() < static_cast<std::size_t>(size.area());
  ++registers_[is_cut ? spec::kRegCutFrames : spec::kRegLongFrames];
  registers_[spec::kRegErrors] |=
      is_cut ? spec::kErrorsCutFrame.mask() : spec::kErrorsLongFrame.mask();
  return false;
}

bool SoftwareBoard::has_buffer_error() const {
  return registers_.active().is_buffer_too_small || registers_.is_uploading();
}

bool SoftwareBoard::is_wanted(Stream stream) const {
  return link::StreamSet::from_bits(registers_[spec::kRegStreams]).contains(stream);
}

void SoftwareBoard::send_results(const GreyPair& pair, FrameHeader header) {
  if (!is_wanted(Stream::kRectifiedLeft) && !is_wanted(Stream::kRectifiedRight) &&
      !is_wanted(Stream::kDisparity)) {
    return;
  }
  const Outputs& outputs = outputs_of(pair);
  if (has_buffer_error()) header.flags |= kFrameBufferError;
  if (is_wanted(Stream::kRectifiedLeft)) send(Stream::kRectifiedLeft, outputs.left, header);
  if (is_wanted(Stream::kRectifiedRight)) send(Stream::kRectifiedRight, outputs.right, header);
  if (is_wanted(Stream::kDisparity)) send(Stream::kDisparity, outputs.disparity, header);
}

const SoftwareBoard::Outputs& SoftwareBoard::outputs_of(const GreyPair& pair) {
  if (cached_configuration_ != registers_[spec::kRegConfiguration]) cache_.clear();
  cached_configuration_ = registers_[spec::kRegConfiguration];
  for (const Outputs& cached : cache_) {
    if (cached.raw.left.data == pair.left.data && cached.raw.right.data == pair.right.data) {
      return cached;
    }
  }
  const BoardRegisters::Active& active = registers_.active();
  const DisparityFrame& frame = pipeline_.process(pair.left, pair.right, active.rectification,
                                                  active.parameters, options_.num_threads);
  while (!cache_.empty() && cache_.size() >= std::max<std::size_t>(options_.cached_pairs, 1)) {
    cache_.pop_front();
  }
  cache_.push_back({pair, frame.left.clone(), frame.right.clone(), frame.disparity.clone()});
  for (int i = 0; i < options_.wrong_pixels; ++i) cache_.back().disparity(0, i) ^= 1;
  return cache_.back();
}

void SoftwareBoard::send(Stream stream, const cv::Mat& image, const FrameHeader& frame) {
  if (queue_.size() - queue_read_ > options_.max_queued_bytes) {
    ++registers_[spec::kRegFramesDropped];
    return;
  }
  Header header;
  header.version = options_.packet_version;
  header.stream = stream;
  header.frame_id = frame.frame_id;
  header.timestamp = frame.timestamp_us;
  link::append_frame(header, image, registers_[spec::kRegConfiguration], frame.flags,
                     options_.payload_bytes, sequence_, queue_);
}

}  // namespace fpga_stereo::sim
