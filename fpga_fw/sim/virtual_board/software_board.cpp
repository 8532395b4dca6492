#include "sim/virtual_board/software_board.hpp"

#include <algorithm>

#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::sim {
namespace {

using link::Header;
using link::Packet;
using link::PacketType;
using link::Stream;

constexpr std::uint64_t kSilence = std::uint64_t{1000} * kBoardSilenceMs;
constexpr std::uint64_t kFirstTime = 0 - std::uint64_t{10000000};  // us: wraps after 10 s

std::vector<std::uint32_t> words(const Packet& packet) {
  std::vector<std::uint32_t> all;
  for (std::size_t at = 0; at < packet.header.length; at += 4) {
    all.push_back(link::get_u32(packet.payload + at));
  }
  return all;
}

Mesh to_mesh(cv::Size size, const std::vector<std::uint32_t>& nodes) {
  Mesh mesh;
  mesh.size = size;
  mesh.nodes.create(Mesh::node_count(size));
  std::size_t at = 0;
  for (cv::Vec2s& node : mesh.nodes) {
    const std::uint32_t word = nodes[at++];
    node = {static_cast<std::int16_t>(spec::kMeshDataDx.get(word)),
            static_cast<std::int16_t>(spec::kMeshDataDy.get(word))};
  }
  return mesh;
}

/// Why no request of this type has that many words; 0: it may.
std::uint32_t refusal(PacketType type, std::size_t size) {
  switch (type) {
    case PacketType::kReadRegisters:
      return size >= 1 && size <= link::kMaxReads ? 0 : kRefusedLength;
    case PacketType::kWriteRegisters:
      return size >= 2 && size % 2 == 0 && size <= 2 * link::kMaxWrites ? 0 : kRefusedLength;
    case PacketType::kWriteMesh:
      return size >= 2 && size <= link::kMaxNodes + 1 ? 0 : kRefusedLength;
    default:
      return kRefusedType;
  }
}

}  // namespace

SoftwareBoard::Options::Options() = default;

SoftwareBoard::SoftwareBoard(const Options& options) : options_(options) { reset(); }

void SoftwareBoard::reset() {
  for (const spec::Register& r : spec::register_table()) {
    registers_[r.address] = r.reset.value_or(0);
  }
  registers_[spec::kRegBuild] = options_.build.build_register();
  registers_[spec::kRegBuildLineRows] = static_cast<std::uint32_t>(options_.build.line_rows);
  registers_[spec::kRegBuildMeshNodes] = static_cast<std::uint32_t>(options_.build.mesh_nodes);
  registers_[spec::kRegBuildStreams] = options_.streams.bits();
  registers_[spec::kRegBuildClock] = options_.clock_hz;
  for (const auto& [address, value] : options_.wrong) registers_[address] = value;
  for (auto& mesh : mesh_) mesh.assign(static_cast<std::size_t>(options_.build.mesh_nodes), 0);
  active_mesh_ = mesh_;
  mesh_written_ = heard_ = false;
  time_us_ = last_byte_ = last_heard_ = next_heartbeat_ = kFirstTime;
  sequence_ = kLinkFirstSequence;
  next_frame_ = ~std::uint64_t{0} << 32 | kLinkFirstFrame;
  pairs_ = sent_pairs_ = 0;
  decoder_.reset();
  input_.reset(pairs_in_);
  pairs_in_.clear();
  waiting_.clear();
  taken_ = 0;
  made_.clear();
  rectification_ = {};
}

std::uint32_t SoftwareBoard::peek(std::uint32_t address) const {
  return registers_[address % registers_.size()];
}

void SoftwareBoard::hold_frame(bool held) {
  frame_held_ = held;
  if (!held && spec::kStatusPending.get(registers_[spec::kRegStatus]) != 0) apply();
}

bool SoftwareBoard::host_alive() const {
  return heard_ && time_us_ - last_heard_ < std::uint64_t{1000} * kHostTimeoutMs;
}

void SoftwareBoard::run(std::chrono::microseconds time) {
  time_us_ += static_cast<std::uint64_t>(time.count());
  if (time_us_ - last_byte_ > kSilence) {
    last_byte_ = time_us_;
    decoder_.discard_partial_packet();
    receive(nullptr, 0);
  }
  if (!host_alive() || static_cast<std::int64_t>(time_us_ - next_heartbeat_) < 0) return;
  next_heartbeat_ = time_us_ + std::uint64_t{1000} * kHeartbeatMs;
  answer({}, PacketType::kHeartbeat, {});
}

