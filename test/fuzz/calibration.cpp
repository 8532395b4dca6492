// libFuzzer target for calibration files. The first byte selects whether the rest is a file, or the
// lines of a good file to replace and what replaces them.
#include <fuzzer/FuzzedDataProvider.h>

#include <iterator>
#include <string>
#include <vector>

#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "fuzz/budget.hpp"

namespace {

using fpga_stereo::test::require;

constexpr const char* kLines[] = {"image_width: 64",
                                  "image_height: 48",
                                  "camera_name: left",
                                  "camera_matrix:",
                                  "  rows: 3",
                                  "  cols: 3",
                                  "  data: [300, 0, 32, 0, 300, 24, 0, 0, 1]",
                                  "distortion_model: plumb_bob",
                                  "distortion_coefficients:",
                                  "  rows: 1",
                                  "  cols: 5",
                                  "  data: [-0.1, 0.02, 0.001, -0.0005, 0]",
                                  "rectification_matrix:",
                                  "  rows: 3",
                                  "  cols: 3",
                                  "  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]",
                                  "projection_matrix:",
                                  "  rows: 3",
                                  "  cols: 4",
                                  "  data: [300, 0, 32, 0, 0, 300, 24, 0, 0, 0, 1, 0]",
                                  "binning_x: 0",
                                  "roi: {x_offset: 0, y_offset: 0, width: 0, height: 0}"};

std::string file(FuzzedDataProvider& input) {
  if (input.ConsumeBool()) return input.ConsumeRemainingBytesAsString();
  std::vector<std::string> lines(std::begin(kLines), std::end(kLines));
  while (input.remaining_bytes() > 0) {
    std::string& line = lines[input.ConsumeIntegralInRange<std::size_t>(0, lines.size() - 1)];
    const std::size_t at = input.ConsumeIntegralInRange<std::size_t>(0, line.size());
    const std::size_t count = input.ConsumeIntegralInRange<std::size_t>(0, line.size() - at);
    line.replace(at, count, input.ConsumeRandomLengthString(40));
  }
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  const std::string text = file(input);
  const fpga_stereo::test::Budget budget(text.size());
  const auto camera = fpga_stereo::parse_camera_info(text, "file");
  if (!camera) {
    require(camera.error().message.rfind("file: ", 0) == 0, "a refusal names the file");
    require(camera.error().message.size() < 1000, "a refusal is short");
    return 0;
  }
  require(camera->D.size() <= fpga_stereo::kMaxDistortionCoefficients, "D is short");
  if (const auto written = fpga_stereo::format_camera_info(*camera, "left")) {
    require(*fpga_stereo::parse_camera_info(*written, "") == *camera,
            "what is written reads the same");
  }
  return 0;
}
