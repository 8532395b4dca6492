// Frames made by the software pipeline from images on topics.
#pragma once

#include <ros/node_handle.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/ros/frame.hpp"
#include "fpga_stereo/ros/health.hpp"
#include "fpga_stereo/ros/stamp_gate.hpp"
#include "fpga_stereo/ros/topic_input.hpp"

namespace fpga_stereo {

/// Pairs come in on the callback queue; one thread of its own makes frames and hands them on. A
/// pair that waits for that thread is replaced by a newer one: work never queues up.
class SoftwareSource {
 public:
  static constexpr const char* kName = "software";
  using Callback = std::function<void(const StereoFrame&)>;

  /// `callback` is called from the source's own thread.
  SoftwareSource(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                 const SyncSettings& sync, Health& health, Callback callback);
  ~SoftwareSource();
  SoftwareSource(const SoftwareSource&) = delete;
  SoftwareSource& operator=(const SoftwareSource&) = delete;

  /// Subscribes or unsubscribes the images.
  void listen(bool wanted);
  /// What the next frame shall contain.
  void set_demand(const Demand& demand);
  void set_settings(const Settings& settings);
  std::string complaint() const { return input_.complaint(); }

 private:
  void receive(const InputPair& pair);
  void run();
  /// The frame, or the reason why there is none.
  Result<StereoFrame> make(const InputPair& pair, const Demand& demand, const Settings& settings);
  /// The meshes for the pair, made anew only when calibration or min_disparity changes.
  const Result<StereoRectification>& rectification(const InputPair& pair, int min_disparity);
  void refuse(DropCause cause, const std::string& why);

  Health& health_;
  Callback callback_;

  // Owned by the thread.
  StampGate gate_;
  Pipeline pipeline_;
  CameraCalibration left_calibration_, right_calibration_;
  std::unique_ptr<Result<StereoRectification>> rectification_;
  int rectified_min_disparity_ = 0;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<InputPair> waiting_;
  Demand demand_;
  Settings settings_;
  bool stopping_ = false;

  TopicInput input_;
  std::thread thread_;
};

}  // namespace fpga_stereo