std::size_t SoftwareBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const link::DecoderCounters before = decoder_.counters();
  if (size > 0) last_byte_ = time_us_;
  decoder_.push(bytes, size);
  while (const auto packet = decoder_.next()) take(*packet);
  const link::DecoderCounters& after = decoder_.counters();
  registers_[spec::kRegBadPackets] += static_cast<std::uint32_t>(
      after.bad_headers + after.bad_payloads - before.bad_headers - before.bad_payloads);
  registers_[spec::kRegLostPackets] +=
      static_cast<std::uint32_t>(after.lost_packets - before.lost_packets);
  return size;
}

std::size_t SoftwareBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  const std::size_t n = std::min(size, waiting_.size() - taken_);
  std::copy_n(waiting_.begin() + static_cast<std::ptrdiff_t>(taken_), n, bytes);
  taken_ += n;
  if (taken_ == waiting_.size()) {
    waiting_.clear();
    taken_ = 0;
  } else if (taken_ > options_.most_waiting) {
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(taken_));
    taken_ = 0;
  }
  return n;
}

// Requests.

void SoftwareBoard::take(const Packet& packet) {
  heard_ = true;
  last_heard_ = time_us_;
  if (packet.header.version != options_.version) return refuse(packet.header, kRefusedVersion);
  switch (packet.header.type) {
    case PacketType::kLeader:
    case PacketType::kRows:
    case PacketType::kTrailer:
      return take_input(packet);
    default:
      break;
  }
  const std::vector<std::uint32_t> all = words(packet);
  if (const std::uint32_t why = refusal(packet.header.type, all.size()); why != 0) {
    return refuse(packet.header, why);
  }
  if (packet.header.type == PacketType::kReadRegisters) {
    std::vector<std::uint8_t> payload(8 * all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool hidden = all[i] == spec::kRegControl || all[i] == spec::kRegMeshData;
      link::put_u32(&payload[8 * i], all[i]);
      link::put_u32(&payload[8 * i + 4],
                    all[i] >= registers_.size() || hidden ? 0 : registers_[all[i]]);
    }
    return answer(packet.header, PacketType::kRegisters, payload);
  }
  if (packet.header.type == PacketType::kWriteRegisters) {
    for (std::size_t i = 0; i < all.size(); i += 2) write(all[i], all[i + 1]);
  } else {
    write(spec::kRegMeshAddress, all[0]);
    for (std::size_t i = 1; i < all.size(); ++i) write(spec::kRegMeshData, all[i]);
  }
  answer(packet.header, PacketType::kWritten, {});
}

void SoftwareBoard::answer(const Header& request, PacketType type,
                           const std::vector<std::uint8_t>& payload) {
  Header header;
  header.version = options_.version;
  header.type = type;
  header.index = request.index;
  header.sequence = sequence_++;
  header.timestamp = time_us_;
  link::append_packet(header, payload.data(), payload.size(), waiting_);
}

void SoftwareBoard::refuse(const Header& request, std::uint32_t why) {
  std::vector<std::uint8_t> payload(4);
  link::put_u32(payload.data(), why);
  answer(request, PacketType::kRefused, payload);
}

