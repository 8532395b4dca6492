#include "link/configuration_tags.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

TEST(ConfigurationTags, HoldForAsManyIdsAsAnApplyMayGive) {
  link::ConfigurationTags tags(4);
  EXPECT_TRUE(tags.empty());
  tags.bind(10, 1);
  EXPECT_FALSE(tags.find(9));
  EXPECT_EQ(tags.find(10), 1U);
  EXPECT_EQ(tags.find(13), 1U);
  EXPECT_FALSE(tags.find(14)) << "the host did not apply five times";
  tags.bind(12, 2);
  EXPECT_EQ(tags.find(11), 1U);
  EXPECT_EQ(tags.find(12), 2U);
  EXPECT_TRUE(tags.has_later(11));
  EXPECT_FALSE(tags.has_later(12));
}

TEST(ConfigurationTags, AcceptNoForeignFrameAfterTheWrap) {
  link::ConfigurationTags tags(4);
  tags.bind(0xFFFFFFFF + 1U, 7);  // the id after the largest
  EXPECT_EQ(tags.find(0), 7U);
  EXPECT_FALSE(tags.find(0xFFFFFFFF));
  EXPECT_FALSE(tags.find(5));
  EXPECT_TRUE(tags.has_later(0xFFFFFFFF));
}

TEST(ConfigurationTags, MayAcceptFramesOfAnyConfiguration) {
  link::ConfigurationTags tags(4);
  tags.bind_any(3);
  EXPECT_EQ(tags.find(0), 3U);
  EXPECT_EQ(tags.find(0x80000000), 3U);
  EXPECT_FALSE(tags.empty());
  tags.bind(5, 4);
  EXPECT_FALSE(tags.find(4));
  tags.clear();
  EXPECT_TRUE(tags.empty());
}

}  // namespace
}  // namespace fpga_stereo::test
