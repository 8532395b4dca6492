// The nodelet as a node: loads it into a process of its own.
#include <nodelet/loader.h>
#include <ros/ros.h>

#include <algorithm>
#include <iostream>
#include <string>

namespace {

// Printed without a master, so that it works before anything else does.
constexpr const char* kHelp =
    R"(Usage: ROS_NAMESPACE=STEREO rosrun fpga_stereo stereo [_PARAMETER:=VALUE]... [FROM:=TO]...
The nodelet fpga_stereo/stereo as a node of its own: computes disparity, depth and point cloud from
the raw images of a stereo pair, in software or on a board. STEREO is the namespace of the pair.

Subscribes to left|right/image_raw and left|right/camera_info, or takes the images of a board.
Publishes disparity, points2, depth, left|right/image_rect, disparity_color and others, as far as
they have subscribers, and ~status, which says why there is no disparity.

Main parameters, set with _NAME:=VALUE or rosparam:
  ~stereo_algorithm    sgm (default) or window
  ~disparity_range     number of disparities searched, 8 to 256 in steps of 4 (default 64)
  ~approximate_sync    true if the stamps of left and right differ (default false)
  ~image_transport     transport of the images: raw (default), compressed, ...
  ~backend             auto (default): the board if one is connected; board; software
  ~device              the board: usb (default), usb:serial=NUMBER, serial:PATH, replay:FILE, ...

config/stereo.yaml lists all parameters; most of them can be changed while the node runs
(rosrun rqt_reconfigure rqt_reconfigure). Launch files: roslaunch --ros-args fpga_stereo
stereo.launch lists the arguments. README.md says the rest.

Options:
  -h, --help           print this help and exit
)";

}  // namespace

int main(int argc, char** argv) {
  const bool wants_help = std::any_of(argv + 1, argv + argc, [](const std::string& argument) {
    return argument == "-h" || argument == "--help";
  });
  if (wants_help) {
    std::cout << kHelp;
    return 0;
  }
  ros::init(argc, argv, "stereo");
  if (ros::names::remap("camera") != "camera") {
    ROS_WARN(
        "Remapping \"camera\" has no effect. Start the node in the namespace of the stereo pair: "
        "ROS_NAMESPACE=%s rosrun fpga_stereo stereo",
        ros::names::remap("camera").c_str());
  }
  if (ros::this_node::getNamespace() == "/") {
    ROS_WARN(
        "The node runs in the global namespace, which is probably wrong. Start it in the namespace "
        "of "
        "the stereo pair: ROS_NAMESPACE=my_stereo rosrun fpga_stereo stereo");
  }
  nodelet::Loader loader(false);  // without a manager's services
  const nodelet::M_string& remappings = ros::names::getRemappings();
  const nodelet::V_string arguments(argv + 1, argv + argc);
  if (!loader.load(ros::this_node::getName(), "fpga_stereo/stereo", remappings, arguments)) {
    ROS_FATAL("The nodelet fpga_stereo/stereo cannot be loaded");
    return 1;
  }
  ros::spin();
  return 0;
}
