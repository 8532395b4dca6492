// A session and a board of software with a line between them, in simulated time.
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

  /// A build that is quick: 64 px wide, 16 disparities, small windows.
  static sim::SoftwareBoard::Options small_board();
  /// What a small board can be configured with; `seed` decides on the mesh and the settings.
  struct Setting {
    Parameters parameters;
    StereoRectification rectification;
  };
  static Setting setting(unsigned seed, cv::Size size = {64, 24});
  static sim::GreyPair pair(unsigned seed, cv::Size size = {64, 24});
  /// What the software pipeline makes of it.
  static cv::Mat1w expected(const sim::GreyPair& pair, const Setting& setting);

  /// That setting with this tag, these streams.
  link::DesiredState wanted(const Setting& setting, std::uint64_t tag,
                            link::StreamSet streams) const;

  /// Lets time pass, a ms at a time. The cameras deliver a pair each `frame_ms`, if any are set.
  void run(int ms);
  /// Until `done`, at most `ms`. False: it did not come.
  bool run_until(const std::function<bool()>& done, int ms = 5000);

  sim::SoftwareBoard board;
  link::Session session;
  std::vector<sim::GreyPair> pairs;  // what the cameras see, in turns
  int frame_ms = 20;
  std::size_t bytes_per_ms = 1 << 20;             // that the line takes from the host
  bool line_open = true;                          // false: nothing passes either way
  std::function<void(Bytes&)> to_host, to_board;  // faults
  std::vector<link::ReceivedFrames> received;
  std::vector<std::string> notes;
  std::vector<link::WatchdogStep> steps;
  link::Session::Time now{std::chrono::seconds(1000)};
  double host = 5000;  // s

 private:
  int ms_ = 0;
  Bytes waiting_;  // for the line
  std::size_t next_pair_ = 0;
};

}  // namespace fpga_stereo::test
