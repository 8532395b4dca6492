// The line buffer of the board: compares line_buffer_need() with a simulation of the buffer.
#include <gtest/gtest.h>

#include "fpga_stereo/core/calibration.hpp"
#include "support/data_test.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

/// Simulates a buffer into which one raw pixel enters per clock, and from which one rectified pixel
/// leaves per clock, `read_start` clocks later. Frames follow each other without a gap. Returns
/// whether every tap is read after it was written and before it is overwritten.
bool buffer_works(const Mesh& mesh, cv::Size raw, int rows, std::int64_t read_start) {
  const std::int64_t capacity = std::int64_t{rows} * raw.width;
  if (capacity <= 0) return false;
  std::vector<std::int64_t> memory(static_cast<std::size_t>(capacity), -1);
  std::int64_t written = 0;
  const auto write = [&] {
    memory[static_cast<std::size_t>(written % capacity)] = written;
    ++written;
  };
  while (written < read_start) write();
  for (int y = 0; y < mesh.size.height; ++y) {
    for (int x = 0; x < mesh.size.width; ++x, write()) {
      const cv::Point source = naive::source(mesh, x, y);
      for (const cv::Point step : {cv::Point(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
        const cv::Point tap = cv::Point(source.x >> 5, source.y >> 5) + step;
        if (!cv::Rect({}, raw).contains(tap)) continue;
        const std::int64_t pixel = std::int64_t{tap.y} * raw.width + tap.x;
        if (memory[static_cast<std::size_t>(pixel % capacity)] != pixel) return false;
      }
    }
  }
  return true;
}

void expect_need(const Mesh& mesh, int above, int below, std::int64_t start, int rows) {
  const LineBufferNeed need = line_buffer_need(mesh, mesh.size);
  EXPECT_EQ(need.rows_above, above);
  EXPECT_EQ(need.rows_below, below);
  EXPECT_EQ(need.read_start, start);
  EXPECT_EQ(need.rows, rows);
}

/// Expects that the buffer works, and fails with one row or one clock less.
void expect_exact(const Mesh& mesh, cv::Size raw) {
  const LineBufferNeed need = line_buffer_need(mesh, raw);
  EXPECT_TRUE(buffer_works(mesh, raw, need.rows, need.read_start));
  EXPECT_FALSE(buffer_works(mesh, raw, need.rows - 1, need.read_start));
  EXPECT_FALSE(buffer_works(mesh, raw, need.rows, need.read_start - 1));
}

/// Returns a mesh that moves every pixel by (x, y) px.
Mesh shifted(cv::Size size, int x, int y) {
  Mesh mesh = Mesh::shift(size, 0);
  mesh.nodes = cv::Vec2s(cv::saturate_cast<short>(128 * x), cv::saturate_cast<short>(128 * y));
  return mesh;
}

// All 2 x 2 taps are read, even if the second row and column have weight 0, so row 0 waits for the
// second pixel of row 1.
TEST(LineBufferNeed, IdentityByHand) {
  expect_need(shifted({16, 16}, 0, 0), 0, 1, 16 + 1 + 1, 2);
  expect_need(shifted({16, 1}, 0, 0), 0, 0, 2, 1);
  expect_need(shifted({1, 16}, 0, 0), 0, 1, 2, 2);
  expect_need(shifted({1, 1}, 0, 0), 0, 0, 1, 1);
  for (const cv::Size size : {cv::Size(16, 16), {16, 1}, {1, 16}, {1, 1}, {9, 5}}) {
    expect_exact(shifted(size, 0, 0), size);
  }
}

TEST(LineBufferNeed, ShiftAlongTheRowByHand) {
  expect_need(shifted({16, 16}, 3, 0), 0, 1, 16 + 4 + 1, 2);
  expect_need(shifted({16, 16}, -3, 0), 0, 1, 16 - 2 + 1, 2);
  expect_need(shifted({16, 16}, -16, 0), 0, 1, 16 - 15 + 1, 2);
  for (const int shift : {-16, -15, -3, 3, 14}) {
    const LineBufferNeed need = line_buffer_need(shifted({16, 16}, shift, 0), {16, 16});
    EXPECT_TRUE(buffer_works(shifted({16, 16}, shift, 0), {16, 16}, need.rows, need.read_start));
  }
}

TEST(LineBufferNeed, ShiftDownTheColumnByHand) {
  const LineBufferNeed below = line_buffer_need(shifted({16, 16}, 0, 5), {16, 16});
  EXPECT_EQ(below.rows_above, 0);
  EXPECT_EQ(below.rows_below, 6);
  EXPECT_EQ(below.read_start, 6 * 16 + 1 + 1);
  EXPECT_TRUE(buffer_works(shifted({16, 16}, 0, 5), {16, 16}, below.rows, below.read_start));
  const LineBufferNeed above = line_buffer_need(shifted({16, 16}, 0, -5), {16, 16});
  EXPECT_EQ(above.rows_above, 5);
  EXPECT_EQ(above.rows_below, 0);
  EXPECT_GE(above.rows, 5);
  EXPECT_TRUE(buffer_works(shifted({16, 16}, 0, -5), {16, 16}, above.rows, above.read_start));
}

// The map looks up to 4 rows up at the left and 4 rows down at the right.
TEST(LineBufferNeed, TiltIsExact) {
  Mesh mesh = Mesh::shift({40, 33}, 0);
  for (int j = 0; j < mesh.nodes.rows; ++j) {
    for (int i = 0; i < mesh.nodes.cols; ++i) {
      mesh.nodes(j, i) = {0, static_cast<std::int16_t>(128 * 4 * (2 * i - 5) / 5)};
    }
  }
  const LineBufferNeed need = line_buffer_need(mesh, mesh.size);
  EXPECT_EQ(need.rows_above, 4);
  EXPECT_EQ(need.rows_below, 4);
  expect_exact(mesh, mesh.size);
}

// A map that looks only down or only up needs no rows on the other side.
TEST(LineBufferNeed, OneSidedMapsAreExact) {
  const cv::Size size{24, 40};
  EXPECT_EQ(line_buffer_need(shifted(size, 0, 10), size).rows, 2);
  EXPECT_EQ(line_buffer_need(shifted(size, 0, -10), size).read_start, 0);
  for (const int shift : {3, 10, 20}) {
    const Mesh mesh = shifted(size, 0, shift);
    expect_exact(mesh, size);
  }
  EXPECT_EQ(line_buffer_need(shifted(size, 200, 0), size).rows, 0) << "no raw pixel is read";
}

TEST(LineBufferNeed, RandomMeshesAreExact) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    cv::RNG rng(seed);
    const cv::Size size{rng.uniform(20, 50), rng.uniform(20, 50)};
    Mesh mesh = Mesh::shift(size, 0);
    rng.fill(mesh.nodes, cv::RNG::UNIFORM, -128 * 7, 128 * 7);
    expect_exact(mesh, size);
  }
}