void SoftwareBoard::write(std::uint32_t address, std::uint32_t value) {
  if (address >= registers_.size() || options_.wrong.count(address) != 0) return;
  std::uint32_t& held = registers_[address];
  const bool in_shadow =
      (address >= spec::kConfigurationBegin && address < spec::kConfigurationEnd) ||
      address == spec::kRegMeshData;
  if (in_shadow) registers_[spec::kRegStatus] = 0;  // an apply that waits is withdrawn
  if (address == spec::kRegMeshData) {
    const std::uint32_t at = registers_[spec::kRegMeshAddress];
    auto& mesh = mesh_[spec::kMeshAddressCamera.get(at)];
    const std::uint32_t node = spec::kMeshAddressNode.get(at);
    if (node < mesh.size()) {
      mesh[node] = value;
      mesh_written_ = true;
    }
    registers_[spec::kRegMeshAddress] =
        (at & ~spec::kMeshAddressNode.mask()) | spec::kMeshAddressNode.put(node + 1);
    if (options_.wrong.count(spec::kRegMeshSignature) != 0) return;
    Signature signature(registers_[spec::kRegMeshSignature]);
    signature.add(value);
    registers_[spec::kRegMeshSignature] = signature.value();
    return;
  }
  if (address == spec::kRegControl) {
    if (spec::kControlClear.get(value) != 0) {
      for (std::uint32_t r = spec::kRegFramesIn; r <= spec::kRegMeshSwaps; ++r) registers_[r] = 0;
      for (const std::uint32_t r : {spec::kRegErrors, spec::kRegFramesDropped, spec::kRegBadPackets,
                                    spec::kRegLostPackets, spec::kRegInputErrors}) {
        registers_[r] = 0;
      }
    }
    if (spec::kControlApply.get(value) == 0) return;
    registers_[spec::kRegStatus] = spec::kStatusPending.put(1);
    if (!frame_held_) apply();
    return;
  }
  if (address == spec::kRegErrors) {
    held &= ~value;
    return;
  }
  for (const spec::Register& r : spec::register_table()) {
    if (r.address != address || r.access != spec::Access::kReadWrite) continue;
    std::uint32_t mask = r.fields.empty() ? ~0U : 0;
    for (const spec::FieldInfo& f : r.fields) mask |= f.field.mask();
    // As the RTL: a build does not hold bits of streams that it lacks.
    if (address == spec::kRegStreams) mask &= options_.streams.bits();
    held = value & mask;
    if (address == spec::kRegMeshAddress && options_.wrong.count(spec::kRegMeshSignature) == 0) {
      registers_[spec::kRegMeshSignature] = kSignatureStart;
    }
  }
}

void SoftwareBoard::apply() {
  registers_[spec::kRegStatus] = 0;
  const auto field = [this](std::uint32_t address, spec::Field f) {
    return static_cast<int>(f.get(registers_[address]));
  };
  const cv::Size size(field(spec::kRegWidth, spec::kWidthPixels),
                      field(spec::kRegHeight, spec::kHeightRows));
  const GatewareBuild& build = options_.build;
  if (size.width < build.min_width() || size.width > build.max_width || size.height < 1 ||
      size.height > kGatewareMaxHeight ||
      field(spec::kRegReadStart, spec::kReadStartPixels) >= size.width ||
      field(spec::kRegReadStart, spec::kReadStartRows) >= build.line_rows) {
    registers_[spec::kRegErrors] |= spec::kErrorsConfig.mask();
    return;
  }
  parameters_ = parameters_of(build);
  for (const spec::Register& r : spec::register_table()) {
    set_parameters(parameters_, r.address, registers_[r.address]);
  }

  if (mesh_written_) {
    std::swap(mesh_, active_mesh_);
    mesh_written_ = false;
    ++registers_[spec::kRegMeshSwaps];
  }
  rectification_.geometry.image_size = size;
  rectification_.left.mesh = to_mesh(size, active_mesh_[0]);
  rectification_.right.mesh = to_mesh(size, active_mesh_[1]);
  rectification_.left.line_buffer = line_buffer_need(rectification_.left.mesh, size);
  rectification_.right.line_buffer = line_buffer_need(rectification_.right.mesh, size);
  frame_flags_ = line_rows(rectification_) > build.line_rows ? kFrameBufferError : 0;
  made_.clear();
  ++registers_[spec::kRegConfiguration];
}

// Frames.

void SoftwareBoard::take_input(const Packet& packet) {
  if (packet.header.stream != Stream::kInput) return refuse(packet.header, kRefusedType);
  input_.add(packet, pairs_in_);
  for (link::AssembledFrame& in : pairs_in_) {
    if (in.verdict != link::FrameVerdict::kGood) {
      ++registers_[spec::kRegInputErrors];
      continue;
    }
    if (spec::kInputHost.get(registers_[spec::kRegInput]) == 0) continue;
    const int width = in.image.cols / 2;
    const GreyPair pair{in.image.colRange(0, width).clone(),
                        in.image.colRange(width, 2 * width).clone()};
    frame(pair, in.frame_id, in.timestamp, 0);
  }
  pairs_in_.clear();
}

