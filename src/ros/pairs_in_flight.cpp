#include "ros/pairs_in_flight.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace fpga_stereo {

void PairsInFlight::add(const SourcePair& pair, Clock::time_point now) {
  pairs_[next_id_++] = {pair, now};
}

std::optional<PairsInFlight::Returned> PairsInFlight::take(std::uint64_t frame_id,
                                                           Clock::time_point now) {
  const auto found = pairs_.find(frame_id);
  if (found == pairs_.end()) return std::nullopt;
  last_return_ = now;
  turnaround_ = now - found->second.when;
  Returned returned{std::move(found->second.pair),
                    static_cast<std::uint64_t>(std::distance(pairs_.begin(), found))};
  pairs_.erase(pairs_.begin(), std::next(found));
  return returned;
}

std::uint64_t PairsInFlight::give_up_late(Clock::time_point now) {
  if (pairs_.empty()) return 0;
  const auto patience = kMinPatience + static_cast<int>(kMaxPairs) * turnaround_;
  if (now - std::max(last_return_, pairs_.begin()->second.when) < patience) return 0;
  const std::uint64_t lost = pairs_.size();
  pairs_.clear();
  return lost;
}

std::vector<SourcePair> PairsInFlight::take_all() {
  std::vector<SourcePair> all;
  for (auto& [id, sent] : pairs_) all.push_back(std::move(sent.pair));
  pairs_.clear();
  return all;
}

}  // namespace fpga_stereo
