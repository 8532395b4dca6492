#include "programs.hpp"

#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "make_bag/camera_info_files.hpp"
#include "make_bag/stereo_info.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {

namespace fs = std::filesystem;

ProgramTest::ProgramTest() {
  std::string name = (fs::temp_directory_path() / "fpga_stereo_tools_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be created");
  folder_ = name;
}

ProgramTest::~ProgramTest() { fs::remove_all(folder_); }

bool ProgramTest::exists(const std::string& name) const { return fs::exists(at(name)); }

Outcome ProgramTest::run(const std::string& program,
                         const std::vector<std::string>& arguments) const {
  std::string command = shell_quoted(program);
  for (const std::string& argument : arguments) command += " " + shell_quoted(argument);
  command += " >" + shell_quoted(at("stdout")) + " 2>" + shell_quoted(at("stderr"));
  const int status = std::system(command.c_str());
  Outcome outcome;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = bytes(at("stdout"));
  outcome.err = bytes(at("stderr"));
  return outcome;
}

Outcome ProgramTest::match(const std::vector<std::string>& arguments) const {
  return run(FPGA_STEREO_MATCH, arguments);
}
Outcome ProgramTest::simulate(const std::vector<std::string>& arguments) const {
  return run(FPGA_STEREO_SIMULATE, arguments);
}
Outcome ProgramTest::evaluate(const std::vector<std::string>& arguments) const {
  return run(FPGA_STEREO_EVALUATE, arguments);
}
Outcome ProgramTest::make_bag(const std::vector<std::string>& arguments) const {
  return run(FPGA_STEREO_MAKE_BAG, arguments);
}

void ProgramTest::expect_refused(const std::string& program, const Outcome& run, int code,
                                 const std::vector<std::string>& parts) {
  EXPECT_EQ(run.code, code);
  EXPECT_EQ(run.out, "");
  // The message begins a line; libraries may print other lines.
  EXPECT_NE(("\n" + run.err).find("\n" + program + ": "), std::string::npos) << run.err;
  for (const std::string& part : parts) {
    EXPECT_NE(run.err.find(part), std::string::npos) << "\"" << part << "\" in: " << run.err;
  }
}

std::string ProgramTest::write(const std::string& name, const cv::Mat& image) const {
  fs::create_directories(fs::path(at(name)).parent_path());
  write_image(at(name), image);
  return at(name);
}

std::string ProgramTest::write_text(const std::string& name, const std::string& text) const {
  fs::create_directories(fs::path(at(name)).parent_path());
  std::ofstream(at(name), std::ios::binary) << text;
  return at(name);
}

std::string ProgramTest::write_info(const std::string& name,
                                    const sensor_msgs::CameraInfo& info) const {
  write_camera_info(at(name), "camera", info);
  return at(name);
}

std::string bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\n';
    if (!blank) line += c;
    if (blank && (line.empty() || line.back() != ' ')) line += ' ';
  }
  return line;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    const auto* begin = a.ptr(y);
    if (!std::equal(begin, begin + a.cols * a.elemSize(), b.ptr(y))) return false;
  }
  return true;
}

std::string test_data(const std::string& name) {
  const fs::path folder = fs::path(test::data_dir().value_or("")) / name;
  return fs::is_directory(folder) ? folder.string() : "";
}

NoisePair noise_pair(cv::Size size, int disparity, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  NoisePair pair{cv::Mat1b(size), cv::Mat1b(size)};
  random.fill(pair.left, cv::RNG::UNIFORM, 0, 256);
  random.fill(pair.right, cv::RNG::UNIFORM, 0, 256);
  const cv::Rect all({0, 0}, size);
  const cv::Rect seen = all & (all + cv::Point(disparity, 0));
  pair.right(seen - cv::Point(disparity, 0)).copyTo(pair.left(seen));
  return pair;
}

InfoPair distorted_cameras(cv::Size size) {
  const double f = size.width;
  const double cx = size.width / 2.0;
  const double cy = size.height / 2.0;
  const Intrinsics left{{f, 0, cx, 0, f, cy, 0, 0, 1}, {-0.1, 0.02, 0.001, 0, 0}};
  const Intrinsics right{{f + 1, 0, cx + 1, 0, f, cy - 1, 0, 0, 1}, {-0.11, 0.02, 0, 0.001, 0}};
  cv::Matx33d rotation;
  cv::Rodrigues(cv::Vec3d(0.01, -0.01, 0.02), rotation);
  const StereoInfo info = calibrated_info(size, left, right, rotation, {-0.1, 0, 0});
  return {info.left, info.right};
}

}  // namespace fpga_stereo::tools
