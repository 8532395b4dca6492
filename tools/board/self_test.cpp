// board selftest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "board/build.hpp"
#include "board/modes.hpp"
#include "board/pairs.hpp"
#include "board/streams.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

constexpr double kMinLinkSpeed = 100e3;  // bytes/s
constexpr double kRetryTime = 15;        // s: for pairs that the link loses

/// One pair with its parameters and rectification.
struct Case {
  unsigned seed = 0;
  bool is_rectified = false;  // the meshes displace pixels
  Parameters parameters = window_parameters();
  StereoRectification rectification;
  cv::Mat1b left, right;
};

/// Returns a mesh that rotates the image about its centre, as far as the line buffer allows, and
/// shifts it.
CameraRectification make_rotation(cv::Size size, int rows, double sign, int shift_x,
                                  const std::string& camera) {
  const double room = std::max(0.0, (rows - 8) / 4.0);  // px up or down at the edge
  const double angle = sign * std::min(0.02, room / size.width);
  const cv::Point2d middle(size.width / 2.0, size.height / 2.0);
  const auto map = [=](double x, double y) {
    const double u = x - shift_x - middle.x, v = y - middle.y;
    return cv::Point2d(middle.x + u - angle * v + 0.3 * sign, middle.y + v + angle * u + 0.7);
  };
  auto rectification = make_rectification(map, size, size, camera);
  require(rectification);
  return *rectification;
}

Case make_case(const GatewareBuild& build, cv::Size size, unsigned seed, bool is_rectified) {
  Case test;
  test.seed = seed;
  test.is_rectified = is_rectified;
  Parameters& p = test.parameters;
  p = parameters_of(build);
  p.min_disparity = static_cast<int>(seed % 3);
  p.speckle_size = static_cast<int>(seed * 37 % 200);
  p.uniqueness_ratio = seed * 11 % 50;
  p.disp12MaxDiff = static_cast<int>(seed % 4);
  p.subpixel = seed % 4 != 3;
  StereoGeometry geometry;
  geometry.image_size = size;
  test.rectification = identity_rectification(geometry, p.min_disparity);
  if (is_rectified) {
    test.rectification.left = make_rotation(size, build.line_rows, 1, 0, "left");
    test.rectification.right = make_rotation(size, build.line_rows, -1, p.min_disparity, "right");
  }
  make_pair(size, seed, build.disparities, test.left, test.right);
  return test;
}

struct Comparison {
  std::uint64_t compared = 0, differing = 0;
};

class SelfTest {
 public:
  SelfTest(Connection& board, const link::Identity& identity, link::StreamSet streams)
      : board_(board), identity_(identity), streams_(streams), sender_(board, streams) {}

  /// Returns how many pairs the link lost.
  int num_lost() const { return sender_.num_lost(); }

  /// Sends the pair of a case and compares the results.
  Comparison run(const Case& test) {
    const auto configuration =
        make_gateware_configuration(identity_.build, test.parameters, test.rectification);
    require(configuration, "this board cannot be tested with these settings: ");
    apply_configuration(board_, *configuration, ++tag_, streams_, true, kConfigurationTimeout);
    const link::FrameSet set = sender_.send(test.left, test.right, tag_);
    const DisparityFrame& frame = pipeline_.process(test.left, test.right, test.rectification,
                                                    test.parameters, cv::getNumberOfCPUs());
    Comparison all;
    compare(test, "disparity", set.image(link::Stream::kDisparity), frame.disparity, all);
    compare(test, "left", set.image(link::Stream::kRectifiedLeft), frame.left, all);
    compare(test, "right", set.image(link::Stream::kRectifiedRight), frame.right, all);
    return all;
  }

 private:
  void compare(const Case& test, const std::string& name, const cv::Mat& board,
               const cv::Mat& software, Comparison& all) {
    if (board.empty()) return;
    if (board.size() != software.size() || board.type() != software.type()) {
      throw std::runtime_error(fmt::format("{} has {}x{} pixels, expected {}x{}", name, board.cols,
                                           board.rows, software.cols, software.rows));
    }
    const cv::Mat difference = board != software;
    const auto count = static_cast<std::uint64_t>(cv::countNonZero(difference));
    all.compared += board.total();
    all.differing += count;
    if (count == 0) return;
    std::vector<cv::Point> where;
    cv::findNonZero(difference, where);
    const auto value = [&](const cv::Mat& image) {
      return image.depth() == CV_16U ? image.at<std::uint16_t>(where[0])
                                     : image.at<std::uint8_t>(where[0]);
    };
    std::cout << "  seed " << test.seed << ", " << name << ": " << count
              << " pixels differ, the first at (" << where[0].x << ", " << where[0].y << "): board "
              << value(board) << ", software " << value(software) << "\n";
  }

  Connection& board_;
  const link::Identity identity_;
  const link::StreamSet streams_;
  PairSender sender_;
  Pipeline pipeline_;
  std::uint64_t tag_ = 0;
};

}  // namespace

void self_test(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board selftest [DEVICE] [options]\n"
      "Sends textured pairs to the board in place of its cameras, with and without rectification "
      "and\n"
      "with varied parameters, and compares the results with the software, bit for bit. The exit "
      "code\n"
      "is 1 if a single pixel differs. Afterwards the board must be configured again.\n";
  line.options.add_options()("size", po::value<std::string>()->value_name("WxH"),
                             "size of the pairs [default: the maximum width, 4:3]");
  line.options.add_options()("pairs", po::value<int>()->value_name("N")->default_value(3),
                             "number of pairs, each sent with two calibrations [1 to 1000]");
  add_patience(line);
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const int pairs = parsed->options["pairs"].as<int>();
  require_range("--pairs", pairs, 1, 1000);
  cv::Size size;
  if (parsed->options.count("size") != 0) {
    size = parse_size(parsed->options["size"].as<std::string>());
  }

  Connection board(device_of(*parsed), patience(parsed->options));
  const link::Identity identity = board.identify();
  require_host_pairs(identity);
  if (size.empty()) size = {identity.build.max_width, identity.build.max_width * 3 / 4};
  link::StreamSet streams;
  for (const auto stream :
       {link::Stream::kDisparity, link::Stream::kRectifiedLeft, link::Stream::kRectifiedRight}) {
    if (identity.supports(stream)) streams |= stream;
  }
  SelfTest test(board, identity, streams);
  Comparison all;
  for (int seed = 1; seed <= pairs; ++seed) {
    for (const bool is_rectified : {false, true}) {
      const Comparison one =
          test.run(make_case(identity.build, size, static_cast<unsigned>(seed), is_rectified));
      std::cout << "seed " << seed << ", " << size.width << "x" << size.height
                << (is_rectified ? ", rectified" : ", not rectified") << ": " << one.compared
                << " pixels compared, " << one.differing << " differ" << std::endl;
      all.compared += one.compared;
      all.differing += one.differing;
    }
  }
  std::cout << "all: " << all.compared << " pixels compared, " << all.differing << " differ; "
            << test.num_lost() << " pairs were lost on the link and sent again\n";
  if (all.differing != 0) {
    throw std::runtime_error(fmt::format(
        "{} of {} pixels differ between this board and the software", all.differing, all.compared));
  }
}

}  // namespace fpga_stereo::tools
