#include "virtual_board/cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "support/files.hpp"

namespace fpga_stereo::tools {

void append_pair(std::vector<sim::GreyPair>& pairs, const cv::Mat1b& left, const cv::Mat1b& right,
                 const std::string& name) {
  const cv::Size size = pairs.empty() ? left.size() : pairs[0].left.size();
  if (left.size() != size || right.size() != size) {
    throw std::runtime_error(
        fmt::format("{}: left is {}x{} and right is {}x{}, expected {}x{}: all "
                    "images must have equal size",
                    name, left.cols, left.rows, right.cols, right.rows, size.width, size.height));
  }
  pairs.push_back({left, right});
}

std::vector<sim::GreyPair> read_image_pair(const std::string& left, const std::string& right) {
  std::vector<sim::GreyPair> pairs;
  append_pair(pairs, read_grey(left), read_grey(right), left + ", " + right);
  return pairs;
}

std::vector<sim::GreyPair> read_folder(const std::string& folder, std::size_t max_pairs) {
  const auto left = list_images("--folder", {folder + "/left"});
  const auto right = list_images("--folder", {folder + "/right"});
  if (left.size() != right.size()) {
    throw std::runtime_error(
        fmt::format("{} has {} left and {} right images: the numbers must be "
                    "equal",
                    folder, left.size(), right.size()));
  }
  std::vector<sim::GreyPair> pairs;
  for (std::size_t i = 0; i < std::min(max_pairs, left.size()); ++i) {
    append_pair(pairs, read_grey(left[i]), read_grey(right[i]), left[i]);
  }
  return pairs;
}

}  // namespace fpga_stereo::tools
