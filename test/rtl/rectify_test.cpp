// The gateware's rectify against fpga_stereo::rectify, with the line buffer's limits.
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

struct Views {
  cv::Mat1b left, right;
};
struct Meshes {
  Mesh left, right;
  cv::Size size() const { return left.size; }
};
/// A frame as it came out; *_error is 1 where the pixel came with an error.
struct Rectified {
  cv::Mat1b left, right, left_error, right_error;
};

std::vector<Views> random_views(cv::Size size, int count, unsigned seed) {
  std::vector<Views> views(count);
  for (Views& view : views) {
    view.left = random_image(size, ++seed);
    view.right = random_image(size, ++seed);
  }
  return views;
}

Mesh moved(cv::Size size, double x, double y) {
  Mesh mesh = Mesh::shift(size, 0);
  mesh.nodes =
      cv::Vec2s(cv::saturate_cast<short>(kMeshScale * x), cv::saturate_cast<short>(kMeshScale * y));
  return mesh;
}

/// Nodes that have nothing to do with each other, up to `largest` / 128 px along and down.
Mesh rough(cv::Size size, int largest_x, int largest_y, unsigned seed) {
  Mesh mesh = Mesh::shift(size, 0);
  cv::RNG random(seed);
  for (cv::Vec2s& node : mesh.nodes) {
    node = {cv::saturate_cast<short>(random.uniform(-largest_x - 1, largest_x + 1)),
            cv::saturate_cast<short>(random.uniform(-largest_y - 1, largest_y + 1))};
  }
  return mesh;
}

/// Waves of up to `largest` px.
Mesh smooth(cv::Size size, double largest, unsigned seed) {
  const Texture across(seed), down(seed + 1000);
  Mesh mesh = Mesh::shift(size, 0);
  for (int j = 0; j < mesh.nodes.rows; ++j) {
    for (int i = 0; i < mesh.nodes.cols; ++i) {
      const auto displacement = [&](const Texture& texture) {
        return cv::saturate_cast<short>(kMeshScale * largest * (texture(i, j) / 127.5 - 1));
      };
      mesh.nodes(j, i) = {displacement(across), displacement(down)};
    }
  }
  return mesh;
}

std::int64_t read_start(const Meshes& meshes) {
  return std::max(line_buffer_need(meshes.left, meshes.size()).read_start,
                  line_buffer_need(meshes.right, meshes.size()).read_start);
}