void SoftwareBoard::feed(const GreyPair& pair) {
  const std::uint64_t id = next_frame_++;
  if (spec::kInputHost.get(registers_[spec::kRegInput]) != 0) return;
  frame(pair, id, time_us_ - spec::kMidExposureUs.get(registers_[spec::kRegMidExposure]), 0);
}

void SoftwareBoard::frame(const GreyPair& pair, std::uint64_t frame_id, std::uint64_t timestamp,
                          std::uint32_t flags) {
  ++registers_[spec::kRegFramesIn];
  ++registers_[spec::kRegFramesOut];
  const cv::Size size = rectification_.geometry.image_size;
  if (pair.left.size() != size || pair.right.size() != size) {
    const bool cut = pair.left.total() < static_cast<std::size_t>(size.area());
    ++registers_[cut ? spec::kRegCutFrames : spec::kRegLongFrames];
    registers_[spec::kRegErrors] |=
        cut ? spec::kErrorsCutFrame.mask() : spec::kErrorsLongFrame.mask();
    return;
  }
  if (frame_flags_ != 0) {
    ++registers_[spec::kRegBufferErrors];
    registers_[spec::kRegErrors] |= spec::kErrorsBufferLeft.mask();
  }
  if (!host_alive()) return;
  const auto interval = [this](spec::Field f) {
    return std::max(1U, f.get(registers_[spec::kRegFrameInterval]));
  };
  if (pairs_++ % interval(spec::kFrameIntervalPairs) != 0) return;
  const bool raw = sent_pairs_++ % interval(spec::kFrameIntervalRaw) == 0;
  const auto streams = link::StreamSet::from_bits(registers_[spec::kRegStreams]);
  const auto wanted = [&](Stream s) { return streams.contains(s); };
  if (raw && wanted(Stream::kRawLeft))
    send(Stream::kRawLeft, pair.left, frame_id, timestamp, flags);
  if (raw && wanted(Stream::kRawRight)) {
    send(Stream::kRawRight, pair.right, frame_id, timestamp, flags);
  }
  constexpr link::StreamSet kMade{Stream::kDisparity, Stream::kRectifiedLeft,
                                  Stream::kRectifiedRight};
  if (!streams.contains_any(kMade)) return;
  const Made& made = make(pair);
  flags |= frame_flags_;
  if (wanted(Stream::kRectifiedLeft)) {
    send(Stream::kRectifiedLeft, made.left, frame_id, timestamp, flags);
  }
  if (wanted(Stream::kRectifiedRight)) {
    send(Stream::kRectifiedRight, made.right, frame_id, timestamp, flags);
  }
  if (wanted(Stream::kDisparity)) {
    send(Stream::kDisparity, made.disparity, frame_id, timestamp, flags);
  }
}

const SoftwareBoard::Made& SoftwareBoard::make(const GreyPair& pair) {
  for (const Made& made : made_) {
    if (made.raw.left.data == pair.left.data && made.raw.right.data == pair.right.data) return made;
  }
  const DisparityFrame& frame =
      pipeline_.process(pair.left, pair.right, rectification_, parameters_, options_.num_threads);
  while (!made_.empty() && made_.size() >= std::max<std::size_t>(options_.kept_pairs, 1)) {
    made_.pop_front();
  }
  made_.push_back({pair, frame.left.clone(), frame.right.clone(), frame.disparity.clone()});
  for (int i = 0; i < options_.wrong_pixels; ++i) made_.back().disparity(0, i) ^= 1;
  return made_.back();
}

void SoftwareBoard::send(Stream stream, const cv::Mat& image, std::uint64_t frame_id,
                         std::uint64_t timestamp, std::uint32_t flags) {
  if (waiting_.size() - taken_ > options_.most_waiting) {
    ++registers_[spec::kRegFramesDropped];
    return;
  }
  Header header;
  header.version = options_.version;
  header.stream = stream;
  header.frame_id = frame_id;
  header.timestamp = timestamp;
  link::append_frame(header, image, registers_[spec::kRegConfiguration], flags, options_.payload,
                     sequence_, waiting_);
}

}  // namespace fpga_stereo::sim
