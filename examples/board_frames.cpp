// Prints the disparity frames of a board:
//   board_frames DEVICE LEFT.yaml RIGHT.yaml COUNT
// DEVICE is a name that open_transport() takes, such as usb. The YAML files are camera_info files.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <thread>

#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "fpga_stereo/link/device.hpp"

using namespace fpga_stereo;

int fail(const std::string& message) { return std::fprintf(stderr, "%s\n", message.c_str()), 1; }

int main(int argc, char** argv) {
  if (argc != 5) return fail("usage: board_frames DEVICE LEFT.yaml RIGHT.yaml COUNT");
  const auto left = read_camera_info(argv[2]);
  if (!left) return fail(left.error().message);
  const auto right = read_camera_info(argv[3]);
  if (!right) return fail(right.error().message);

  std::atomic<int> count{0};
  link::Device::Callbacks callbacks;  // called from a thread of the device
  callbacks.note = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  callbacks.received = [&](const link::ReceivedFrames& frames) {
    const cv::Mat disparity = frames.set.image(link::Stream::kDisparity);
    if (disparity.empty()) return;  // lost on the link
    const int valid = cv::countNonZero(disparity != kNoDisparity);
    std::printf("%.6f s: %d of %zu pixels have a disparity\n", frames.stamp, valid,
                disparity.total());
    ++count;
  };
  link::Device::Options options;
  options.open = [name = std::string(argv[1])] { return link::open_transport(name); };
  link::Device device(options, callbacks);

  auto identity = device.snapshot().identity;
  for (; !identity; identity = device.snapshot().identity) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const GatewareBuild& build = identity->build;
  const Parameters parameters = parameters_of(build);  // what the build fixes, and the defaults
  const auto rectification = make_stereo_rectification(*left, *right, parameters.min_disparity);
  if (!rectification) return fail(rectification.error().message);
  const auto configuration = make_gateware_configuration(build, parameters, *rectification);
  if (!configuration) return fail(configuration.error().message);
  link::DesiredState desired;
  desired.configuration = std::make_shared<const GatewareConfiguration>(*configuration);
  desired.streams = link::Stream::kDisparity;
  device.set_desired_state(desired);  // applied now, and again whenever the board comes back
  while (count < std::atoi(argv[4])) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return 0;
}
