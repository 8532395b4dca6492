// What the tests of SIMD stages share.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/simd/stages.hpp"
#include "fpga_stereo/core/target.hpp"

namespace fpga_stereo::test {

inline std::vector<std::string> simd_targets() {
  std::vector<std::string> names = targets();
  names.pop_back();  // scalar
  return names;
}

/// Runs a test with the instructions of one target.
class SimdStages : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(choose_target(GetParam())); }
  void TearDown() override { ASSERT_TRUE(choose_target(targets().front())); }
};

inline simd::CensusPlanes simd_census(const cv::Mat1b& image, const Parameters& p) {
  simd::CensusImage input;
  input.create(image.size());
  image.copyTo(input.image);
  simd::CensusPlanes bits;
  bits.create(image.size(), p);
  simd::census(input, p, {0, image.rows}, bits);
  return bits;
}

inline std::string target_name(const ::testing::TestParamInfo<std::string>& info) {
  return info.param;
}

}  // namespace fpga_stereo::test
