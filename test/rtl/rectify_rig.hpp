// Drives fs_rectify with raw pairs and meshes and compares it with rectify(), including the limits
// of its line buffer.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "raster.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {

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

inline std::vector<Images> random_pairs(cv::Size size, int count, unsigned seed) {
  std::vector<Images> pairs(count);
  for (Images& pair : pairs) {
    pair.left = random_image(size, ++seed);
    pair.right = random_image(size, ++seed);
  }
  return pairs;
}

/// Returns a mesh that shifts the image by (x, y) px.
inline Mesh shift_mesh(cv::Size size, double x, double y) {
  Mesh mesh = Mesh::shift(size, 0);
  mesh.nodes =
      cv::Vec2s(cv::saturate_cast<short>(kMeshScale * x), cv::saturate_cast<short>(kMeshScale * y));
  return mesh;
}

/// Returns a mesh of independent random nodes, up to max_x / 128 px and max_y / 128 px.
inline Mesh random_mesh(cv::Size size, int max_x, int max_y, unsigned seed) {
  Mesh mesh = Mesh::shift(size, 0);
  cv::RNG random(seed);
  for (cv::Vec2s& node : mesh.nodes) {
    node = {cv::saturate_cast<short>(random.uniform(-max_x - 1, max_x + 1)),
            cv::saturate_cast<short>(random.uniform(-max_y - 1, max_y + 1))};
  }
  return mesh;
}

/// Returns a mesh with smooth waves of up to `max_px` px.
inline Mesh wave_mesh(cv::Size size, double max_px, unsigned seed) {
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
inline std::int64_t common_read_start(const Meshes& meshes) {
  return std::max(line_buffer_need(meshes.left, meshes.size()).read_start,
                  line_buffer_need(meshes.right, meshes.size()).read_start);
}

/// Returns 1 for each pixel that needs a raw pixel which a line buffer of `rows` rows does not hold
/// `read_start` ticks after the raw pixel at the same position arrived.
inline cv::Mat1b buffer_error_mask(const Mesh& mesh, std::int64_t read_start, int rows) {
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

/// Runs a model, and writes meshes while the clock runs.
template <class Model>
class RectifyRig {
 public:
  explicit RectifyRig(int line_rows) : usable_rows_(line_rows - 1) {
    model_.rst_ni = 1;
    model_.en_i = 0;
    model_.mesh_we_i = 0;
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

  /// Writes `meshes`; no frame may be in flight.
  void load(const Meshes& meshes) {
    queue(meshes);
    model_.en_i = 0;
    while (!writes_.empty()) {
      drive_next_write();
      clock();
    }
    model_.mesh_we_i = 0;
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

inline Raster make_raster(std::vector<int> rows, double stall_chance, unsigned seed) {
  Raster raster;
  raster.bubble_rows = std::move(rows);
  raster.stall_chance = stall_chance;
  raster.seed = seed;
  return raster;
}

}  // namespace fpga_stereo::test