/// Where a pixel needs one of the raw image that a buffer of `rows` rows does not hold when it is
/// read `start` pixels behind the raw ones.
cv::Mat1b lacking(const Mesh& mesh, std::int64_t start, int rows) {
  cv::Mat1b out(mesh.size, std::uint8_t{0});
  for (int y = 0; y < mesh.size.height; ++y) {
    for (int x = 0; x < mesh.size.width; ++x) {
      const cv::Point source = naive::source(mesh, x, y);
      for (const cv::Point step : {cv::Point(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
        const cv::Point tap = cv::Point(source.x >> 5, source.y >> 5) + step;
        if (!cv::Rect({}, mesh.size).contains(tap)) continue;
        const std::int64_t distance = std::int64_t{tap.y - y} * mesh.size.width + tap.x - x;
        const bool held =
            distance < start && distance >= start - std::int64_t{rows} * mesh.size.width;
        if (!held) out(y, x) = 1;
      }
    }
  }
  return out;
}

/// A model with its host: meshes go into the shadow bank while the clock runs.
template <class Model>
class Bench {
 public:
  explicit Bench(int line_rows) : usable_rows_(line_rows - 1) {
    model_.rst_ni = 1;
    model_.en_i = 0;
    model_.mesh_we_i = 0;
    model_.mesh_bank_i = 0;
    model_.clk_i = 0;
    model_.eval();
  }
  ~Bench() { model_.final(); }

  Model& model() { return model_; }
  int usable_rows() const { return usable_rows_; }

  /// Writes that go out one per clock, in any order of the nodes.
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

  /// Puts the next write on the port; at most once per clock.
  void write_one() {
    model_.mesh_we_i = writes_.empty() ? 0 : 1;
    if (writes_.empty()) return;
    model_.mesh_right_i = writes_.front().right;
    model_.mesh_node_i = writes_.front().node;
    model_.mesh_data_i = writes_.front().data;
    writes_.pop_front();
  }

  void swap() { model_.mesh_bank_i = model_.mesh_bank_i ? 0 : 1; }

  /// Makes `meshes` the active ones while nothing else happens.
  void load(const Meshes& meshes) {
    queue(meshes);
    model_.en_i = 0;
    while (!writes_.empty()) {
      write_one();
      clock();
    }
    model_.mesh_we_i = 0;
    swap();
  }

  void clock() {
    model_.clk_i = 0;
    model_.eval();
    model_.clk_i = 1;
    model_.eval();
  }

  void set(cv::Size size, std::int64_t start) {
    model_.width_i = size.width;
    model_.height_i = size.height;
    model_.read_rows_i = static_cast<int>(start / size.width);
    model_.read_pixels_i = static_cast<int>(start % size.width);
  }

  /// `each_clock(frames)` is called before each clock with the number of whole frames out.
  std::vector<Rectified> run(Raster raster, const std::vector<Views>& views, std::int64_t start,
                             const std::function<void(int)>& each_clock = {}) {
    const cv::Size size = views[0].left.size();
    raster.width = size.width;
    raster.height = size.height;
    set(size, start);
    std::vector<Rectified> out(views.size());
    for (Rectified& frame : out) {
      for (cv::Mat1b* image : {&frame.left, &frame.right, &frame.left_error, &frame.right_error}) {
        image->create(size);
      }
    }
    int whole = 0;
    bool stray = false;
    const auto every_clock = [&] {
      write_one();
      if (each_clock) each_clock(whole);
      if (!model_.valid_o && (model_.left_error_o || model_.right_error_o)) stray = true;
    };
    const RasterResult result = run_raster<Model>(
        model_, raster, static_cast<int>(views.size()),
        [&](int frame, int x, int y) {
          model_.left_i = views[frame].left(y, x);
          model_.right_i = views[frame].right(y, x);
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
          if (x == size.width - 1 && y == size.height - 1) whole = frame + 1;
        });
    EXPECT_EQ(result.latency_ticks, start + kLatencyTicks);
    EXPECT_FALSE(stray) << "an error outside every frame";
    return out;
  }

  /// Every pixel as in software, but where an error is due; errors exactly there.
  void expect(const Meshes& meshes, const std::vector<Views>& views,
              const std::vector<Rectified>& out, std::int64_t start, const std::string& about) {
    const cv::Mat1b left_lacking = lacking(meshes.left, start, usable_rows_);
    const cv::Mat1b right_lacking = lacking(meshes.right, start, usable_rows_);
    for (std::size_t k = 0; k < views.size(); ++k) {
      Case c;
      std::ostringstream text;
      text << about << ", " << meshes.size() << ", T_s " << start << ", frame " << k;
      c.about = text.str();
      const auto compare = [&](const Mesh& mesh, const cv::Mat1b& raw, const cv::Mat1b& without,
                               const cv::Mat1b& got, const cv::Mat1b& error) {
        cv::Mat expected;
        rectify(raw, mesh, cv::Range::all(), expected);
        got.copyTo(expected, without);
        EXPECT_TRUE(same("rectify", expected, got, c));
        EXPECT_TRUE(same("rectify error", without, error, c));
      };
      compare(meshes.left, views[k].left, left_lacking, out[k].left, out[k].left_error);
      compare(meshes.right, views[k].right, right_lacking, out[k].right, out[k].right_error);
    }
  }

  /// Load, run, expect.
  void check(const Meshes& meshes, const Raster& raster, int frames, std::int64_t start,
             const std::string& about) {
    load(meshes);
    const std::vector<Views> views = random_views(meshes.size(), frames, raster.seed * 100);
    expect(meshes, views, run(raster, views, start), start, about);
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

struct Large : Bench<Rectify640x102> {
  Large() : Bench(102) {}
};
/// 80 nodes, and so few rows that every mesh finds the ends of the buffer.
struct Small : Bench<Rectify80x10> {
  Small() : Bench(10) {}
};

Raster bubbles(std::vector<int> rows, double stalled, unsigned seed) {
  Raster raster;
  raster.bubble_rows = std::move(rows);
  raster.stalled = stalled;
  raster.seed = seed;
  return raster;
}

const std::vector<cv::Size> kSizes = {{16, 1},  {16, 5},  {17, 9}, {33, 20},
                                      {64, 48}, {75, 50}, {23, 3}, {24, 17}};

// Up to 50 rows any mesh fits: T_s is at most the image, and so is the oldest pixel's distance.
TEST(RtlRectify, EveryMeshAtEverySize) {
  Large bench;
  unsigned seed = 0;
  for (const cv::Size size : kSizes) {
    const std::vector<std::pair<std::string, Meshes>> all = {
        {"zero", {moved(size, 0, 0), moved(size, 0, 0)}},
        {"shift", {moved(size, 3, -2), moved(size, -7.5, 4.25)}},
        {"smooth", {smooth(size, 6, ++seed), smooth(size, 9, ++seed)}},
        {"rough", {rough(size, 700, 700, ++seed), rough(size, 3000, 3000, ++seed)}},
        {"any", {rough(size, 32767, 32767, ++seed), rough(size, 32767, 32767, ++seed)}},
        {"along", {rough(size, 32767, 0, ++seed), rough(size, 0, 32767, ++seed)}},
        {"extreme", {moved(size, 1000, 1000), moved(size, -1000, -1000)}}};
    for (const auto& [name, meshes] : all) {
      const std::int64_t start = read_start(meshes);
      ++seed;
      const Raster raster = bubbles({1, 0, 3}, seed % 2 != 0 ? 0.3 : 0, seed);
      bench.check(meshes, raster, 3, start, name);
      for (const Mesh* mesh : {&meshes.left, &meshes.right}) {
        EXPECT_EQ(cv::countNonZero(lacking(*mesh, start, bench.usable_rows())), 0);
      }
      if (HasFailure()) return;
    }
  }
}

TEST(RtlRectify, ExtremeImages) {
  Large bench;
  const cv::Size size(75, 50);
  const Meshes meshes = {smooth(size, 5, 1), smooth(size, 5, 2)};
  const std::int64_t start = read_start(meshes);
  bench.load(meshes);
  std::vector<Views> views;
  for (const NamedImage& named : extreme_images(size, 3))
    views.push_back({named.image, named.image});
  cv::Mat1b bright(size, std::uint8_t{0});
  bright(20, 30) = 255;
  views.push_back({bright, 255 - bright});
  bench.expect(meshes, views, bench.run(bubbles({0}, 0, 4), views, start), start, "extreme images");
}

/// A lens with distortion, and turned by `roll` against the rectified image.
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

Meshes calibrated(cv::Size size, double roll) {
  const auto make = [&](double turn, double k1, const char* name) {
    const ExactMap map = exact_map(turned_camera(size, turn, k1));
    const auto made = make_rectification(map, size, size, name);
    if (!made) throw std::runtime_error(made.error().message);
    return made->mesh;
  };
  return {make(roll, -0.3, "left"), make(-roll, -0.25, "right")};
}

// What a host would send; the second size uses every part of the mesh memory.
TEST(RtlRectify, Calibrated) {
  Large bench;
  for (const auto& [size, roll] : {std::pair(cv::Size(320, 200), 0.07), {{640, 480}, 0.03}}) {
    const Meshes meshes = calibrated(size, roll);
    const std::int64_t start = read_start(meshes);
    for (const Mesh* mesh : {&meshes.left, &meshes.right}) {
      EXPECT_GT(line_buffer_need(*mesh, size).rows, 20);
      EXPECT_EQ(cv::countNonZero(lacking(*mesh, start, bench.usable_rows())), 0);
    }
    bench.check(meshes, bubbles({2, 0}, 0, 5), size.width > 320 ? 1 : 3, start, "calibrated");
  }
}

// 32767 units are 256 px, which is one bit more than -256 px; most of these taps lie outside.
TEST(RtlRectify, WidestDisplacements) {
  Large bench;
  for (const double far : {1000.0, -1000.0}) {
    const cv::Size wide(300, 10), tall(16, 300);
    const Meshes along = {moved(wide, far, 0), moved(wide, far, 0)};
    bench.check(along, bubbles({0}, 0, 13), 2, read_start(along), "along");
    const Meshes down = {moved(tall, 0, far), moved(tall, far, far)};
    bench.check(down, bubbles({0}, 0, 14), 2, std::int64_t{100} * tall.width, "down");
  }
}

TEST(RtlRectify, IdentityBeforeAnyMeshIsWritten) {
  Large bench;
  const cv::Size size(40, 20);
  const Meshes zero = {moved(size, 0, 0), moved(size, 0, 0)};
  const std::vector<Views> views = random_views(size, 2, 7);
  for (int bank = 0; bank < 2; ++bank) {
    const auto out = bench.run(bubbles({0}, 0, 8), views, size.width + 2);
    bench.expect(zero, views, out, size.width + 2, "not written");
    bench.swap();
  }
}

// From T_s = 0: nothing at or behind the pixel itself.
TEST(RtlRectify, LatencyIsReadStartAndAConstant) {
  Large bench;
  for (const cv::Size size : {cv::Size(16, 30), {37, 30}}) {
    const int w = size.width;
    const Meshes meshes = {moved(size, 0, -6), moved(size, -2, -9)};
    for (const int start : {0, 1, 2, w - 1, w, w + 1, 7 * w + 13, 8 * w, 90 * w + 5}) {
      bench.check(meshes, bubbles({0, 0, 1}, 0, 9), 3, start, "up");
    }
  }
}

// Many frames are inside at once, of one row and more, without a gap and with.
TEST(RtlRectify, TinyFramesInFlight) {
  Large bench;
  for (const cv::Size size : {cv::Size(16, 1), {17, 1}, {21, 2}, {16, 3}, {16, 7}}) {
    const Meshes meshes = {rough(size, 500, 300, 10), rough(size, 500, 300, 11)};
    for (const std::int64_t start : {read_start(meshes), std::int64_t{98} * size.width + 9}) {
      const Raster raster = bubbles({0, 0, 0, 1, 0, 5, 0}, 0.1, 12);
      bench.check(meshes, raster, 130, start, "tiny");
    }
  }
}

// Reads at both ends of a ring of 10 rows: exact errors, and no wrong pixel without one.
TEST(RtlRectify, ErrorsAreExact) {
  Small bench;
  unsigned seed = 20;
  for (const cv::Size size : {cv::Size(16, 40), {17, 31}, {24, 30}, {75, 40}, {16, 5}, {16, 1}}) {
    const int w = size.width;
    for (const int start : {0, 3, w + 2, 2 * w - 1, 4 * w, 5 * w + 7, 9 * w, 10 * w + 3}) {
      const int down = 128 * ((start / w) - 5);
      Meshes meshes = {rough(size, 2000, 800, ++seed), rough(size, 300, 500, ++seed)};
      for (cv::Vec2s& node : meshes.left.nodes) node[1] = static_cast<short>(node[1] + down);
      for (cv::Vec2s& node : meshes.right.nodes) node[1] = static_cast<short>(node[1] + down);
      bench.check(meshes, bubbles({0, 0, 1}, seed % 4 ? 0 : 0.2, seed), 3, start, "rough");
      if (HasFailure()) return;
    }
  }
}

// Whole-pixel shifts to the first and the last pixel of the ring, and one beyond.
TEST(RtlRectify, EndsOfTheRing) {
  Small bench;
  for (const int w : {16, 17}) {
    const cv::Size size(w, 30);
    for (const int start : {w + 2, 3 * w, 4 * w + 9}) {
      const int oldest = start - bench.usable_rows() * w;
      for (const int distance : {oldest - 1, oldest, oldest + 1}) {
        const int y = static_cast<int>(std::floor((distance + 8.0) / w));
        const Meshes meshes = {moved(size, distance - y * w, y), moved(size, 0, 0)};
        bench.check(meshes, bubbles({0}, 0, 30), 2, start, "oldest");
        const bool lacks = cv::countNonZero(lacking(meshes.left, start, bench.usable_rows())) > 0;
        EXPECT_TRUE(lacks || distance >= oldest) << size << start;
      }
      // The lower right one of the four is the newest.
      for (const int distance : {start - 1, start}) {
        const int tap = distance - w - 1;
        const int y = static_cast<int>(std::floor((tap + 8.0) / w));
        const Meshes meshes = {moved(size, tap - y * w, y), moved(size, 0, -3)};
        bench.check(meshes, bubbles({0}, 0, 31), 2, start, "newest");
        const bool lacks = cv::countNonZero(lacking(meshes.left, start, bench.usable_rows())) > 0;
        EXPECT_EQ(lacks, distance == start) << size << start;
      }
    }
  }
}

// A host that goes by line_buffer_need() gets no error; one that sends T_s one too small, or a map
// that needs one row more, does.
TEST(RtlRectify, BufferNeedIsTheLimit) {
  Small bench;
  const auto errors = [&](const Mesh& mesh, std::int64_t start) {
    const Meshes meshes = {mesh, moved(mesh.size, 0, 0)};
    bench.load(meshes);
    const std::vector<Views> views = random_views(mesh.size, 1, 40);
    return cv::countNonZero(bench.run(bubbles({0}, 0, 41), views, start)[0].left_error);
  };
  int fits = 0, refused = 0;
  for (unsigned seed = 50; seed < 80; ++seed) {
    const cv::Size size(seed % 2 ? 16 : 33, 30);
    const Mesh mesh = smooth(size, 2 + 0.5 * (seed - 50), seed);
    const LineBufferNeed need = line_buffer_need(mesh, size);
    const bool ok = static_cast<bool>(check_line_buffer(need, bench.usable_rows(), "left"));
    ++(ok ? fits : refused);
    EXPECT_EQ(errors(mesh, need.read_start) == 0, ok) << "seed " << seed;
    EXPECT_TRUE(!ok || errors(mesh, need.read_start - 1) > 0) << "seed " << seed;
  }
  EXPECT_GT(fits, 5);
  EXPECT_GT(refused, 5);
}

// 11 x 8 nodes do not go into 80: rows 48 and below lack some.
TEST(RtlRectify, MeshLargerThanItsMemory) {
  Small bench;
  const cv::Size size(75, 50);
  bench.load({moved(size, 0, 0), moved(size, 0, 0)});
  const auto out = bench.run(bubbles({0}, 0, 60), random_views(size, 2, 61), size.width + 2);
  cv::Mat1b expected(size, std::uint8_t{0});
  expected.rowRange(48, 50) = 1;
  for (const Rectified& frame : out) {
    EXPECT_TRUE(same("left error", expected, frame.left_error));
    EXPECT_TRUE(same("right error", expected, frame.right_error));
  }
}

// New meshes are written while frames run and the clock stalls, and used after those are out.
TEST(RtlRectify, MeshesAreSwappedBetweenFrames) {
  Large bench;
  const cv::Size size(75, 50);
  const Meshes first = {smooth(size, 6, 70), smooth(size, 6, 71)};
  const Meshes second = {smooth(size, 5, 72), rough(size, 900, 900, 73)};
  const std::int64_t start = std::max(read_start(first), read_start(second));
  const std::vector<Views> views = random_views(size, 6, 74);
  bench.load(first);
  bench.queue(second);
  bool swapped = false;
  const auto out = bench.run(bubbles({0, 0, 0, 60, 0}, 0.2, 75), views, start, [&](int whole) {
    if (whole < 3 || swapped) return;
    EXPECT_TRUE(bench.queue_empty());
    swapped = true;
    bench.swap();
    bench.queue(first);  // and again, below the second meshes' frames
  });
  const auto part = [](const auto& all, int from) {
    return std::decay_t<decltype(all)>(all.begin() + from, all.begin() + from + 3);
  };
  bench.expect(first, part(views, 0), part(out, 0), start, "first");
  bench.expect(second, part(views, 3), part(out, 3), start, "second");
}

// Also in the middle of a frame with errors: none of those may come out after the reset.
TEST(RtlRectify, ResetAtAnyMoment) {
  Large bench;
  const cv::Size size(33, 20);
  const Meshes meshes = {smooth(size, 4, 80), rough(size, 600, 600, 81)};
  for (int after = 5; after < 1700; after += 113) {
    for (const std::int64_t start : {read_start(meshes), read_start(meshes) / 2}) {
      Raster raster = bubbles({1, 0}, 0.1, 82 + after);
      raster.reset_after_ticks = after;
      bench.check(meshes, raster, 2, start, "after a reset");
    }
  }
}

// Size, T_s and mesh change without a reset, between frames.
TEST(RtlRectify, SettingsChangeWithoutReset) {
  Large bench;
  auto& model = bench.model();
  model.rst_ni = 0;
  bench.clock();
  model.rst_ni = 1;
  unsigned seed = 90;
  for (const cv::Size size : {cv::Size(33, 21), {64, 30}, {17, 9}, {75, 50}, {16, 40}}) {
    const Meshes meshes = {smooth(size, 4, ++seed), smooth(size, 5, ++seed)};
    const std::int64_t start = read_start(meshes);
    bench.load(meshes);
    bench.set(size, start);
    const Views views = random_views(size, 1, ++seed)[0];
    Rectified out = {cv::Mat1b(size), cv::Mat1b(size), cv::Mat1b(size), cv::Mat1b(size)};
    model.en_i = 1;
    int at = 0;
    const int first = 3, rows = first + size.height + static_cast<int>(start) / size.width + 6;
    for (int y = -first; y < rows; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const bool inside = y >= 0 && y < size.height;
        model.valid_i = inside;
        model.sof_i = x == 0 && y == 0;
        model.sol_i = x == 0;
        model.left_i = inside ? views.left(y, x) : 99;
        model.right_i = inside ? views.right(y, x) : 99;
        bench.clock();
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
    bench.expect(meshes, {views}, {out}, start, "new settings");
  }
}

}  // namespace
}  // namespace fpga_stereo::test
