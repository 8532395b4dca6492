// For tests of board and virtual_board: they run against each other over a pseudo terminal.
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

  /// Starts a small board with cameras at 40 f/s; `options` come last. Waits until it is ready.
  void start(const Strings& options = {});
  /// Ends it by SIGINT: its exit code. What it said on stderr is in statistics().
  int stop();
  std::string statistics() const { return bytes(at("board_err")); }
  Child& child() { return *child_; }

  /// board MODE on it.
  Outcome board(const std::string& mode, const Strings& arguments = {}) const;
  /// board MODE on nothing.
  Outcome board_alone(const Strings& arguments) const { return run(FPGA_STEREO_BOARD, arguments); }
  /// What upload and match are told.
  Strings settings() const;
  /// upload with settings(), which must succeed.
  void upload() const;

  /// The disparity that match writes for camera pair `i`: the bytes of its PNG.
  const std::string& matched(int i);
  /// Every disparity of a capture must be what match wrote for its pair: by its number, or, where
  /// the board was reset and counts anew, for any pair. How many were compared.
  int expect_matched(const std::string& folder, bool any_pair = false);

  std::string device() const { return "serial:" + at("tty"); }
  static Strings with(Strings some, const Strings& more);

  std::vector<NoisePair> pairs_;

 private:
  std::vector<std::string> matched_;
  std::unique_ptr<Child> child_;
};

}  // namespace fpga_stereo::tools