TEST(LineBufferNeed, IsEmptyIfNoRawPixelIsRead) {
  const Mesh mesh = shifted({16, 16}, 100, 0);
  const LineBufferNeed need = line_buffer_need(mesh, {16, 16});
  EXPECT_EQ(need.rows_above, 0);
  EXPECT_EQ(need.rows_below, 0);
  EXPECT_LE(need.rows, 1);
}

TEST(CheckLineBuffer, RefusalNamesBothNumbers) {
  LineBufferNeed need;
  need.rows = 104;
  need.rows_above = 52;
  need.rows_below = 50;
  EXPECT_TRUE(check_line_buffer(need, 104, "left"));
  EXPECT_TRUE(check_line_buffer(need, 128, "left"));
  const Status status = check_line_buffer(need, 103, "right");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kCalibration);
  for (const std::string word : {"right", "104", "103", "52", "50"}) {
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
  }
}

using BufferData = DataTest;

// Over both cameras, sources lie from 51.4 rows above to 49.3 rows below the output row.
TEST_F(BufferData, EurocRows) {
  const CalibrationPair pair = euroc_calibration();
  const auto rectification = make_stereo_rectification(pair.left, pair.right, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  const LineBufferNeed left = rectification->left.line_buffer;
  const LineBufferNeed right = rectification->right.line_buffer;
  EXPECT_NEAR(std::max(left.rows_above, right.rows_above), 51.4, 1.0);
  EXPECT_NEAR(std::max(left.rows_below, right.rows_below), 49.3, 1.0);
  expect_exact(rectification->left.mesh, {752, 480});
  expect_exact(rectification->right.mesh, {752, 480});
  EXPECT_FALSE(check_line_buffer(left, left.rows - 1, "left"));
}

}  // namespace
}  // namespace fpga_stereo::test
