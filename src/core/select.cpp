#include <algorithm>
#include <cstdlib>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {

void create(Selection& out, cv::Size size) {
  out.winner.create(size);
  out.right_winner.create(size);
  out.winner_sum.create(size);
  out.runner_up_sum.create(size);
  out.around.create(size);
}

void select(const cv::Mat1w& sums, int y, Selection& out) {
  const int width = sums.cols;
  const int range = sums.rows;
  std::uint8_t* winner = out.winner[y];
  std::uint8_t* right_winner = out.right_winner[y];
  std::uint16_t* winner_sum = out.winner_sum[y];
  std::uint16_t* runner_up_sum = out.runner_up_sum[y];

  // Winner-takes-all of the left pixels; "<" keeps the lowest d on a tie.
  std::copy(sums[0], sums[0] + width, winner_sum);
  std::fill(winner, winner + width, std::uint8_t{0});
  for (int d = 1; d < range; ++d) {
    const std::uint16_t* sum = sums[d];
    for (int x = 0; x < width; ++x) {
      const bool better = sum[x] < winner_sum[x];
      winner[x] = better ? static_cast<std::uint8_t>(d) : winner[x];
      winner_sum[x] = better ? sum[x] : winner_sum[x];
    }
  }

  // Right pixel xr is compared with left pixel xr + d, which is a diagonal of the same sums (the
  // paper's Fig. 6). runner_up_sum serves as the running minimum here.
  std::copy(sums[0], sums[0] + width, runner_up_sum);
  std::fill(right_winner, right_winner + width, std::uint8_t{0});
  for (int d = 1; d < std::min(range, width); ++d) {
    const std::uint16_t* sum = sums[d] + d;
    for (int x = 0; x < width - d; ++x) {
      const bool better = sum[x] < runner_up_sum[x];
      right_winner[x] = better ? static_cast<std::uint8_t>(d) : right_winner[x];
      runner_up_sum[x] = better ? sum[x] : runner_up_sum[x];
    }
  }

  // The winner's neighbours are not runners-up: a minimum between two disparities makes both low.
  std::fill(runner_up_sum, runner_up_sum + width, std::uint16_t{0xFFFF});
  for (int d = 0; d < range; ++d) {
    const std::uint16_t* sum = sums[d];
    for (int x = 0; x < width; ++x) {
      const bool is_candidate = std::abs(d - winner[x]) > 1;
      runner_up_sum[x] = is_candidate ? std::min(runner_up_sum[x], sum[x]) : runner_up_sum[x];
    }
  }

  for (int x = 0; x < width; ++x) {
    for (int k = -2; k <= 2; ++k) {
      const int d = winner[x] + k;
      out.around(y, x)[k + 2] = d >= 0 && d < range ? sums(d, x) : 0;
    }
  }
}

}  // namespace fpga_stereo
