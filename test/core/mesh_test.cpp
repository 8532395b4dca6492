#include "fpga_stereo/core/mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fpga_stereo/core/calibration.hpp"
#include "support/data_test.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

Mesh random_mesh(cv::Size size, int max_units, unsigned seed) {
  Mesh mesh = Mesh::shift(size, 0);
  cv::RNG(seed).fill(mesh.nodes, cv::RNG::UNIFORM, -max_units, max_units);
  return mesh;
}

TEST(Mesh, NodeCountHasOnePastTheLastPixel) {
  EXPECT_EQ(Mesh::node_count({1, 1}), cv::Size(2, 2));
  EXPECT_EQ(Mesh::node_count({8, 8}), cv::Size(2, 2));
  EXPECT_EQ(Mesh::node_count({9, 7}), cv::Size(3, 2));
  EXPECT_EQ(Mesh::node_count({640, 480}), cv::Size(81, 61));
  EXPECT_EQ(Mesh::node_count({752, 481}), cv::Size(95, 62));
}

TEST(Mesh, ShiftMovesByWholePixels) {
  for (const int shift : {-128, -3, 0, 5, 128}) {
    const Mesh mesh = Mesh::shift({19, 11}, shift);
    EXPECT_EQ(mesh.size, cv::Size(19, 11));
    EXPECT_EQ(mesh.nodes.size(), Mesh::node_count({19, 11}));
    const MeshRow row(mesh, 10);
    EXPECT_EQ(row.source(0), cv::Point(32 * shift, 320));
    EXPECT_EQ(row.source(18), cv::Point(32 * (18 + shift), 320));
  }
}

// One node is displaced by 128 units = 1 px; its weight at (x, y) is (8 - x) (8 - y) / 64.
TEST(MeshRow, BilinearByHand) {
  Mesh mesh = Mesh::shift({16, 16}, 0);
  mesh.nodes(0, 0) = {128, -128};
  EXPECT_EQ(MeshRow(mesh, 0).source(0), cv::Point(32, -32));
  EXPECT_EQ(MeshRow(mesh, 0).source(4), cv::Point(4 * 32 + 16, -16));
  EXPECT_EQ(MeshRow(mesh, 4).source(4), cv::Point(4 * 32 + 8, 4 * 32 - 8));
  EXPECT_EQ(MeshRow(mesh, 6).source(7), cv::Point(7 * 32 + 1, 6 * 32 - 1));
  EXPECT_EQ(MeshRow(mesh, 0).source(8), cv::Point(8 * 32, 0));
}

// 2 units are one half of 1/32 px.
TEST(MeshRow, RoundsHalfUp) {
  Mesh mesh = Mesh::shift({8, 8}, 0);
  const auto source = [&](int units) {
    mesh.nodes = cv::Vec2s::all(static_cast<short>(units));
    return MeshRow(mesh, 0).source(0);
  };
  EXPECT_EQ(source(1), cv::Point(0, 0));
  EXPECT_EQ(source(2), cv::Point(1, 1));
  EXPECT_EQ(source(5), cv::Point(1, 1));
  EXPECT_EQ(source(6), cv::Point(2, 2));
  EXPECT_EQ(source(-2), cv::Point(0, 0));
  EXPECT_EQ(source(-3), cv::Point(-1, -1));
  EXPECT_EQ(source(-6), cv::Point(-1, -1));
}

TEST(MeshRow, EqualsTheNaiveModel) {
  unsigned seed = 1300;
  for (const cv::Size size : {cv::Size(1, 1), {1, 20}, {20, 1}, {8, 8}, {9, 17}, {33, 25}}) {
    for (const int max_units : {3, 400, 32768}) {
      const Mesh mesh = random_mesh(size, max_units, ++seed);
      for (int y = 0; y < size.height; ++y) {
        const MeshRow row(mesh, y);
        for (int x = 0; x < size.width; ++x) {
          ASSERT_EQ(row.source(x), naive::source(mesh, x, y))
              << "x " << x << ", y " << y << ", size " << size << ", seed " << seed;
        }
      }
    }
  }
}

