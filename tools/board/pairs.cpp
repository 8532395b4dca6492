#include "board/pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "board/streams.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr double kMinLinkSpeed = 100e3;  // bytes/s
constexpr double kRetryTime = 15;        // s: for pairs that the link loses

bool is_complete(const link::FrameSet& set, link::StreamSet streams) {
  return std::all_of(kStreamNames.begin(), kStreamNames.end(), [&](const StreamName& each) {
    return !streams.contains(each.stream) || !set.image(each.stream).empty();
  });
}

}  // namespace

void make_pair(cv::Size size, unsigned seed, int disparities, cv::Mat1b& left, cv::Mat1b& right) {
  cv::RNG random(seed * 7919 + 1);
  right.create(size);
  random.fill(right, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(right, right, {0, 0}, 0.8);
  left.create(size);
  for (int y = 0; y < size.height; ++y) {
    const int moved = y / 8 * 3 % std::max(disparities - 1, 1);
    for (int x = 0; x < size.width; ++x) {
      const int noise = random.uniform(0, 16) == 0 ? random.uniform(0, 64) : 0;
      left(y, x) = cv::saturate_cast<std::uint8_t>(right(y, std::max(x - moved, 0)) + noise);
    }
  }
}

void require_host_pairs(const link::Identity& identity) {
  if (identity.supports(link::Stream::kInput) && identity.supports(link::Stream::kDisparity))
    return;
  throw std::runtime_error(
      "this board accepts no pairs from the host or sends no disparity: see the streams that board "
      "probe prints");
}

link::FrameSet PairSender::send(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t tag) {
  const double time = std::max(1.0, static_cast<double>(left.total()) * 6 / kMinLinkSpeed);
  const auto begin = std::chrono::steady_clock::now();
  const auto spent = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  for (; spent() < time + kRetryTime; ++num_lost_) {
    const std::uint64_t id = ++frame_;
    const bool sent = board_.wait_until(board_.patience(), [&](const Connection::Snapshot&) {
      return board_.device().send_pair(left, right, id, id);
    });
    if (!sent) {
      throw std::runtime_error("the board does not accept pairs: " +
                               board_.snapshot().trouble_text);
    }
    std::optional<link::FrameSet> found;
    board_.wait_until(time, [&](const Connection::Snapshot&) {
      for (auto& arrived : board_.take(std::chrono::milliseconds(20))) {
        const auto& frames = arrived.frames;
        if (frames.tag == tag && frames.set.frame_id == id) found = frames.set;
      }
      return found.has_value();
    });
    if (found && is_complete(*found, streams_)) return *found;
  }
  throw std::runtime_error(
      fmt::format("no complete frame set came within {:g} s: check the link with board measure",
                  time + kRetryTime));
}

}  // namespace fpga_stereo::tools
