// Compares fs_rectify with rectify(), including the limits of its line buffer.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "Rectify640x102.h"
#include "Rectify80x10.h"
#include "fpga_stereo/core/calibration.hpp"
#include "raster.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kLatencyTicks = 35;  // LatencyTicks of fs_rectify.sv

struct Images {
  cv::Mat1b left, right;
};
struct Meshes {
  Mesh left, right;
  cv::Size size() const { return left.size; }
};
/// An output frame; *_error is 1 where fs_rectify flagged a buffer error.
struct Rectified {
  cv::Mat1b left, right, left_error, right_error;
};

std::vector<Images> random_pairs(cv::Size size, int count, unsigned seed) {
  std::vector<Images> pairs(count);
  for (Images& pair : pairs) {
    pair.left = random_image(size, ++seed);
    pair.right = random_image(size, ++seed);
  }
  return pairs;
}

/// Returns a mesh that shifts the image by (x, y) px.
Mesh shift_mesh(cv::Size size, double x, double y) {
  Mesh mesh = Mesh::shift(size, 0);
  mesh.nodes =
      cv::Vec2s(cv::saturate_cast<short>(kMeshScale * x), cv::saturate_cast<short>(kMeshScale * y));
  return mesh;
}

/// Returns a mesh of independent random nodes, up to max_x / 128 px and max_y / 128 px.
Mesh random_mesh(cv::Size size, int max_x, int max_y, unsigned seed) {
  Mesh mesh = Mesh::shift(size, 0);
  cv::RNG random(seed);
  for (cv::Vec2s& node : mesh.nodes) {
    node = {cv::saturate_cast<short>(random.uniform(-max_x - 1, max_x + 1)),
            cv::saturate_cast<short>(random.uniform(-max_y - 1, max_y + 1))};
  }
  return mesh;
}

/// Returns a mesh with smooth waves of up to `max_px` px.
Mesh wave_mesh(cv::Size size, double max_px, unsigned seed) {
  const Texture across(seed), down(seed + 1000);
  Mesh mesh = Mesh::shift(size, 0);
  for (int j = 0; j < mesh.nodes.rows; ++j) {
    for (int i = 0; i < mesh.nodes.cols; ++i) {
      const auto displacement = [&](const Texture& texture) {
        return cv::saturate_cast<short>(kMeshScale * max_px * (texture(i, j) / 127.5 - 1));
      };
      mesh.nodes(j, i) = {displacement(across), displacement(down)};
    }
  }
  return mesh;
}

/// Returns the read start T_s, in pixels, that both meshes need.
std::int64_t common_read_start(const Meshes& meshes) {
  return std::max(line_buffer_need(meshes.left, meshes.size()).read_start,
                  line_buffer_need(meshes.right, meshes.size()).read_start);
}

