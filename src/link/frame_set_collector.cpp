#include "link/frame_set_collector.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::link {

FrameSetCollector::Entry& FrameSetCollector::entry(std::uint64_t frame_id) {
  // frame_id may wrap: up to half of its range ahead is later.
  const auto later = [frame_id](const Entry& e) {
    return static_cast<std::int64_t>(e.set.frame_id - frame_id) >= 0;
  };
  auto at = std::find_if(entries_.begin(), entries_.end(), later);
  if (at == entries_.end() || at->set.frame_id != frame_id) {
    at = entries_.emplace(at);
    at->set.frame_id = frame_id;
  }
  return *at;
}

void FrameSetCollector::begin(Stream stream, std::uint64_t frame_id, std::vector<FrameSet>& out) {
  entry(frame_id).begun.insert(stream);
  while (entries_.size() > kMaxInFlight) move_first(out);
}

void FrameSetCollector::add(AssembledFrame&& frame, StreamSet expected,
                            std::vector<FrameSet>& out) {
  Entry& e = entry(frame.frame_id);
  e.ended.insert(frame.stream);
  e.set.timestamp = frame.timestamp;
  e.set.configuration = frame.configuration;
  if (frame.verdict != FrameVerdict::kGood) {
    e.set.dropped.push_back(frame.text());
    e.set.verdicts.push_back(frame.verdict);
  }
  const auto misfits = [&](const cv::Mat& i) {
    return !i.empty() && i.size() != frame.image.size();
  };
  if (!frame.is_dropped() && std::any_of(e.set.images.begin(), e.set.images.end(), misfits)) {
    // No compatible board does this, but users rely on equal sizes.
    frame.image.release();
    e.set.dropped.push_back(std::string(name(frame.stream)) + " frame " +
                            std::to_string(frame.frame_id) +
                            " dropped: another image of its pair has another size");
    e.set.verdicts.push_back(FrameVerdict::kBadSignature);
  }
  if (!frame.is_dropped())
    e.set.images[static_cast<std::size_t>(frame.stream)] = std::move(frame.image);

  // Raw images accompany some pairs only: a set waits for them if they have begun.
  constexpr StreamSet kOptional{Stream::kRawLeft, Stream::kRawRight};
  while (!entries_.empty()) {
    const Entry& first = entries_.front();
    const StreamSet required = expected - kOptional;
    const StreamSet wanted = (required.empty() ? expected : required) | first.begun;
    if (!first.ended.contains_all(wanted) && entries_.size() <= kMaxInFlight) break;
    move_first(out);
  }
}

void FrameSetCollector::move_first(std::vector<FrameSet>& out) {
  Entry& first = entries_.front();
  if (!first.ended.empty()) out.push_back(std::move(first.set));
  entries_.pop_front();
}

void FrameSetCollector::reset(std::vector<FrameSet>& out) {
  while (!entries_.empty()) move_first(out);
}

}  // namespace fpga_stereo::link
