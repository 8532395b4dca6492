// Fixture for tests that need the images on disk.
#pragma once

#include <gtest/gtest.h>

#include "support/data.hpp"

namespace fpga_stereo::test {

class DataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!data_dir()) GTEST_SKIP() << kNoData;
  }
};

}  // namespace fpga_stereo::test
