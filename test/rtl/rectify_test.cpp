// Compares fs_rectify with rectify(), including the limits of its line buffer.
#include <gtest/gtest.h>

#include <cmath>

#include "Rectify640x102.h"
#include "Rectify80x10.h"
#include "rtl/rectify_rig.hpp"

namespace fpga_stereo::test {
namespace {

struct LargeRig : RectifyRig<Rectify640x102> {
  LargeRig() : RectifyRig(102) {}
};
/// With 80 nodes and 10 rows, every mesh reaches the ends of the line buffer.
struct SmallRig : RectifyRig<Rectify80x10> {
  SmallRig() : RectifyRig(10) {}
};

const std::vector<cv::Size> kSizes = {{16, 1},  {16, 5},  {17, 9}, {33, 20},
                                      {64, 48}, {75, 50}, {23, 3}, {24, 17}};

// Any mesh fits an image of up to 50 rows: neither T_s nor the distance to the oldest pixel exceeds
// the image.
TEST(RtlRectify, EqualsSoftwareForEveryMeshAtEverySize) {
  LargeRig rig;
  unsigned seed = 0;
  for (const cv::Size size : kSizes) {
    const std::vector<std::pair<std::string, Meshes>> all = {
        {"zero", {shift_mesh(size, 0, 0), shift_mesh(size, 0, 0)}},
        {"shift", {shift_mesh(size, 3, -2), shift_mesh(size, -7.5, 4.25)}},
        {"waves", {wave_mesh(size, 6, ++seed), wave_mesh(size, 9, ++seed)}},
        {"random", {random_mesh(size, 700, 700, ++seed), random_mesh(size, 3000, 3000, ++seed)}},
        {"random, full range",
         {random_mesh(size, 32767, 32767, ++seed), random_mesh(size, 32767, 32767, ++seed)}},
        {"random, one axis",
         {random_mesh(size, 32767, 0, ++seed), random_mesh(size, 0, 32767, ++seed)}},
        {"large shift", {shift_mesh(size, 1000, 1000), shift_mesh(size, -1000, -1000)}}};
    for (const auto& [name, meshes] : all) {
      const std::int64_t read_start = common_read_start(meshes);
      ++seed;
      const Raster raster = make_raster({1, 0, 3}, seed % 2 != 0 ? 0.3 : 0, seed);
      rig.load_and_check(meshes, raster, 3, read_start, name);
      for (const Mesh* mesh : {&meshes.left, &meshes.right}) {
        EXPECT_EQ(cv::countNonZero(buffer_error_mask(*mesh, read_start, rig.usable_rows())), 0);
      }
      if (HasFailure()) return;
    }
  }
}

TEST(RtlRectify, EqualsSoftwareOnExtremeImages) {
  LargeRig rig;
  const cv::Size size(75, 50);
  const Meshes meshes = {wave_mesh(size, 5, 1), wave_mesh(size, 5, 2)};
  const std::int64_t read_start = common_read_start(meshes);
  rig.load(meshes);
  std::vector<Images> pairs;
  for (const NamedImage& named : extreme_images(size, 3))
    pairs.push_back({named.image, named.image});
  cv::Mat1b bright(size, std::uint8_t{0});
  bright(20, 30) = 255;
  pairs.push_back({bright, 255 - bright});
  rig.expect_equal(meshes, pairs, rig.run(make_raster({0}, 0, 4), pairs, read_start), read_start,
                   "extreme images");
}

/// Returns a camera with lens distortion, rotated by `roll` rad about its optical axis.
CameraCalibration turned_camera(cv::Size size, double roll, double k1) {
  CameraCalibration camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.distortion_model = "plumb_bob";
  camera.D = {k1, 0.08, 0.001, -0.002, 0};
  const double f = 0.9 * size.width, cx = 0.5 * size.width - 3.5, cy = 0.5 * size.height + 2.25;
  camera.K = {f, 0, cx, 0, f, cy, 0, 0, 1};
  camera.R = {std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll), 0, 0, 0, 1};
  camera.P = {f, 0, cx, 0, 0, f, cy, 0, 0, 0, 1, 0};
  return camera;
}

/// Returns the meshes of two such cameras, rotated in opposite directions.
Meshes calibrated_meshes(cv::Size size, double roll) {
  const auto make = [&](double turn, double k1, const char* name) {
    const ExactMap map = exact_map(turned_camera(size, turn, k1));
    const auto rectification = make_rectification(map, size, size, name);
    if (!rectification) throw std::runtime_error(rectification.error().message);
    return rectification->mesh;
  };
  return {make(roll, -0.3, "left"), make(-roll, -0.25, "right")};
}

// Meshes as the host makes them. The mesh of 640 x 480 pixels uses every part of the mesh memory.
TEST(RtlRectify, EqualsSoftwareForCalibratedCameras) {
  LargeRig rig;
  for (const auto& [size, roll] : {std::pair(cv::Size(320, 200), 0.07), {{640, 480}, 0.03}}) {
    const Meshes meshes = calibrated_meshes(size, roll);
    const std::int64_t read_start = common_read_start(meshes);
    for (const Mesh* mesh : {&meshes.left, &meshes.right}) {
      EXPECT_GT(line_buffer_need(*mesh, size).rows, 20);
      EXPECT_EQ(cv::countNonZero(buffer_error_mask(*mesh, read_start, rig.usable_rows())), 0);
    }
    rig.load_and_check(meshes, make_raster({2, 0}, 0, 5), size.width > 320 ? 1 : 3, read_start,
                       "calibrated");
  }
}

// 32767 units round to 256 px, which needs one bit more than -256 px. Most taps are out of bounds.
TEST(RtlRectify, EqualsSoftwareAtMaxDisplacements) {
  LargeRig rig;
  for (const double far : {1000.0, -1000.0}) {
    const cv::Size wide(300, 10), tall(16, 300);
    const Meshes along = {shift_mesh(wide, far, 0), shift_mesh(wide, far, 0)};
    rig.load_and_check(along, make_raster({0}, 0, 13), 2, common_read_start(along), "along");
    const Meshes down = {shift_mesh(tall, 0, far), shift_mesh(tall, far, far)};
    rig.load_and_check(down, make_raster({0}, 0, 14), 2, std::int64_t{100} * tall.width, "down");
  }
}

TEST(RtlRectify, PassesImagesUnchangedBeforeAnyMeshIsWritten) {
  LargeRig rig;
  const cv::Size size(40, 20);
  const Meshes zero = {shift_mesh(size, 0, 0), shift_mesh(size, 0, 0)};
  const std::vector<Images> pairs = random_pairs(size, 2, 7);
  const auto out = rig.run(make_raster({0}, 0, 8), pairs, size.width + 2);
  rig.expect_equal(zero, pairs, out, size.width + 2, "not written");
}

// The meshes read only pixels above the current one, so T_s may be as small as 0.
TEST(RtlRectify, HasALatencyOfReadStartPlusAConstant) {
  LargeRig rig;
  for (const cv::Size size : {cv::Size(16, 30), {37, 30}}) {
    const int w = size.width;
    const Meshes meshes = {shift_mesh(size, 0, -6), shift_mesh(size, -2, -9)};
    for (const int read_start : {0, 1, 2, w - 1, w, w + 1, 7 * w + 13, 8 * w, 90 * w + 5}) {
      rig.load_and_check(meshes, make_raster({0, 0, 1}, 0, 9), 3, read_start, "up");
    }
  }
}

// Many frames of one row or more are in flight at once, with and without gaps.
TEST(RtlRectify, EqualsSoftwareWithManyTinyFramesInFlight) {
  LargeRig rig;
  for (const cv::Size size : {cv::Size(16, 1), {17, 1}, {21, 2}, {16, 3}, {16, 7}}) {
    const Meshes meshes = {random_mesh(size, 500, 300, 10), random_mesh(size, 500, 300, 11)};
    for (const std::int64_t read_start :
         {common_read_start(meshes), std::int64_t{98} * size.width + 9}) {
      const Raster raster = make_raster({0, 0, 0, 1, 0, 5, 0}, 0.1, 12);
      rig.load_and_check(meshes, raster, 130, read_start, "tiny");
    }
  }
}

// Reads at both ends of a line buffer of 10 rows: every pixel without an error is correct.
TEST(RtlRectify, ReportsBufferErrorsExactly) {
  SmallRig rig;
  unsigned seed = 20;
  for (const cv::Size size : {cv::Size(16, 40), {17, 31}, {24, 30}, {75, 40}, {16, 5}, {16, 1}}) {
    const int w = size.width;
    for (const int read_start : {0, 3, w + 2, 2 * w - 1, 4 * w, 5 * w + 7, 9 * w, 10 * w + 3}) {
      const int down = 128 * ((read_start / w) - 5);
      Meshes meshes = {random_mesh(size, 2000, 800, ++seed), random_mesh(size, 300, 500, ++seed)};
      for (cv::Vec2s& node : meshes.left.nodes) node[1] = static_cast<short>(node[1] + down);
      for (cv::Vec2s& node : meshes.right.nodes) node[1] = static_cast<short>(node[1] + down);
      rig.load_and_check(meshes, make_raster({0, 0, 1}, seed % 4 ? 0 : 0.2, seed), 3, read_start,
                         "random");
      if (HasFailure()) return;
    }
  }
}

// Shifts to the oldest and the newest pixel in the line buffer, and to one pixel beyond each.
TEST(RtlRectify, ReadsUpToBothEndsOfTheLineBuffer) {
  SmallRig rig;
  for (const int w : {16, 17}) {
    const cv::Size size(w, 30);
    for (const int read_start : {w + 2, 3 * w, 4 * w + 9}) {
      const int oldest = read_start - rig.usable_rows() * w;
      for (const int distance : {oldest - 1, oldest, oldest + 1}) {
        const int y = static_cast<int>(std::floor((distance + 8.0) / w));
        const Meshes meshes = {shift_mesh(size, distance - y * w, y), shift_mesh(size, 0, 0)};
        rig.load_and_check(meshes, make_raster({0}, 0, 30), 2, read_start, "oldest");
        const bool has_errors =
            cv::countNonZero(buffer_error_mask(meshes.left, read_start, rig.usable_rows())) > 0;
        EXPECT_TRUE(has_errors || distance >= oldest) << size << ", T_s " << read_start;
      }
      // The lower right tap is the newest of the four.
      for (const int distance : {read_start - 1, read_start}) {
        const int tap = distance - w - 1;
        const int y = static_cast<int>(std::floor((tap + 8.0) / w));
        const Meshes meshes = {shift_mesh(size, tap - y * w, y), shift_mesh(size, 0, -3)};
        rig.load_and_check(meshes, make_raster({0}, 0, 31), 2, read_start, "newest");
        const bool has_errors =
            cv::countNonZero(buffer_error_mask(meshes.left, read_start, rig.usable_rows())) > 0;
        EXPECT_EQ(has_errors, distance == read_start) << size << ", T_s " << read_start;
      }
    }
  }
}

// With the T_s of line_buffer_need() there is no error. A T_s smaller by one, or a mesh that needs
// one row more, causes errors.
TEST(RtlRectify, NeedsExactlyWhatLineBufferNeedReturns) {
  SmallRig rig;
  const auto errors = [&](const Mesh& mesh, std::int64_t read_start) {
    const Meshes meshes = {mesh, shift_mesh(mesh.size, 0, 0)};
    rig.load(meshes);
    const std::vector<Images> pairs = random_pairs(mesh.size, 1, 40);
    return cv::countNonZero(rig.run(make_raster({0}, 0, 41), pairs, read_start)[0].left_error);
  };
  int accepted = 0, refused = 0;
  for (unsigned seed = 50; seed < 80; ++seed) {
    const cv::Size size(seed % 2 ? 16 : 33, 30);
    const Mesh mesh = wave_mesh(size, 2 + 0.5 * (seed - 50), seed);
    const LineBufferNeed need = line_buffer_need(mesh, size);
    const bool ok = static_cast<bool>(check_line_buffer(need, rig.usable_rows(), "left"));
    ++(ok ? accepted : refused);
    EXPECT_EQ(errors(mesh, need.read_start) == 0, ok) << "seed " << seed;
    EXPECT_TRUE(!ok || errors(mesh, need.read_start - 1) > 0) << "seed " << seed;
  }
  EXPECT_GT(accepted, 5);
  EXPECT_GT(refused, 5);
}

// The mesh has 11 x 8 nodes but the memory holds 80: rows from 48 on lack nodes.
TEST(RtlRectify, ReportsErrorsForAMeshLargerThanItsMemory) {
  SmallRig rig;
  const cv::Size size(75, 50);
  rig.load({shift_mesh(size, 0, 0), shift_mesh(size, 0, 0)});
  const auto out = rig.run(make_raster({0}, 0, 60), random_pairs(size, 2, 61), size.width + 2);
  cv::Mat1b expected(size, std::uint8_t{0});
  expected.rowRange(48, 50) = 1;
  for (const Rectified& frame : out) {
    EXPECT_TRUE(same("left error", expected, frame.left_error));
    EXPECT_TRUE(same("right error", expected, frame.right_error));
  }
}

// New meshes are written while bubble rows pass.
TEST(RtlRectify, TakesMeshesBetweenFrames) {
  LargeRig rig;
  const cv::Size size(75, 50);
  const Meshes first = {wave_mesh(size, 6, 70), wave_mesh(size, 6, 71)};
  const Meshes second = {wave_mesh(size, 5, 72), random_mesh(size, 900, 900, 73)};
  const std::int64_t read_start = std::max(common_read_start(first), common_read_start(second));
  const std::vector<Images> pairs = random_pairs(size, 6, 74);
  rig.load(first);
  bool has_queued = false;
  const auto out =
      rig.run(make_raster({0, 0, 0, 60, 0}, 0.2, 75), pairs, read_start, [&](int frames) {
        if (frames < 3 || has_queued) return;
        has_queued = true;
        rig.queue(second);
      });
  EXPECT_TRUE(has_queued && rig.queue_empty());
  const auto part = [](const auto& all, int from) {
    return std::decay_t<decltype(all)>(all.begin() + from, all.begin() + from + 3);
  };
  rig.expect_equal(first, part(pairs, 0), part(out, 0), read_start, "first");
  rig.expect_equal(second, part(pairs, 3), part(out, 3), read_start, "second");
}

// Also in the middle of a frame with buffer errors: none of them may appear after the reset.
TEST(RtlRectify, RecoversFromAResetAtAnyTime) {
  LargeRig rig;
  const cv::Size size(33, 20);
  const Meshes meshes = {wave_mesh(size, 4, 80), random_mesh(size, 600, 600, 81)};
  for (int after = 5; after < 1700; after += 113) {
    for (const std::int64_t read_start :
         {common_read_start(meshes), common_read_start(meshes) / 2}) {
      Raster raster = make_raster({1, 0}, 0.1, 82 + after);
      raster.reset_after_ticks = after;
      rig.load_and_check(meshes, raster, 2, read_start, "after a reset");
    }
  }
}

// Image size, T_s and meshes change between frames.
TEST(RtlRectify, AppliesNewSettingsWithoutAReset) {
  LargeRig rig;
  auto& model = rig.model();
  model.rst_ni = 0;
  rig.clock();
  model.rst_ni = 1;
  unsigned seed = 90;
  for (const cv::Size size : {cv::Size(33, 21), {64, 30}, {17, 9}, {75, 50}, {16, 40}}) {
    const Meshes meshes = {wave_mesh(size, 4, ++seed), wave_mesh(size, 5, ++seed)};
    const std::int64_t read_start = common_read_start(meshes);
    rig.load(meshes);
    rig.set_size_and_start(size, read_start);
    const Images pair = random_pairs(size, 1, ++seed)[0];
    Rectified out = {cv::Mat1b(size), cv::Mat1b(size), cv::Mat1b(size), cv::Mat1b(size)};
    model.en_i = 1;
    int at = 0;
    const int first = 3, rows = first + size.height + static_cast<int>(read_start) / size.width + 6;
    for (int y = -first; y < rows; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const bool is_inside = y >= 0 && y < size.height;
        model.valid_i = is_inside;
        model.sof_i = x == 0 && y == 0;
        model.sol_i = x == 0;
        model.left_i = is_inside ? pair.left(y, x) : 99;
        model.right_i = is_inside ? pair.right(y, x) : 99;
        rig.clock();
        if (!model.valid_o) continue;
        EXPECT_EQ(model.sof_o != 0, at == 0);
        ASSERT_LT(at, size.area());
        const cv::Point to(at % size.width, at / size.width);
        EXPECT_EQ(model.sol_o != 0, to.x == 0);
        out.left(to) = model.left_o;
        out.right(to) = model.right_o;
        out.left_error(to) = model.left_error_o;
        out.right_error(to) = model.right_error_o;
        ++at;
      }
    }
    EXPECT_EQ(at, size.area());
    rig.expect_equal(meshes, {pair}, {out}, read_start, "new settings");
  }
}

}  // namespace
}  // namespace fpga_stereo::test
