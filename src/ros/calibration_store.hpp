// The calibration of a pair of cameras, kept in two files.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/result.hpp"
#include "ros/calibration_url.hpp"
#include "ros/demand.hpp"

namespace fpga_stereo {

/// A new calibration takes effect as a pair: the side that comes first waits for the other one.
/// Then both are checked as the node checks them, and both files are replaced, or neither.
/// Thread-safe. Its locks, in this order: io_mutex_, mutex_.
class CalibrationStore {
 public:
  /// `prefix` is that of the cameras' names, see calibration_prefix(). An empty URL means
  /// file://${ROS_HOME}/camera_info/${NAME}.yaml.
  CalibrationStore(std::string prefix, CalibrationUrls urls);

  /// Reads both files, and forgets a side that waits for the other one. Returns what is wrong with
  /// them, for the log; a camera without a usable file is not calibrated.
  std::vector<Error> load() FPGA_STEREO_EXCLUDES(io_mutex_, mutex_);
  /// Takes the new calibration of one side, for images of `image_size`. Returns what was done with
  /// it, for people. An error names the field or the file; then the present calibration stays. If
  /// the two sides do not fit each other, both must come again.
  Result<std::string> set(Side side, const CameraCalibration& camera, cv::Size image_size)
      FPGA_STEREO_EXCLUDES(io_mutex_, mutex_);
  /// Returns the present calibration. All is 0 for a camera that is not calibrated.
  StereoCalibration calibration() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  using Paths = std::array<std::string, 2>;  // left, right

  std::string camera_name(std::size_t side) const;
  Result<std::string> path(std::size_t side) const;
  Status save(const StereoCalibration& pair) const;
  /// Completes what a crash between the renaming of the two files has interrupted.
  void complete_save() const;

  const std::string prefix_;
  const std::array<std::string, 2> urls_;

  Mutex io_mutex_ FPGA_STEREO_ACQUIRED_BEFORE(mutex_);  // held while files are read or written
  std::array<std::optional<CameraCalibration>, 2> waiting_ FPGA_STEREO_GUARDED_BY(io_mutex_);

  mutable Mutex mutex_;
  StereoCalibration calibration_ FPGA_STEREO_GUARDED_BY(mutex_);
};

}  // namespace fpga_stereo
