// Settings: parameters that are set before the node starts.
#include <fmt/format.h>

#include <set>
#include <utility>

#include "core/similar_names.hpp"
#include "ros/board_settings.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {
namespace {

/// A parameter of stereo_image_proc without effect, and what this node has in its place.
struct Ignored {
  const char* name;
  const char* counterpart;
};
constexpr Ignored kIgnored[]{{"prefilter_size", ""},
                             {"prefilter_cap", ""},
                             {"texture_threshold", ""},
                             {"downsampling_factor", ""},
                             {"P1", "sgm_p1, on another scale"},
                             {"P2", "sgm_p2, sgm_p2_edge and sgm_p2_strong_edge, on another scale"},
                             {"fullDP", "sgm_build"}};

}  // namespace

SyncSettings load_sync_settings(const ros::NodeHandle& private_nh, ParameterReport& report) {
  SyncSettings settings;
  ParameterReader read(private_nh, report);
  read.flag("approximate_sync", settings.approximate_sync);
  read.number("queue_size", 1, 1000, settings.queue_size);
  read.positive_number("sync_tolerance", 10.0, settings.sync_tolerance);
  return settings;
}

OutputTopics load_output_topics(const ros::NodeHandle& private_nh, ParameterReport& report) {
  OutputTopics topics;
  ParameterReader(private_nh, report).flag("publish_images", topics.images);
  return topics;
}

std::optional<std::string> translate_algorithm(const ros::NodeHandle& private_nh) {
  constexpr const char* kName = "stereo_algorithm";
  XmlRpc::XmlRpcValue value;
  if (!private_nh.getParam(kName, value)) return std::nullopt;
  const std::string number = text_of(value);
  if (number != "0" && number != "1") return std::nullopt;
  const std::string word =
      to_text(number == "0" ? StereoAlgorithm::kWindow : StereoAlgorithm::kSgm);
  private_nh.setParam(kName, word);
  return fmt::format("{} = {} of stereo_image_proc ({}) means {} in this node", kName, number,
                     number == "0" ? "block matching" : "semi-global block matching", word);
}

std::vector<std::string> ignored_parameters(const ros::NodeHandle& private_nh) {
  std::vector<std::string> messages;
  for (const auto& [name, counterpart] : kIgnored) {
    if (!private_nh.hasParam(name)) continue;
    std::string message =
        fmt::format("parameter {} of stereo_image_proc has no effect in this node", name);
    if (*counterpart != '\0') message += fmt::format("; this node has {}", counterpart);
    messages.push_back(std::move(message));
  }
  return messages;
}

void know_parameters_of_stereo(const ros::NodeHandle& private_nh, ParameterReport& report) {
  ParameterReport of_stereo;
  load_output_topics(private_nh, of_stereo);
  load_board_settings(private_nh, of_stereo);
  report.names.merge(of_stereo.names);
}

std::vector<std::string> unknown_parameters(const ros::NodeHandle& private_nh,
                                            std::set<std::string> known) {
  // Of image_transport and diagnostic_updater.
  known.insert({"image_transport", "diagnostic_period"});
  for (const Ignored& ignored : kIgnored) known.insert(ignored.name);
  const std::string prefix = private_nh.getNamespace() + "/";
  std::vector<std::string> names, messages;
  private_nh.getParamNames(names);
  for (const std::string& name : names) {
    if (name.rfind(prefix, 0) != 0) continue;
    const std::string own = name.substr(prefix.size());
    const bool is_nested = own.find('/') != std::string::npos;
    if (is_nested || known.count(own) != 0) continue;
    std::string message = fmt::format("parameter {} is unknown and has no effect", own);
    const auto near = similar_names(own, {known.begin(), known.end()});
    if (!near.empty()) message += fmt::format(": did you mean {}?", near.front());
    messages.push_back(std::move(message));
  }
  return messages;
}

}  // namespace fpga_stereo
