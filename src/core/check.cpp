#include <cstdlib>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {

void check(const Selection& s, const Parameters& p, cv::Range rows, cv::Mat1b& kept) {
  kept.create(s.winner.size());
  if (rows == cv::Range::all()) rows = {0, kept.rows};
  const int factor = uniqueness_factor(p);

  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < kept.cols; ++x) {
      bool keep = true;
      if (p.left_right_check) {
        const int d = s.winner(y, x);
        keep = x - d >= 0 && std::abs(s.right_winner(y, x - d) - d) <= p.disp12MaxDiff;
      }
      if (p.uniqueness_check && !p.dense) {
        keep = keep && kUniquenessScale * s.runner_up_sum(y, x) > factor * s.winner_sum(y, x);
      }
      kept(y, x) = keep ? 1 : 0;
    }
  }
}

}  // namespace fpga_stereo
