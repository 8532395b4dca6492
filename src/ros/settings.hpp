// The settings of the node and how they are read from ROS parameters.
#pragma once

#include <fpga_stereo/StereoConfig.h>
#include <ros/node_handle.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fpga_stereo/core/cloud.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"
#include "ros/parameter_reader.hpp"

namespace fpga_stereo {

enum class DepthEncoding { kMetres, kMillimetres };

/// Settings that can change while the node runs.
struct Settings {
  Parameters pipeline;
  /// The user has set stereo_algorithm. Otherwise a connected board's build decides.
  bool is_algorithm_chosen = false;
  CloudLayout cloud;
  double cloud_max_rate = 0;  // Hz; 0: a cloud for every frame
  DepthEncoding depth_encoding = DepthEncoding::kMetres;
  int num_threads = 1;
};

/// How image and camera_info messages are paired. Read once at the start.
struct SyncSettings {
  bool approximate_sync = false;
  int queue_size = 5;           // messages per topic
  double sync_tolerance = 0.1;  // s; approximate_sync pairs nothing further apart
};

/// What a node advertises besides the disparity. Read once at the start.
struct OutputTopics {
  bool images = true;       // of the cameras: left|right/image_mono, image_rect, ...
  bool conversions = true;  // of the disparity: points2, depth, disparity_color
};

/// Reads ~publish_images.
OutputTopics load_output_topics(const ros::NodeHandle& private_nh, ParameterReport& report);

/// Reads ~approximate_sync, ~queue_size and ~sync_tolerance.
SyncSettings load_sync_settings(const ros::NodeHandle& private_nh, ParameterReport& report);

/// Checks the dynamic_reconfigure parameters. Replaces a number out of range by the nearest allowed
/// one, and deletes other values that are not allowed, so that their defaults hold. Call before
/// dynamic_reconfigure reads the parameters.
void check_parameters(const ros::NodeHandle& private_nh, ParameterReport& report);

/// Replaces a number of stereo_image_proc in ~stereo_algorithm, 0 or 1, by this node's word.
/// Returns a message if it does. Call before check_parameters().
std::optional<std::string> translate_algorithm(const ros::NodeHandle& private_nh);

/// Returns a message for each parameter of stereo_image_proc that is set but has no effect in this
/// node.
std::vector<std::string> ignored_parameters(const ros::NodeHandle& private_nh);

/// Adds to `report.names` the parameters that fpga_stereo/stereo reads and the other nodelets do
/// not: nodelets may share a file with parameters.
void know_parameters_of_stereo(const ros::NodeHandle& private_nh, ParameterReport& report);

/// Returns a message for each private parameter that is not among `known`, with the name that it
/// resembles. Leaves namespaces within the private one alone, because they may belong to others.
/// Also knows what ignored_parameters() names, and the parameters of the libraries used.
std::vector<std::string> unknown_parameters(const ros::NodeHandle& private_nh,
                                            std::set<std::string> known);

/// Converts `config` to settings. A value that is not allowed is replaced by the one in `accepted`,
/// in `config` too, and a message about it is appended to `refusals`.
Settings to_settings(StereoConfig& config, const StereoConfig& accepted,
                     std::vector<std::string>& refusals);

/// Reads the settings of a node without dynamic_reconfigure.
Settings load_settings(const ros::NodeHandle& private_nh, ParameterReport& report);

}  // namespace fpga_stereo
