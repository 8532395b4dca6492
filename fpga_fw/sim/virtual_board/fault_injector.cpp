#include "sim/virtual_board/fault_injector.hpp"

#include <algorithm>
#include <cmath>

#include "link/packet.hpp"

namespace fpga_stereo::sim {
namespace {

constexpr std::array<const char*, kNumLineFaults> kNames{
    "flip", "drop", "insert", "double", "lose", "repeat", "swap", "truncate", "garbage"};
constexpr auto kFirstOfPackets = static_cast<std::size_t>(LineFault::kLose);
constexpr double kRateBytes = 1 << 20;
constexpr double kExtraBytes = 4096;  // between two faults of inject()
constexpr std::size_t kMostGarbage = 600;

}  // namespace

const char* name(LineFault fault) { return kNames[static_cast<std::size_t>(fault)]; }

std::optional<LineFault> line_fault(const std::string& name) {
  const auto* found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<LineFault>(found - kNames.begin());
}

FaultInjector::FaultInjector(const Rates& rates, std::uint64_t seed) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    sources_[i].rate = rates[i];
    // Each kind has numbers of its own: one more kind does not move the others.
    sources_[i].random.seed(seed * kNumLineFaults + i);
    schedule(sources_[i]);
  }
}

void FaultInjector::schedule(Source& source) {
  double per_byte = source.rate / kRateBytes;
  if (source.extra > 0) per_byte += 1 / kExtraBytes;
  source.scheduled = per_byte > 0;
  if (!source.scheduled) return;
  const double uniform = std::generate_canonical<double, 53>(source.random);
  source.left = static_cast<std::int64_t>(-std::log1p(-uniform) / per_byte);
}

void FaultInjector::strike(LineFault fault) {
  ++counts_[static_cast<std::size_t>(fault)];
  Source& hit = source(fault);
  if (hit.extra > 0) --hit.extra;
  schedule(hit);
}

void FaultInjector::inject(LineFault fault, int count) {
  Source& chosen = source(fault);
  chosen.extra += count;
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

bool FaultInjector::packets_at_risk() const {
  return std::any_of(sources_.begin() + kFirstOfPackets, sources_.end(),
                     [](const Source& source) { return source.scheduled; });
}

void FaultInjector::push(const std::uint8_t* bytes, std::size_t size,
                         std::vector<std::uint8_t>& out) {
  if (!waiting() && !packets_at_risk()) return pass(bytes, size, out);
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
    packet(&held_[at], size, out);
    at += size;
  }
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Whether a fault falls into the next `size` bytes, which have passed then.
bool FaultInjector::strikes_packet(LineFault fault, std::size_t size) {
  Source& chosen = source(fault);
  if (!chosen.scheduled) return false;
  chosen.left -= static_cast<std::int64_t>(size);
  if (chosen.left >= 0) return false;
  strike(fault);
  return true;
}

void FaultInjector::packet(const std::uint8_t* bytes, std::size_t size,
                           std::vector<std::uint8_t>& out) {
  std::vector<std::uint8_t> sent;
  if (strikes_packet(LineFault::kGarbage, size)) {
    auto& random = source(LineFault::kGarbage).random;
    sent.resize(1 + random() % kMostGarbage);
    for (auto& byte : sent) byte = static_cast<std::uint8_t>(random());
  }
  std::size_t kept = size;
  if (strikes_packet(LineFault::kTruncate, size)) {
    kept = 1 + source(LineFault::kTruncate).random() % (size - 1);
  }
  int copies = strikes_packet(LineFault::kRepeat, size) ? 2 : 1;
  if (strikes_packet(LineFault::kLose, size)) copies = 0;
  for (; copies > 0; --copies) sent.insert(sent.end(), bytes, bytes + kept);

  // One that waits already has found its next; another does not wait behind it.
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
    // Up to the nearest fault, then that byte.
    std::size_t next = 0;
    auto run = static_cast<std::int64_t>(size - at);
    bool struck = false;
    for (std::size_t i = 0; i < kFirstOfPackets; ++i) {
      if (!sources_[i].scheduled || sources_[i].left >= run) continue;
      run = sources_[i].left;
      next = i;
      struck = true;
    }
    out.insert(out.end(), bytes + at, bytes + at + run);
    at += static_cast<std::size_t>(run);
    const std::int64_t passed = struck ? run + 1 : run;
    for (std::size_t i = 0; i < kFirstOfPackets; ++i) {
      // Two at one byte: the second one at the next.
      sources_[i].left = std::max<std::int64_t>(sources_[i].left - passed, 0);
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
      break;  // lost
  }
  strike(fault);
}

}  // namespace fpga_stereo::sim
