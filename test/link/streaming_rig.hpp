// A rig whose cameras see two pairs, and the disparities expected for every setting.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "link/session_rig.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {

constexpr link::StreamSet kDisparity = link::Stream::kDisparity;
constexpr link::StreamSet kAll{link::Stream::kDisparity, link::Stream::kRectifiedLeft,
                               link::Stream::kRectifiedRight, link::Stream::kRawLeft,
                               link::Stream::kRawRight};

/// A session rig that checks the frames it receives.
class Streaming : public SessionRig {
 public:
  explicit Streaming(const sim::SoftwareBoard::Options& options = small_board())
      : SessionRig(options) {
    pairs = {pair(1), pair(2)};
  }

  void want(unsigned seed, link::StreamSet streams = kDisparity) {
    session.set_desired_state(wanted(setting(seed), seed, streams));
  }
  bool streaming() const { return session.state() == link::LinkState::kStreaming; }

  /// Checks that every disparity equals what the setting of its tag computes from one of the pairs.
  void expect_true_frames() {
    for (const link::ReceivedFrames& r : received) {
      const cv::Mat& disparity = r.set.image(link::Stream::kDisparity);
      if (disparity.empty()) continue;
      const auto& known = known_disparities(static_cast<unsigned>(r.tag));
      const bool found = std::any_of(known.begin(), known.end(), [&](const cv::Mat1w& k) {
        return static_cast<bool>(same("disparity", k, disparity));
      });
      ASSERT_TRUE(found) << "frame " << r.set.frame_id << ", tag " << r.tag;
    }
  }
  std::size_t good() const {
    return static_cast<std::size_t>(
        std::count_if(received.begin(), received.end(), [](const link::ReceivedFrames& r) {
          return !r.set.image(link::Stream::kDisparity).empty();
        }));
  }
  bool noted(const std::string& text) const {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
      return note.find(text) != std::string::npos;
    });
  }

 private:
  const std::vector<cv::Mat1w>& known_disparities(unsigned seed) {
    std::vector<cv::Mat1w>& known = known_[seed];
    if (known.empty()) {
      for (const sim::GreyPair& p : pairs) known.push_back(expected(p, setting(seed)));
    }
    return known;
  }
  std::map<unsigned, std::vector<cv::Mat1w>> known_;
};

}  // namespace fpga_stereo::test
