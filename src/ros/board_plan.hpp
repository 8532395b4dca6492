// What a board is to do: made of its build, the settings, the calibration, and what others ask for.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "ros/board_settings.hpp"
#include "ros/camera_topics.hpp"
#include "ros/frame.hpp"
#include "ros/rectifier.hpp"

namespace fpga_stereo {

bool same_calibration(const CameraTopics::Infos& a, const CameraTopics::Infos& b);

/// Not thread-safe.
class BoardPlan {
 public:
  /// What a configuration of the board was made from.
  struct Made {
    Settings settings;
    CameraTopics::Infos infos;
    std::shared_ptr<const StereoRectification> rectification;  // null: the board's images are raw
    cv::Size image_size;                                       // px, of every image it makes
  };

  explicit BoardPlan(const BoardSettings& settings) : settings_(settings) {}

  /// The board that is there; none: there is none.
  void set_identity(const std::optional<link::Identity>& identity);
  void set_settings(const Settings& settings);
  void set_calibration(const CameraTopics::Infos& infos);
  /// The calibration of the board's own cameras: whether it is a new one. Fails, and nothing
  /// changes, where its two sides do not agree though the old ones did.
  Result<bool> offer_calibration(const CameraTopics::Infos& infos);
  void set_demand(const Demand& outputs, const CameraTopics::Demand& cameras);

  bool present() const { return identity_.has_value(); }
  /// Why the board does not make the disparity, though it is present; empty where it does.
  const std::string& unable() const { return unable_; }
  const Demand& demand() const { return demand_; }
  const CameraTopics::Infos& calibration() const { return infos_; }
  /// What the device is to be told; means something where a board is present.
  const link::DesiredState& wanted() const { return wanted_; }
  /// Something was dropped of a set, and it lacks an image that is wanted of every pair.
  bool lacks(const link::FrameSet& set) const;
  /// What frames of this tag are made from; null: that was long ago.
  std::shared_ptr<const Made> made(std::uint64_t tag) const;

 private:
  /// Makes a configuration of settings, calibration and build.
  void configure();
  void want();
  /// Streams of all pairs; those for verification alone are not among them.
  link::StreamSet streams_of_cameras() const;
  link::StreamSet streams_of_pairs() const;
  /// A rectified image, or the raw one to be rectified here.
  link::Stream rectified(link::Stream rectified, link::Stream raw) const;
  /// Why this build makes no disparity, whatever the settings; empty: it may.
  std::string missing_stream() const;
  bool shifted() const { return node_settings_.pipeline.min_disparity != 0; }

  const BoardSettings& settings_;
  std::optional<link::Identity> identity_;
  Settings node_settings_;
  Demand demand_;
  CameraTopics::Demand cameras_;
  CameraTopics::Infos infos_;  // of the cameras, or of the latest pair
  Rectifier rectifier_;
  std::string unable_;
  link::DesiredState wanted_;
  std::map<std::uint64_t, std::shared_ptr<const Made>> made_;  // by tag
};

}  // namespace fpga_stereo
