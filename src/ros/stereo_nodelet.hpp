// The nodelet: reads parameters, connects subscribers, settings and services with the sources.
#pragma once

#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <std_srvs/Trigger.h>

#include <memory>
#include <string>
#include <vector>

#include "core/thread_safety.hpp"
#include "ros/frame_publisher.hpp"
#include "ros/health.hpp"
#include "ros/outputs.hpp"
#include "ros/settings.hpp"
#include "ros/sources.hpp"
#include "ros/status_reporter.hpp"

namespace fpga_stereo {

/// fpga_stereo/stereo: raw pairs to all outputs, by software or board.
class StereoNodelet : public nodelet::Nodelet {
 public:
  StereoNodelet() : StereoNodelet(PairKind::kRaw) {}
  ~StereoNodelet() override;

 protected:
  explicit StereoNodelet(PairKind kind) : kind_(kind) {}

 private:
  using Trigger = std_srvs::Trigger;

  void onInit() override FPGA_STEREO_EXCLUDES(mutex_);
  // Read what is read once at the start.
  Sources::Options load_options(ParameterReport& report) const;
  OutputTopics load_topics(ParameterReport& report) const;
  void make_sources(const Sources::Options& options, const OutputTopics& topics)
      FPGA_STEREO_EXCLUDES(mutex_);
  void on_reconfigure(StereoConfig& config) FPGA_STEREO_EXCLUDES(mutex_);
  /// Deletes ~stereo_algorithm, which the reconfigure server has written, unless the user has
  /// chosen an algorithm: a node that starts again must not take it for a choice.
  void forget_default_algorithm() FPGA_STEREO_EXCLUDES(mutex_);
  void on_demand_change() FPGA_STEREO_EXCLUDES(mutex_);
  void on_timer() FPGA_STEREO_EXCLUDES(mutex_);
  bool on_reset(Trigger::Request&, Trigger::Response& response) FPGA_STEREO_EXCLUDES(mutex_);
  bool on_device_info(Trigger::Request&, Trigger::Response& response) FPGA_STEREO_EXCLUDES(mutex_);
  void apply_demand() FPGA_STEREO_REQUIRES(mutex_);
  /// Returns the sources, or null before onInit() has made them. The destructor stops all callers
  /// before it destroys the sources.
  Sources* sources() const FPGA_STEREO_EXCLUDES(mutex_);

  const PairKind kind_;
  Health health_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<FramePublisher> publisher_;

  /// Held while settings and demand are passed on, before all locks of the sources.
  mutable Mutex mutex_;
  Settings settings_ FPGA_STEREO_GUARDED_BY(mutex_);
  StereoConfig config_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_default_algorithm_written_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  std::unique_ptr<Sources> sources_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::unique_ptr<StatusReporter> reporter_;  // used by the timer alone
  boost::recursive_mutex config_mutex_;       // of the reconfigure server, before mutex_
  std::unique_ptr<dynamic_reconfigure::Server<StereoConfig>> reconfigure_;
  ros::ServiceServer reset_, device_info_;
  ros::WallTimer timer_;
};

/// fpga_stereo/disparity: rectified pairs, for example of image_proc, to a disparity, by software.
class DisparityNodelet : public StereoNodelet {
 public:
  DisparityNodelet() : StereoNodelet(PairKind::kRectified) {}
};

}  // namespace fpga_stereo
