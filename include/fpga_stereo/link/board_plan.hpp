// Plans what a board does: which configuration it gets and which streams it sends. The plan follows
// from the board's build, the parameters, the calibration and what the host wants.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/rectification_cache.hpp"
#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::link {

/// The images that the host wants of every pair.
struct BoardDemand {
  bool disparity = false;
  // Rectified images; the right one not shifted by min_disparity.
  bool rectified_left = false, rectified_right = false;
  bool raw_left = false, raw_right = false;
  bool stamps = false;  // at least one image of every pair, whichever

  /// Needs both raw images if the board does not make the disparity: the software computes instead.
  bool wants_outputs() const { return disparity || rectified_left || rectified_right; }
};

/// What a connected board can do under the present parameters and calibration.
enum class BoardAbility {
  kNoBoard,           // no board is connected
  kNeedsCalibration,  // the board waits for the calibration of the host's pairs
  kMakesDisparity,
  kSendsRawImages,  // of its cameras; the software has to make the disparity
  kNothing,         // the images are too large for the board
};

/// What one configuration of the board was made from. Frames of that configuration need it.
struct PlannedConfiguration {
  Parameters parameters;
  StereoCalibration calibration;
  std::shared_ptr<const StereoRectification>
      rectification;    // null: the board sends raw images only
  cv::Size image_size;  // px, of all images
};

/// Not thread-safe. Use: pass every change to the setters, then desired_state() to
/// Device::set_desired_state().
class BoardPlan {
 public:
  struct Options {
    bool host_input = false;        // pairs come from the host, not from the board's cameras
    cv::Size image_size{640, 480};  // px, of cameras without calibration
    int frame_interval = 1;         // the board sends every n-th pair of its cameras
    int verify_interval = 0;        // raw images of every n-th sent pair, for verification; 0: none
    std::chrono::microseconds mid_exposure{0};  // from mid-exposure to the first pixel
  };

  explicit BoardPlan(const Options& options) : options_(options) {}

  /// Sets the connected board, or nullopt when it has gone.
  void set_identity(const std::optional<Identity>& identity);
  /// Sets the parameters. Unless `is_algorithm_chosen`, stereo_algorithm is only a default: while a
  /// board is connected, its build decides.
  void set_parameters(const Parameters& parameters, bool is_algorithm_chosen = true);
  void set_calibration(const StereoCalibration& calibration);
  /// Sets the calibration of the board's own cameras if it differs from the present one; returns
  /// whether it does. Refuses a calibration that cannot be rectified while the present one can:
  /// left and right arrive one after the other, and until both agree the old pair stays valid.
  Result<bool> offer_calibration(const StereoCalibration& calibration);
  void set_demand(const BoardDemand& demand);

  bool has_board() const { return identity_.has_value(); }
  BoardAbility ability() const { return ability_; }
  bool makes_disparity() const { return ability_ == BoardAbility::kMakesDisparity; }
  /// Says, for people, why the board does not make the disparity. Empty if it does.
  const std::string& limitation() const { return limitation_; }
  /// The parameters for the board's pairs, whether the board or the software computes them.
  const Parameters& parameters() const { return parameters_; }
  const StereoCalibration& calibration() const { return calibration_; }
  /// What to pass to Device::set_desired_state(). Meaningful while has_board().
  const DesiredState& desired_state() const { return desired_; }
  /// Returns true if an image that is wanted of every pair was dropped from the set.
  bool is_incomplete(const FrameSet& set) const;
  /// Returns what the configuration with this tag was made from, or null if it is too old.
  std::shared_ptr<const PlannedConfiguration> configuration(std::uint64_t tag) const;

 private:
  void update_configuration();
  void update_streams();
  StreamSet streams_of_host_pairs() const;
  /// Streams of every pair of the cameras, without those for verification.
  StreamSet streams_of_cameras() const;
  /// Returns the rectified stream, or the raw one if the build does not send the former.
  Stream rectified_or_raw(Stream rectified, Stream raw) const;
  /// Refuses a build without the streams that every disparity needs.
  Status check_streams() const;
  bool is_shifted() const { return parameters_.min_disparity != 0; }

  const Options options_;
  std::optional<Identity> identity_;
  Parameters requested_;  // as set
  bool is_algorithm_chosen_ = false;
  Parameters parameters_;          // requested_, or with the algorithm of the build
  StereoCalibration calibration_;  // of the cameras, or of the host's last pair
  BoardDemand demand_;
  RectificationCache rectifications_;
  BoardAbility ability_ = BoardAbility::kNoBoard;
  std::string limitation_ = "no board is connected";
  DesiredState desired_;
  std::map<std::uint64_t, std::shared_ptr<const PlannedConfiguration>> configurations_;  // by tag
};

}  // namespace fpga_stereo::link
