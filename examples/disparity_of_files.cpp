// Computes the disparity of two image files:
//   disparity_of_files LEFT.png RIGHT.png OUT.png LEFT.yaml RIGHT.yaml
// The YAML files are camera_info files. OUT.png has 16 bits a pixel, in 1/32 px; 65535 = none.
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "fpga_stereo/core/pipeline.hpp"

using namespace fpga_stereo;

int fail(const Error& error) { return std::fprintf(stderr, "%s\n", error.message.c_str()), 1; }

int main(int argc, char** argv) {
  if (argc != 6)
    return fail({{}, "usage: disparity_of_files LEFT RIGHT OUT.png LEFT.yaml RIGHT.yaml"});
  const cv::Mat1b left = cv::imread(argv[1], cv::IMREAD_GRAYSCALE);
  const cv::Mat1b right = cv::imread(argv[2], cv::IMREAD_GRAYSCALE);
  const auto left_camera = read_camera_info(argv[4]);
  if (!left_camera) return fail(left_camera.error());
  const auto right_camera = read_camera_info(argv[5]);
  if (!right_camera) return fail(right_camera.error());

  const Parameters parameters;  // the defaults: 64 disparities, all checks on
  const auto rectification =
      make_stereo_rectification(*left_camera, *right_camera, parameters.min_disparity);
  if (!rectification) return fail(rectification.error());
  const Status valid_left = validate_image(left, *rectification, "left");
  if (!valid_left) return fail(valid_left.error());
  const Status valid_right = validate_image(right, *rectification, "right");
  if (!valid_right) return fail(valid_right.error());

  Pipeline pipeline;
  const auto& frame = pipeline.process(left, right, *rectification, parameters, /*num_threads=*/2);
  const int valid = cv::countNonZero(frame.disparity != kNoDisparity);
  std::printf("%d of %zu pixels have a disparity\n", valid, frame.disparity.total());
  return cv::imwrite(argv[3], frame.disparity) ? 0 : fail({{}, "cannot write the output image"});
}
