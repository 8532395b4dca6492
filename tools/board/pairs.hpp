// Pairs that the host sends to a board in place of its cameras.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "board/connection.hpp"

namespace fpga_stereo::tools {

/// Creates a textured pair. The disparity changes every 8 rows; noise makes some matches ambiguous.
void make_pair(cv::Size size, unsigned seed, int disparities, cv::Mat1b& left, cv::Mat1b& right);

/// Throws std::runtime_error unless the board takes pairs from the host and sends disparities.
void require_host_pairs(const link::Identity& identity);

class PairSender {
 public:
  /// A frame set is complete if it has these streams.
  PairSender(Connection& board, link::StreamSet streams) : board_(board), streams_(streams) {}

  /// Sends a pair to a board whose configuration has this tag, again if the link loses it. Returns
  /// its complete frame set.
  link::FrameSet send(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t tag);
  /// Returns how many pairs the link lost.
  int num_lost() const { return num_lost_; }

 private:
  Connection& board_;
  const link::StreamSet streams_;
  std::uint64_t frame_ = 0;
  int num_lost_ = 0;
};

}  // namespace fpga_stereo::tools
