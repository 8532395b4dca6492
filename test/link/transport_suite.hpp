// What every transport does alike. The tests stand in transport_suite.cpp; who links it says over
// which lines: INSTANTIATE_TEST_SUITE_P(..., TransportTest, ...).
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "link/lines.hpp"

namespace fpga_stereo::test {

using Milliseconds = std::chrono::milliseconds;

class TransportTest : public testing::TestWithParam<LineKind> {
 protected:
  void SetUp() override {
    line_ = GetParam().make();
    open();
  }
  void TearDown() override { transport_.reset(); }
  void open();

  std::unique_ptr<Line> line_;
  std::unique_ptr<link::Transport> transport_;
};

Bytes random_bytes(std::size_t size, unsigned seed);

/// `size` bytes, read in pieces of up to `piece`; fewer after five seconds without any.
Bytes read_all(link::Transport& transport, std::size_t size, std::size_t piece = 65536);
/// All of `bytes`, written in pieces: how many went, at once or in five seconds.
std::size_t write_all(link::Transport& transport, const Bytes& bytes, std::size_t piece = 1 << 20);

}  // namespace fpga_stereo::test
