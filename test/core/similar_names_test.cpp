#include "core/similar_names.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using Names = std::vector<std::string>;

TEST(SimilarNames, FewLettersDiffer) {
  const Names names{"speckle_range", "disparity_range", "min_disparity", "P1"};
  EXPECT_EQ(similar_names("disparty_range", names), (Names{"disparity_range"}));
  EXPECT_EQ(similar_names("Disparity_Range", names), (Names{"disparity_range"}));
  EXPECT_EQ(similar_names("disparity_ran", names), (Names{"disparity_range"}));
  EXPECT_EQ(similar_names("abcdefghi", names), Names{});
}

TEST(SimilarNames, OneContainsTheOther) {
  const Names names{"speckle_range", "disparity_range", "min_disparity", "verify"};
  EXPECT_EQ(similar_names("disparity", names), (Names{"min_disparity", "disparity_range"}))
      << "the nearest first";
  EXPECT_EQ(similar_names("verify_every_frame", names), (Names{"verify"}));
  EXPECT_EQ(similar_names("ra", names), Names{}) << "too short";
}

}  // namespace
}  // namespace fpga_stereo::test
