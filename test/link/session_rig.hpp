// A session and a virtual board with a link between them, in simulated time.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "core/reference_pipeline.hpp"
#include "link/session.hpp"
#include "sim/virtual_board/software_board.hpp"

namespace fpga_stereo::test {

class SessionRig {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Milliseconds = std::chrono::milliseconds;

  explicit SessionRig(const sim::SoftwareBoard::Options& options = small_board());

  /// Options of a board that computes fast: 64 px wide, 16 disparities, small windows.
  static sim::SoftwareBoard::Options small_board();
  /// Parameters and rectification for a small board.
  struct Setting {
    Parameters parameters = window_parameters();
    StereoRectification rectification;
  };
  /// Returns a setting whose parameters and meshes depend on `seed`.
  static Setting setting(unsigned seed, cv::Size size = {64, 24});
  /// Returns a random pair with a constant disparity of 5 px.
  static sim::GreyPair pair(unsigned seed, cv::Size size = {64, 24});
  /// Returns the disparities that the reference pipeline computes.
  static cv::Mat1w expected(const sim::GreyPair& pair, const Setting& setting);

  /// Returns the desired state with this setting, tag and streams.
  link::DesiredState wanted(const Setting& setting, std::uint64_t tag,
                            link::StreamSet streams) const;

  /// Lets time pass in steps of 1 ms. The cameras deliver a pair every `frame_ms`, if `pairs` has
  /// any.
  void run(int ms);
  /// Runs until `done` returns true, at most `ms`. Returns what `done` returned last.
  bool run_until(const std::function<bool()>& done, int ms = 5000);

  sim::SoftwareBoard board;
  link::Session session;
  std::vector<sim::GreyPair> pairs;  // that the cameras see, in turn
  int frame_ms = 20;
  std::size_t bytes_per_ms = 1 << 20;             // that the transport accepts from the host
  bool line_open = true;                          // false: no byte passes in either direction
  std::function<void(Bytes&)> to_host, to_board;  // change the bytes on their way
  std::vector<link::ReceivedFrames> received;
  std::vector<std::string> notes;
  std::vector<link::WatchdogStep> steps;
  link::Session::Time now{std::chrono::seconds(1000)};
  double host = 5000;  // s

 private:
  int ms_ = 0;
  Bytes waiting_;  // waits for the transport
  std::size_t next_pair_ = 0;
};

}  // namespace fpga_stereo::test
