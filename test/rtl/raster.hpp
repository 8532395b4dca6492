// Drives one stage of the gateware with frames on a raster (fpga_fw/rtl/fs_top.sv) and collects the
// frames that come out of it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace fpga_stereo::test {

/// How frames are put on the raster.
struct Raster {
  int width = 0, height = 0;
  std::vector<int> bubble_rows = {0};  // before each frame; the last entry is used again
  double stalled = 0;                  // share of the clocks without a tick
  unsigned seed = 1;
  int reset_after_ticks = -1;  // then reset, and all frames are sent from the start
  int ticks_at_most = 0;       // 0: enough for any stage
};

/// What was seen of the outputs.
struct RasterResult {
  std::int64_t latency_ticks = -1;  // first pixel in to first pixel out
  int frames = 0;                   // that came out whole
  std::int64_t clocks = 0, ticks = 0;
};

/// Sends `frames` frames through `model`, whose ports are clk_i, rst_ni, en_i and the tags
/// valid, sof, sol, in and out. `drive(frame, x, y)` sets the data inputs for a pixel;
/// `rubbish(random)` sets them for a bubble. `collect(frame, x, y)` reads the data outputs of a
/// pixel. Fails where what comes out is no raster of whole frames, each once and in order.
template <class Model>
RasterResult run_raster(Model& model, const Raster& raster, int frames,
                        const std::function<void(int, int, int)>& drive,
                        const std::function<void(std::mt19937&)>& rubbish,
                        const std::function<void(int, int, int)>& collect) {
  std::mt19937 random(raster.seed);
  RasterResult result;
  const auto clock = [&] {
    model.clk_i = 0;
    model.eval();
    model.clk_i = 1;
    model.eval();
    ++result.clocks;
  };
  const auto reset = [&] {
    model.rst_ni = 0;
    model.en_i = 1;
    model.valid_i = model.sof_i = model.sol_i = 0;
    for (int i = 0; i < 4; ++i) clock();
    model.rst_ni = 1;
  };
  reset();

  int frame = 0, row = -1, x = 0;  // going in; row -1: bubbles
  int bubbles_left = raster.bubble_rows[0];
  int out_frame = -1, out_x = 0, out_y = 0;
  int since_sol_out = -1;
  std::int64_t first_in = -1, idle_rows = 0;
  bool restarted = false;
  const auto start_row = [&] {
    if (row >= 0 && ++row == raster.height) {
      row = -1;
      ++frame;
      const auto next = std::min<std::size_t>(frame, raster.bubble_rows.size() - 1);
      bubbles_left = raster.bubble_rows[next];
    }
    if (row < 0 && frame < frames && bubbles_left-- == 0) row = 0;
    if (row < 0 && frame >= frames) ++idle_rows;
  };
  start_row();

  // Until every frame is out, and some rows more to see that nothing follows.
  int rows_after_last = 0;
  while (rows_after_last < 3) {
    if (idle_rows > 400 || ::testing::Test::HasFailure()) break;
    if (!restarted && result.ticks == raster.reset_after_ticks) {
      restarted = true;
      frame = 0, row = -1, x = 0, bubbles_left = raster.bubble_rows[0];
      out_frame = -1, out_x = out_y = 0, since_sol_out = -1, first_in = -1;
      result.latency_ticks = -1, result.frames = 0;
      reset();
      start_row();
    }
    model.en_i = std::uniform_real_distribution<>()(random) >= raster.stalled ? 1 : 0;
    model.valid_i = row >= 0 ? 1 : 0;
    model.sof_i = row == 0 && x == 0 ? 1 : 0;
    model.sol_i = x == 0 ? 1 : 0;
    if (row >= 0) {
      drive(frame, x, row);
    } else {
      rubbish(random);
    }
    model.clk_i = 0;
    model.eval();

    if (model.en_i) {
      if (model.sof_i && first_in < 0) first_in = result.ticks;
      // What is there now is sampled by this tick.
      if (since_sol_out >= 0) ++since_sol_out;
      if (model.sol_o) {
        EXPECT_TRUE(since_sol_out < 0 || since_sol_out == raster.width)
            << "sol after " << since_sol_out << " ticks";
        since_sol_out = 0;
        if (result.frames == frames) ++rows_after_last;
      }
      if (model.valid_o) {
        if (model.sof_o) {
          EXPECT_TRUE(model.sol_o) << "sof without sol";
          EXPECT_TRUE(out_frame < 0 || out_y == raster.height) << "frame cut at row " << out_y;
          if (result.latency_ticks < 0) result.latency_ticks = result.ticks - first_in;
          ++out_frame;
          out_x = out_y = 0;
        }
        if (out_frame < 0 || out_frame >= frames || out_y >= raster.height) {
          ADD_FAILURE() << "a pixel outside every frame, after frame " << out_frame;
          break;
        }
        collect(out_frame, out_x, out_y);
        if (++out_x == raster.width) {
          out_x = 0;
          if (++out_y == raster.height) ++result.frames;
        }
      } else {
        EXPECT_FALSE(model.sof_o) << "sof without valid";
      }
      ++result.ticks;
      if (++x == raster.width) {
        x = 0;
        start_row();
      }
    }
    model.clk_i = 1;
    model.eval();
    ++result.clocks;
  }
  EXPECT_EQ(result.frames, frames) << "frames that came out whole";
  return result;
}

}  // namespace fpga_stereo::test
