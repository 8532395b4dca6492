// Runs work on bands of image rows in parallel, by the persistent threads of OpenCV's pool.
#pragma once

#include <functional>
#include <opencv2/core.hpp>

namespace fpga_stereo {

/// Divides the rows 0 .. height - 1 into `bands` bands, or one per row if there are fewer rows, and
/// calls work(band, rows) for each. Returns when all are done. Calls run in parallel.
void for_each_band(int height, int bands, const std::function<void(int, cv::Range)>& work);

}  // namespace fpga_stereo
