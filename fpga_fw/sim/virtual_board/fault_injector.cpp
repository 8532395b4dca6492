#include "sim/virtual_board/fault_injector.hpp"

#include <algorithm>
#include <cmath>

#include "link/packet.hpp"

namespace fpga_stereo::sim {
namespace {

constexpr std::array<const char*, kNumLineFaults> kNames{
    "flip", "drop", "insert", "double", "lose", "repeat", "swap", "truncate", "garbage"};
constexpr auto kFirstPacketFault = static_cast<std::size_t>(LineFault::kLose);
constexpr double kBytesPerMib = 1 << 20;
constexpr double kInjectionBytes = 4096;  // mean distance of the faults of inject()
constexpr std::size_t kMaxGarbage = 600;

}  // namespace

const char* name(LineFault fault) { return kNames[static_cast<std::size_t>(fault)]; }

std::optional<LineFault> find_line_fault(const std::string& name) {
  const auto* found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<LineFault>(found - kNames.begin());
}

FaultInjector::FaultInjector(const Rates& rates, std::uint64_t seed) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    sources_[i].rate = rates[i];
    // Each fault has its own generator, so that enabling one does not move the others.
    sources_[i].random.seed(seed * kNumLineFaults + i);
    schedule(sources_[i]);
  }
}

void FaultInjector::schedule(Source& source) {
  double per_byte = source.rate / kBytesPerMib;
  if (source.num_injected > 0) per_byte += 1 / kInjectionBytes;
  source.is_scheduled = per_byte > 0;
  if (!source.is_scheduled) return;
  const double uniform = std::generate_canonical<double, 53>(source.random);
  source.bytes_left = static_cast<std::int64_t>(-std::log1p(-uniform) / per_byte);
}

void FaultInjector::strike(LineFault fault) {
  ++counts_[static_cast<std::size_t>(fault)];
  Source& hit = source(fault);
  if (hit.num_injected > 0) --hit.num_injected;
  schedule(hit);
}

void FaultInjector::inject(LineFault fault, int count) {
  Source& chosen = source(fault);
  chosen.num_injected += count;
  schedule(chosen);
}

void FaultInjector::clear() {
  held_.clear();
  swapped_.clear();
}

void FaultInjector::flush(std::vector<std::uint8_t>& out) {
  pass(held_.data(), held_.size(), out);
  pass(swapped_.data(), swapped_.size(), out);
  clear();
}

bool FaultInjector::has_packet_faults() const {
  return std::any_of(sources_.begin() + kFirstPacketFault, sources_.end(),
                     [](const Source& source) { return source.is_scheduled; });
}

void FaultInjector::push(const std::uint8_t* bytes, std::size_t size,
                         std::vector<std::uint8_t>& out) {
  if (!has_pending() && !has_packet_faults()) return pass(bytes, size, out);
  held_.insert(held_.end(), bytes, bytes + size);
  scan(out);
}

void FaultInjector::scan(std::vector<std::uint8_t>& out) {
  std::size_t at = 0;
  const auto first = static_cast<std::uint8_t>(link::kSync);
  while (at < held_.size()) {
    const auto begin = held_.begin() + static_cast<std::ptrdiff_t>(at);
    const auto sync = static_cast<std::size_t>(std::find(begin, held_.end(), first) - begin);
    pass(&held_[at], sync, out);
    at += sync;
    if (held_.size() - at < link::kHeaderBytes) break;
    const auto header = link::unpack(&held_[at]);
    if (!header) {
      pass(&held_[at++], 1, out);
      continue;
    }
    const std::size_t size = link::kHeaderBytes + header->length + link::kCrcBytes;
    if (held_.size() - at < size) break;
    pass_packet(&held_[at], size, out);
    at += size;
  }
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Advances the schedule by `size` bytes. Returns whether the fault strikes among them.
bool FaultInjector::strikes_packet(LineFault fault, std::size_t size) {
  Source& chosen = source(fault);
  if (!chosen.is_scheduled) return false;
  chosen.bytes_left -= static_cast<std::int64_t>(size);
  if (chosen.bytes_left >= 0) return false;
  strike(fault);
  return true;
}

void FaultInjector::pass_packet(const std::uint8_t* bytes, std::size_t size,
                                std::vector<std::uint8_t>& out) {
  std::vector<std::uint8_t> sent;
  if (strikes_packet(LineFault::kGarbage, size)) {
    auto& random = source(LineFault::kGarbage).random;
    sent.resize(1 + random() % kMaxGarbage);
    for (auto& byte : sent) byte = static_cast<std::uint8_t>(random());
  }
  std::size_t kept = size;
  if (strikes_packet(LineFault::kTruncate, size)) {
    kept = 1 + source(LineFault::kTruncate).random() % (size - 1);
  }
  int copies = strikes_packet(LineFault::kRepeat, size) ? 2 : 1;
  if (strikes_packet(LineFault::kLose, size)) copies = 0;
  for (; copies > 0; --copies) sent.insert(sent.end(), bytes, bytes + kept);

  // At most one packet is held back for swapping.
  const bool swap = swapped_.empty() && strikes_packet(LineFault::kSwap, size);
  if (swap) {
    swapped_ = std::move(sent);
    return;
  }
  pass(sent.data(), sent.size(), out);
  pass(swapped_.data(), swapped_.size(), out);
  swapped_.clear();
}

void FaultInjector::pass(const std::uint8_t* bytes, std::size_t size,
                         std::vector<std::uint8_t>& out) {
  for (std::size_t at = 0; at < size;) {
    // Copy the bytes up to the nearest fault, then damage one byte.
    std::size_t next = 0;
    auto run = static_cast<std::int64_t>(size - at);
    bool struck = false;
    for (std::size_t i = 0; i < kFirstPacketFault; ++i) {
      if (!sources_[i].is_scheduled || sources_[i].bytes_left >= run) continue;
      run = sources_[i].bytes_left;
      next = i;
      struck = true;
    }
    out.insert(out.end(), bytes + at, bytes + at + run);
    at += static_cast<std::size_t>(run);
    const std::int64_t passed = struck ? run + 1 : run;
    for (std::size_t i = 0; i < kFirstPacketFault; ++i) {
      // If two faults strike one byte, the second moves to the next byte.
      sources_[i].bytes_left = std::max<std::int64_t>(sources_[i].bytes_left - passed, 0);
    }
    if (struck) damage(static_cast<LineFault>(next), bytes[at++], out);
  }
}

void FaultInjector::damage(LineFault fault, std::uint8_t byte, std::vector<std::uint8_t>& out) {
  auto& random = source(fault).random;
  switch (fault) {
    case LineFault::kFlip:
      out.push_back(static_cast<std::uint8_t>(byte ^ 1U << random() % 8));
      break;
    case LineFault::kInsert:
      out.push_back(static_cast<std::uint8_t>(random()));
      out.push_back(byte);
      break;
    case LineFault::kDouble:
      out.insert(out.end(), 2, byte);
      break;
    default:
      break;  // kDrop
  }
  strike(fault);
}

}  // namespace fpga_stereo::sim
