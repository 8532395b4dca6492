// The nodelet as a node: loads it into a process of its own.
#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
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
