// Test fixture of board and virtual_board, which talk to each other over a pseudo terminal.
#pragma once

#include <memory>

#include "programs.hpp"
#include "support/child.hpp"

namespace fpga_stereo::tools {

class BoardTest : public ProgramTest {
 protected:
  using Strings = std::vector<std::string>;

  static constexpr int kPairs = 3;
  static const cv::Size kSize;

  BoardTest();

  /// Starts a virtual board with small images and cameras at 40 f/s, and waits until it is ready.
  /// `options` override the defaults.
  void start(const Strings& options = {});
  /// Stops the board with SIGINT. Returns its exit code.
  int stop();
  /// Returns what the board printed to stderr.
  std::string statistics() const { return bytes(at("board_err")); }
  Child& child() { return *child_; }

  /// Runs board MODE with the virtual board.
  Outcome board(const std::string& mode, const Strings& arguments = {}) const;
  /// Runs board without a virtual board.
  Outcome board_alone(const Strings& arguments) const { return run(FPGA_STEREO_BOARD, arguments); }
  /// Returns the options that upload and match share.
  Strings settings() const;
  /// Runs board upload with settings(); it must succeed.
  void upload() const;

  /// Returns the PNG file that match writes for camera pair `i`.
  const std::string& matched(int i);
  /// Expects that every captured disparity equals the output of match for its pair. The frame id
  /// identifies the pair; with `any_pair`, for a board that was reset, it may be any pair. Returns
  /// the number of compared disparities.
  int expect_matched(const std::string& folder, bool any_pair = false);

  std::string device() const { return "serial:" + at("tty"); }
  static Strings with(Strings some, const Strings& more);

  std::vector<NoisePair> pairs_;

 private:
  std::vector<std::string> matched_;
  std::unique_ptr<Child> child_;
};

}  // namespace fpga_stereo::tools
