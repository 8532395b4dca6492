// Drives one stage of the gateware with frames on a raster (defined in fpga_fw/rtl/fs_top.sv) and
// collects the frames that the stage puts out.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace fpga_stereo::test {

/// Size and timing of the frames on the raster.
struct Raster {
  int width = 0, height = 0;
  std::vector<int> bubble_rows = {0};  // before each frame; the last entry repeats
  double stall_chance = 0;             // probability that a clock is no tick
  unsigned seed = 1;
  int reset_after_ticks = -1;  // resets once after this many ticks, then sends all frames again
};

/// Measurements at the outputs.
struct RasterResult {
  std::int64_t latency_ticks = -1;  // first pixel in to first pixel out
  int frames = 0;                   // complete frames
  std::int64_t clocks = 0, ticks = 0;
};

/// Sends `frames` frames through `model`, which has the ports clk_i, rst_ni, en_i and the tags
/// valid, sof, sol as inputs and outputs. `drive(frame, x, y)` sets the data inputs for a pixel;
/// `drive_bubble(random)` sets them for a bubble. `collect(frame, x, y)` reads the data outputs of
/// a pixel. Fails the test unless all frames come out complete, once and in order.
template <class Model>
RasterResult run_raster(Model& model, const Raster& raster, int frames,
                        const std::function<void(int, int, int)>& drive,
                        const std::function<void(std::mt19937&)>& drive_bubble,
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

  int frame = 0, row = -1, x = 0;  // at the input; row -1 is a row of bubbles
  int bubbles_left = raster.bubble_rows[0];
  int out_frame = -1, out_x = 0, out_y = 0;
  int since_sol_out = -1;
  std::int64_t first_in = -1, idle_rows = 0;
  bool has_restarted = false;
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

  // Runs until every frame is out, and three rows longer to check that nothing follows.
  int rows_after_last = 0;
  while (rows_after_last < 3) {
    if (idle_rows > 400 || ::testing::Test::HasFailure()) break;
    if (!has_restarted && result.ticks == raster.reset_after_ticks) {
      has_restarted = true;
      frame = 0, row = -1, x = 0, bubbles_left = raster.bubble_rows[0];
      out_frame = -1, out_x = out_y = 0, since_sol_out = -1, first_in = -1;
      result.latency_ticks = -1, result.frames = 0;
      reset();
      start_row();
    }
    model.en_i = std::uniform_real_distribution<>()(random) >= raster.stall_chance ? 1 : 0;
    model.valid_i = row >= 0 ? 1 : 0;
    model.sof_i = row == 0 && x == 0 ? 1 : 0;
    model.sol_i = x == 0 ? 1 : 0;
    if (row >= 0) {
      drive(frame, x, row);
    } else {
      drive_bubble(random);
    }
    model.clk_i = 0;
    model.eval();

    if (model.en_i) {
      if (model.sof_i && first_in < 0) first_in = result.ticks;
      // This tick samples the present outputs.
      if (since_sol_out >= 0) ++since_sol_out;
      if (model.sol_o) {
        EXPECT_TRUE(since_sol_out < 0 || since_sol_out == raster.width)
            << "sol " << since_sol_out << " ticks after the previous sol";
        since_sol_out = 0;
        if (result.frames == frames) ++rows_after_last;
      }
      if (model.valid_o) {
        if (model.sof_o) {
          EXPECT_TRUE(model.sol_o) << "sof without sol";
          EXPECT_TRUE(out_frame < 0 || out_y == raster.height) << "frame ends after row " << out_y;
          if (result.latency_ticks < 0) result.latency_ticks = result.ticks - first_in;
          ++out_frame;
          out_x = out_y = 0;
        }
        if (out_frame < 0 || out_frame >= frames || out_y >= raster.height) {
          ADD_FAILURE() << "pixel outside every frame, after frame " << out_frame;
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
  EXPECT_EQ(result.frames, frames) << "complete frames";
  return result;
}

}  // namespace fpga_stereo::test
