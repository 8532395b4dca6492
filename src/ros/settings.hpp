// What the node's parameters mean, and the one way from ROS to them.
#pragma once

#include <fpga_stereo/StereoConfig.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "fpga_stereo/core/cloud.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

enum class DepthEncoding { kMetres, kMillimetres };

/// Settings that can change while the node runs.
struct Settings {
  Parameters pipeline;
  CloudLayout cloud;
  double cloud_max_rate = 0;  // Hz; 0: every frame
  DepthEncoding depth_encoding = DepthEncoding::kMetres;
  int num_threads = 1;
};

/// How image and camera_info messages are paired; read once at the start.
struct SyncSettings {
  bool approximate_sync = false;
  int queue_size = 5;           // messages per topic
  double sync_tolerance = 0.1;  // s; approximate_sync pairs nothing further apart
};

/// Reads ~approximate_sync, ~queue_size and ~sync_tolerance. What is refused keeps its default
/// and is named in `refusals`.
SyncSettings load_sync_settings(const ros::NodeHandle& private_nh,
                                std::vector<std::string>& refusals);

/// Deletes parameters of the configuration that are set to something not allowed, so that their
/// defaults hold; names each in the returned refusals. Call before dynamic_reconfigure reads them.
std::vector<std::string> refuse_bad_parameters(const ros::NodeHandle& private_nh);

/// Parameters of stereo_image_proc that are set here but mean nothing to this pipeline.
std::vector<std::string> ignored_parameters(const ros::NodeHandle& private_nh);

/// The settings that `config` asks for. A value that is not allowed is replaced, in `config` too,
/// by the one of `accepted`, and named in `refusals`.
Settings to_settings(StereoConfig& config, const StereoConfig& accepted,
                     std::vector<std::string>& refusals);

}  // namespace fpga_stereo
