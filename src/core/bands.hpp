// Work on bands of rows, in parallel, by the threads of OpenCV's pool, which persist.
#pragma once

#include <functional>
#include <opencv2/core.hpp>

namespace fpga_stereo {

/// Calls work(band, rows) for `bands` bands of the rows 0 .. height - 1, at most one per row.
void for_each_band(int height, int bands, const std::function<void(int, cv::Range)>& work);

}  // namespace fpga_stereo
