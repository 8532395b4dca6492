// `nodelet manager` and `nodelet standalone TYPE` with the sanitizers of this build, which must be
// loaded when a program starts.
#include <nodelet/loader.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>

int main(int argc, char** argv) {
  // Brings a copy of boost's reference counting, which all libraries use then: ThreadSanitizer must
  // see who was the last user of a message.
  boost::make_shared<int>(0);
  ros::init(argc, argv, "manager");
  const bool is_standalone = argc > 2 && std::string(argv[1]) == "standalone";
  nodelet::Loader loader(!is_standalone);
  if (is_standalone && !loader.load(ros::this_node::getName(), argv[2], {}, {})) return 1;
  ros::spin();
}
