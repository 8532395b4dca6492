// Tests that all transports must pass. They are in transport_suite.cpp; a program that links it
// names its lines with INSTANTIATE_TEST_SUITE_P(..., TransportTest, ...).
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

/// Reads `size` bytes in pieces of up to `piece`; returns fewer after five seconds without any.
Bytes read_all(link::Transport& transport, std::size_t size, std::size_t piece = 65536);
/// Writes all bytes in pieces. Returns how many the transport accepted within five seconds.
std::size_t write_all(link::Transport& transport, const Bytes& bytes, std::size_t piece = 1 << 20);

}  // namespace fpga_stereo::test
