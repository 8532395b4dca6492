#include "evaluate_raw/raw_pairs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "support/files.hpp"

namespace fpga_stereo::tools {

namespace fs = std::filesystem;

RawPairs read_raw_pairs(const std::string& folder) {
  RawPairs pairs;
  if (fs::exists(folder + "/cam0")) {
    EurocFolder euroc = read_euroc_folder(folder, "evaluate_raw");
    pairs.calibration = euroc.calibration;
    pairs.frames = std::move(euroc.frames);
    return pairs;
  }
  if (!fs::exists(folder + "/intrinsics.yml")) {
    throw std::runtime_error(fmt::format(
        "{}: contains neither cam0 (a sequence of EuRoC) nor intrinsics.yml (chessboards)",
        folder));
  }
  pairs.is_chessboard = true;
  const auto left = list_images("DIR", {folder + "/left*"});
  const auto right = list_images("DIR", {folder + "/right*"});
  if (left.size() != right.size()) {
    throw std::runtime_error(
        fmt::format("{}: contains {} left and {} right images: the numbers must be equal", folder,
                    left.size(), right.size()));
  }
  pairs.calibration = read_opencv_calibration(folder, read_grey(left[0]).size());
  for (std::size_t i = 0; i < left.size(); ++i) pairs.frames.push_back({0, left[i], right[i]});
  return pairs;
}

}  // namespace fpga_stereo::tools
