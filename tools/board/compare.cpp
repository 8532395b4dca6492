// board compare.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iostream>

#include "board/build.hpp"
#include "board/connection.hpp"
#include "board/modes.hpp"
#include "board/pairs.hpp"
#include "core/reference_pipeline.hpp"
#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "support/files.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

using Signatures = std::array<std::uint32_t, kNumGatewareStages>;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: board compare [DEVICE] [LEFT RIGHT] [options]\n"
      "Sends a pair to the board in place of its cameras and compares the signature of every\n"
      "stage with the software's, to say which stage of the hardware is the first that differs.\n"
      "LEFT and RIGHT are image files; without them, a textured pair is sent. Without --left-info\n"
      "and --right-info the pair is not rectified. The exit code is 1 if a stage differs.\n"
      "Afterwards the board must be configured again.\n";
  line.rest = "LEFT RIGHT";
  line.takes_files = true;
  add_patience(line);
  add_configuration_options(line);
  return line;
}

struct Pair {
  cv::Mat1b left, right;
};

Pair read_pair(const Arguments& files) {
  Pair pair{read_grey(files[0]), read_grey(files[1])};
  if (pair.left.size() != pair.right.size()) {
    throw std::runtime_error(fmt::format("{} is {}x{} and {} is {}x{}: the sizes must be equal",
                                         files[0], pair.left.cols, pair.left.rows, files[1],
                                         pair.right.cols, pair.right.rows));
  }
  return pair;
}

/// Sends the pair. Returns the signatures of the board's stages.
Signatures board_signatures(Connection& board, const BoardConfiguration& configuration,
                            const Pair& pair) {
  constexpr std::uint64_t kTag = 1;
  const link::StreamSet streams = link::Stream::kDisparity;
  apply_configuration(board, configuration.gateware, kTag, streams, true, kConfigurationTimeout);
  PairSender(board, streams).send(pair.left, pair.right, kTag);
  std::vector<std::uint32_t> addresses;
  for (std::uint32_t stage = 0; stage < kNumGatewareStages; ++stage) {
    addresses.push_back(spec::kRegSignatureRectify + stage);
  }
  const std::vector<std::uint32_t> values = board.read(addresses);
  Signatures signatures{};
  std::copy_n(values.begin(), signatures.size(), signatures.begin());
  return signatures;
}

}  // namespace

void compare(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const Arguments& files = parsed->positional;
  if (files.size() != 0 && files.size() != 2) {
    throw UsageError(
        fmt::format("{} image files are given: allowed 2, LEFT and RIGHT, or none", files.size()));
  }
  const po::variables_map& options = parsed->options;
  const bool has_size = check_configuration_options(options);
  Pair pair;
  if (!files.empty()) pair = read_pair(files);

  Connection board(device_of(*parsed), patience(options));
  const link::Identity identity = board.identify();
  require_host_pairs(identity);
  const cv::Size largest(identity.build.max_width, identity.build.max_width * 3 / 4);
  const auto configuration =
      board_configuration(options, identity.build, files.empty() ? largest : pair.left.size());
  const cv::Size size = configuration.rectification.geometry.image_size;
  if (files.empty()) make_pair(size, 1, identity.build.disparities, pair.left, pair.right);
  if (pair.left.size() != size) {
    throw std::runtime_error(
        fmt::format("{} is {}x{}: the {} {}x{}", files[0], pair.left.cols, pair.left.rows,
                    has_size ? "calibration or --size says" : "size is", size.width, size.height));
  }

  ReferencePipeline pipeline;
  const Taps& taps = pipeline.process(pair.left, pair.right, configuration.rectification,
                                      configuration.parameters, cv::getNumberOfCPUs());
  const Signatures software = stage_signatures(taps, configuration.parameters);
  const Signatures hardware = board_signatures(board, configuration, pair);
  std::string first;  // stage that differs
  for (int stage = 0; stage < kNumGatewareStages; ++stage) {
    const auto index = static_cast<std::size_t>(stage);
    const bool is_same = hardware[index] == software[index];
    if (!is_same && first.empty()) first = gateware_stage_name(stage);
    std::cout << fmt::format("{:9} board {}, software {}: {}\n", gateware_stage_name(stage),
                             hex(hardware[index]), hex(software[index]),
                             is_same ? "equal" : "different");
  }
  if (!first.empty()) {
    throw std::runtime_error(
        fmt::format("{} is the first stage of this board that differs from the software", first));
  }
  std::cout << fmt::format("all {} stages are equal\n", kNumGatewareStages);
}

}  // namespace fpga_stereo::tools