/// Returns 1 for each pixel that needs a raw pixel which a line buffer of `rows` rows does not hold
/// `read_start` ticks after the raw pixel at the same position arrived.
cv::Mat1b buffer_error_mask(const Mesh& mesh, std::int64_t read_start, int rows) {
  cv::Mat1b out(mesh.size, std::uint8_t{0});
  for (int y = 0; y < mesh.size.height; ++y) {
    for (int x = 0; x < mesh.size.width; ++x) {
      const cv::Point source = naive::source(mesh, x, y);
      for (const cv::Point step : {cv::Point(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
        const cv::Point tap = cv::Point(source.x >> 5, source.y >> 5) + step;
        if (!cv::Rect({}, mesh.size).contains(tap)) continue;
        const std::int64_t distance = std::int64_t{tap.y - y} * mesh.size.width + tap.x - x;
        const bool is_held =
            distance < read_start && distance >= read_start - std::int64_t{rows} * mesh.size.width;
        if (!is_held) out(y, x) = 1;
      }
    }
  }
  return out;
}

/// Runs a model and writes meshes to its shadow bank while the clock runs.
template <class Model>
class RectifyRig {
 public:
  explicit RectifyRig(int line_rows) : usable_rows_(line_rows - 1) {
    model_.rst_ni = 1;
    model_.en_i = 0;
    model_.mesh_we_i = 0;
    model_.mesh_bank_i = 0;
    model_.clk_i = 0;
    model_.eval();
  }
  ~RectifyRig() { model_.final(); }

  Model& model() { return model_; }
  int usable_rows() const { return usable_rows_; }

  /// Queues the writes of both meshes; one goes out per clock.
  void queue(const Meshes& meshes) {
    for (const bool right : {false, true}) {
      const cv::Mat_<cv::Vec2s>& nodes = (right ? meshes.right : meshes.left).nodes;
      for (int k = 0; k < static_cast<int>(nodes.total()); ++k) {
        const cv::Vec2s node = nodes(k / nodes.cols, k % nodes.cols);
        writes_.push_back({right, k,
                           static_cast<std::uint32_t>(static_cast<std::uint16_t>(node[1])) << 16 |
                               static_cast<std::uint16_t>(node[0])});
      }
    }
  }
  bool queue_empty() const { return writes_.empty(); }

  /// Drives the write port with the next queued write, if any. Call it once per clock.
  void drive_next_write() {
    model_.mesh_we_i = writes_.empty() ? 0 : 1;
    if (writes_.empty()) return;
    model_.mesh_right_i = writes_.front().right;
    model_.mesh_node_i = writes_.front().node;
    model_.mesh_data_i = writes_.front().data;
    writes_.pop_front();
  }

  void swap_banks() { model_.mesh_bank_i = model_.mesh_bank_i ? 0 : 1; }

  /// Writes `meshes` and makes them active; no frame may be in flight.
  void load(const Meshes& meshes) {
    queue(meshes);
    model_.en_i = 0;
    while (!writes_.empty()) {
      drive_next_write();
      clock();
    }
    model_.mesh_we_i = 0;
    swap_banks();
  }

  void clock() {
    model_.clk_i = 0;
    model_.eval();
    model_.clk_i = 1;
    model_.eval();
  }

  void set_size_and_start(cv::Size size, std::int64_t read_start) {
    model_.width_i = size.width;
    model_.height_i = size.height;
    model_.read_rows_i = static_cast<int>(read_start / size.width);
    model_.read_pixels_i = static_cast<int>(read_start % size.width);
  }

  /// Sends the pairs and returns the output frames. Calls `each_clock(frames)` before each clock
  /// with the number of complete output frames.
  std::vector<Rectified> run(Raster raster, const std::vector<Images>& pairs,
                             std::int64_t read_start,
                             const std::function<void(int)>& each_clock = {}) {
    const cv::Size size = pairs[0].left.size();
    raster.width = size.width;
    raster.height = size.height;
    set_size_and_start(size, read_start);
    std::vector<Rectified> out(pairs.size());
    for (Rectified& frame : out) {
      for (cv::Mat1b* image : {&frame.left, &frame.right, &frame.left_error, &frame.right_error}) {
        image->create(size);
      }
    }
    int complete_frames = 0;
    bool has_stray_error = false;
    const auto every_clock = [&] {
      drive_next_write();
      if (each_clock) each_clock(complete_frames);
      if (!model_.valid_o && (model_.left_error_o || model_.right_error_o)) has_stray_error = true;
    };
    const RasterResult result = run_raster<Model>(
        model_, raster, static_cast<int>(pairs.size()),
        [&](int frame, int x, int y) {
          model_.left_i = pairs[frame].left(y, x);
          model_.right_i = pairs[frame].right(y, x);
          every_clock();
        },
        [&](std::mt19937& random) {
          model_.left_i = static_cast<std::uint8_t>(random());
          model_.right_i = static_cast<std::uint8_t>(random());
          every_clock();
        },
        [&](int frame, int x, int y) {
          out[frame].left(y, x) = model_.left_o;
          out[frame].right(y, x) = model_.right_o;
          out[frame].left_error(y, x) = model_.left_error_o;
          out[frame].right_error(y, x) = model_.right_error_o;
          if (x == size.width - 1 && y == size.height - 1) complete_frames = frame + 1;
        });
    EXPECT_EQ(result.latency_ticks, read_start + kLatencyTicks);
    EXPECT_FALSE(has_stray_error) << "buffer error outside every frame";
    return out;
  }

  /// Expects a buffer error exactly where the line buffer lacks a pixel, and elsewhere the result
  /// of rectify().
  void expect_equal(const Meshes& meshes, const std::vector<Images>& pairs,
                    const std::vector<Rectified>& out, std::int64_t read_start,
                    const std::string& about) {
    const cv::Mat1b left_errors = buffer_error_mask(meshes.left, read_start, usable_rows_);
    const cv::Mat1b right_errors = buffer_error_mask(meshes.right, read_start, usable_rows_);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      Case c;
      std::ostringstream text;
      text << about << ", " << meshes.size() << ", T_s " << read_start << ", frame " << k;
      c.about = text.str();
      const auto compare = [&](const Mesh& mesh, const cv::Mat1b& raw, const cv::Mat1b& mask,
                               const cv::Mat1b& got, const cv::Mat1b& error) {
        cv::Mat expected;
        rectify(raw, mesh, cv::Range::all(), expected);
        got.copyTo(expected, mask);
        EXPECT_TRUE(same("rectify", expected, got, c));
        EXPECT_TRUE(same("rectify error", mask, error, c));
      };
      compare(meshes.left, pairs[k].left, left_errors, out[k].left, out[k].left_error);
      compare(meshes.right, pairs[k].right, right_errors, out[k].right, out[k].right_error);
    }
  }

  /// Loads the meshes, runs random images through the model and compares the output.
  void load_and_check(const Meshes& meshes, const Raster& raster, int frames,
                      std::int64_t read_start, const std::string& about) {
    load(meshes);
    const std::vector<Images> pairs = random_pairs(meshes.size(), frames, raster.seed * 100);
    expect_equal(meshes, pairs, run(raster, pairs, read_start), read_start, about);
  }

 private:
  struct Write {
    bool right;
    int node;
    std::uint32_t data;
  };
  Model model_;
  int usable_rows_;
  std::deque<Write> writes_;
};

struct LargeRig : RectifyRig<Rectify640x102> {
  LargeRig() : RectifyRig(102) {}
};
/// With 80 nodes and 10 rows, every mesh reaches the ends of the line buffer.
struct SmallRig : RectifyRig<Rectify80x10> {
  SmallRig() : RectifyRig(10) {}
};

Raster make_raster(std::vector<int> rows, double stall_chance, unsigned seed) {
  Raster raster;
  raster.bubble_rows = std::move(rows);
  raster.stall_chance = stall_chance;
  raster.seed = seed;
  return raster;
}

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
  for (int bank = 0; bank < 2; ++bank) {
    const auto out = rig.run(make_raster({0}, 0, 8), pairs, size.width + 2);
    rig.expect_equal(zero, pairs, out, size.width + 2, "not written");
    rig.swap_banks();
  }
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

// New meshes are written while frames are in flight, and become active after those frames are out.
TEST(RtlRectify, SwapsMeshesBetweenFrames) {
  LargeRig rig;
  const cv::Size size(75, 50);
  const Meshes first = {wave_mesh(size, 6, 70), wave_mesh(size, 6, 71)};
  const Meshes second = {wave_mesh(size, 5, 72), random_mesh(size, 900, 900, 73)};
  const std::int64_t read_start = std::max(common_read_start(first), common_read_start(second));
  const std::vector<Images> pairs = random_pairs(size, 6, 74);
  rig.load(first);
  rig.queue(second);
  bool has_swapped = false;
  const auto out =
      rig.run(make_raster({0, 0, 0, 60, 0}, 0.2, 75), pairs, read_start, [&](int frames) {
        if (frames < 3 || has_swapped) return;
        EXPECT_TRUE(rig.queue_empty());
        has_swapped = true;
        rig.swap_banks();
        rig.queue(first);  // written while the second meshes are in use
      });
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
