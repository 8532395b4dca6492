#include "fpga_stereo/link/frame_sets.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::link {

FrameSets::Entry& FrameSets::entry(std::uint64_t frame_id) {
  // The numbers may wrap: what is less than half of them behind is later.
  const auto later = [frame_id](const Entry& e) {
    return static_cast<std::int64_t>(e.set.frame_id - frame_id) >= 0;
  };
  auto at = std::find_if(entries_.begin(), entries_.end(), later);
  if (at == entries_.end() || at->set.frame_id != frame_id) {
    at = entries_.insert(at, Entry{});
    at->set.frame_id = frame_id;
  }
  return *at;
}

void FrameSets::begun(Stream stream, std::uint64_t frame_id) {
  entry(frame_id).begun |= 1U << static_cast<unsigned>(stream);
}

void FrameSets::ended(Assembled&& frame, unsigned streams, std::vector<FrameSet>& out) {
  const auto stream = static_cast<unsigned>(frame.stream);
  Entry& e = entry(frame.frame_id);
  e.ended |= 1U << stream;
  e.set.timestamp = frame.timestamp;
  e.set.configuration = frame.configuration;
  if (frame.verdict != Assembled::Verdict::kGood) {
    e.set.dropped.push_back(frame.text());
    e.set.verdicts.push_back(frame.verdict);
  }
  const auto misfits = [&](const cv::Mat& i) {
    return !i.empty() && i.size() != frame.image.size();
  };
  if (!frame.dropped() && std::any_of(e.set.images.begin(), e.set.images.end(), misfits)) {
    // No board of ours: what is made of a set relies on it.
    frame.image.release();
    e.set.dropped.push_back(std::string(name(frame.stream)) + " frame " +
                            std::to_string(frame.frame_id) +
                            " dropped: another image of its pair has another size");
    e.set.verdicts.push_back(Assembled::Verdict::kBadSignature);
  }
  if (!frame.dropped()) e.set.images[stream] = std::move(frame.image);

  // Raw images come of some pairs only: they are waited for where they have begun.
  constexpr unsigned kSometimes = 1U << static_cast<unsigned>(Stream::kRawLeft) |
                                  1U << static_cast<unsigned>(Stream::kRawRight);
  std::size_t complete = 0;
  while (complete < entries_.size()) {
    const Entry& first = entries_[complete];
    const unsigned always = streams & ~kSometimes;
    const unsigned wanted = (always != 0 ? always : streams) | first.begun;
    if ((wanted & ~first.ended) != 0 && entries_.size() - complete <= kUnderWay) break;
    ++complete;
  }
  give(complete, out);
}

void FrameSets::give(std::size_t count, std::vector<FrameSet>& out) {
  for (std::size_t i = 0; i < count; ++i) out.push_back(std::move(entries_[i].set));
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(count));
}

void FrameSets::reset(std::vector<FrameSet>& out) { give(entries_.size(), out); }

}  // namespace fpga_stereo::link