TEST(MakeRectification, NodesAreRoundedHalfUp) {
  const double unit = 1.0 / kMeshScale;
  const auto node = [&](double displacement) {
    const ExactMap map = [=](double x, double y) {
      return cv::Point2d(x + displacement, y - displacement);
    };
    const auto rectification = make_rectification(map, {16, 16}, {16, 16}, "left");
    return rectification->mesh.nodes(1, 1);
  };
  EXPECT_EQ(node(0), cv::Vec2s(0, 0));
  EXPECT_EQ(node(0.5 * unit), cv::Vec2s(1, 0));
  EXPECT_EQ(node(1.5 * unit), cv::Vec2s(2, -1));
  EXPECT_EQ(node(1.25 * unit), cv::Vec2s(1, -1));
  EXPECT_EQ(node(2), cv::Vec2s(256, -256));
}

TEST(MakeRectification, RefusesMapsThatAMeshCannotFollow) {
  // A wave that is zero at every node of the mesh.
  const ExactMap wave = [](double x, double y) {
    return cv::Point2d(x + 3 * std::sin(CV_PI * x / 8), y);
  };
  const auto rectification = make_rectification(wave, {64, 64}, {64, 64}, "right");
  ASSERT_FALSE(rectification);
  EXPECT_EQ(rectification.error().kind, ErrorKind::kCalibration);
  EXPECT_NE(rectification.error().message.find("right"), std::string::npos)
      << rectification.error().message;

  const ExactMap far = [](double x, double y) { return cv::Point2d(x, y + 300); };
  EXPECT_FALSE(make_rectification(far, {64, 640}, {64, 640}, "left"))
      << "the displacement exceeds 16 bits";
  const ExactMap behind = [](double x, double y) {
    return x < 40 ? cv::Point2d(x, y) : cv::Point2d(std::nan(""), y);
  };
  EXPECT_FALSE(make_rectification(behind, {64, 64}, {64, 64}, "left"));
}

TEST(MakeRectification, IgnoresDeviationOutsideTheRawImage) {
  const ExactMap map = [](double x, double y) {
    return x < 32 ? cv::Point2d(x, y) : cv::Point2d(x + 5000, y);
  };
  // Columns 24 .. 31 lie between a node that moves and one that does not: off by more than 1 px.
  EXPECT_FALSE(make_rectification(map, {64, 8}, {64, 8}, "left"));
  // If their sources lie outside the raw image as well, the map is accepted.
  const auto rectification = make_rectification(map, {64, 8}, {25, 8}, "left");
  ASSERT_TRUE(rectification);
  EXPECT_EQ(rectification->mesh.nodes(0, 7), cv::Vec2s(32767, 0)) << "saturated";
  EXPECT_EQ(rectification->deviation.max, 0);
}

TEST(MeshDeviation, ByHand) {
  const Mesh mesh = Mesh::shift({10, 10}, 0);
  const ExactMap map = [](double x, double y) {
    return x == 3 && y == 4 ? cv::Point2d(x + 0.3, y - 0.4) : cv::Point2d(x, y);
  };
  const MeshDeviation d = mesh_deviation(mesh, map, {10, 10});
  EXPECT_DOUBLE_EQ(d.max, 0.5);
  EXPECT_DOUBLE_EQ(d.rms, 0.05);
  EXPECT_EQ(d.max_at, cv::Point(3, 4));
  EXPECT_EQ(d.pixels, 100);
}

TEST(MeshDeviation, IgnoresSourcesOutsideTheRawImage) {
  const Mesh mesh = Mesh::shift({10, 10}, 0);
  const ExactMap map = [](double x, double y) { return cv::Point2d(x > 5 ? x + 20 : x + 0.25, y); };
  const MeshDeviation d = mesh_deviation(mesh, map, {10, 10});
  EXPECT_DOUBLE_EQ(d.max, 0.25);
  EXPECT_DOUBLE_EQ(d.rms, 0.25);
  EXPECT_EQ(d.pixels, 60);
}

using MeshData = DataTest;

TEST_F(MeshData, DeviationOfRealCalibrations) {
  for (const CalibrationPair& pair : {euroc_calibration(), chessboard_calibration()}) {
    const auto rectification = make_stereo_rectification(pair.left, pair.right, 0);
    ASSERT_TRUE(rectification) << rectification.error().message;
    for (const CameraRectification* camera : {&rectification->left, &rectification->right}) {
      EXPECT_LE(camera->deviation.max, 1.0 / 16);
      EXPECT_LE(camera->deviation.rms, 1.0 / 32);
      EXPECT_GT(camera->deviation.rms, 1e-3) << "rounding alone causes 0.01";
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
