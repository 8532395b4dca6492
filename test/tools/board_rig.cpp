#include "board_rig.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <thread>

#include "fpga_stereo/core/spec.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {

namespace fs = std::filesystem;

const cv::Size BoardTest::kSize(64, 48);

BoardTest::BoardTest() {
  for (int i = 0; i < kPairs; ++i) {
    pairs_.push_back(noise_pair(kSize, 3 + i, i + 1));
    const std::string name = std::to_string(i) + ".png";
    write("images/left/" + name, pairs_.back().left);
    write("images/right/" + name, pairs_.back().right);
  }
  const InfoPair infos = distorted_cameras(kSize);
  write_info("left.yaml", infos.left);
  write_info("right.yaml", infos.right);
}

BoardTest::Strings BoardTest::with(Strings some, const Strings& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

void BoardTest::start(const Strings& options) {
  Strings words{FPGA_STEREO_VIRTUAL_BOARD, "--pty", at("tty"), "--folder", at("images")};
  const std::vector<std::pair<std::string, std::string>> defaults{
      {"--rate", "40"},       {"--keep", "3"},         {"--threads", "1"},
      {"--max-width", "64"},  {"--disparities", "16"}, {"--census", "5"},
      {"--correlation", "5"}, {"--line-rows", "20"},   {"--mesh-nodes", "600"}};
  for (const auto& [name, value] : defaults) {
    const bool given = std::find(options.begin(), options.end(), name) != options.end();
    if (!given) words.insert(words.end(), {name, value});
  }
  std::string command = "exec";
  for (const std::string& word : with(words, options)) command += " " + shell_quoted(word);
  fs::remove(at("board_out"));
  command += " >" + shell_quoted(at("board_out")) + " 2>" + shell_quoted(at("board_err"));
  child_ = std::make_unique<Child>(Strings{"sh", "-c", command}, Strings{}, "sh is missing");
  const std::string ready = "ready " + at("tty") + "\n";
  for (int i = 0; i < 2000 && !child_->exit_code(); ++i) {
    if (fs::exists(at("board_out")) && bytes(at("board_out")) == ready) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  FAIL() << "the virtual board did not start: " << statistics();
}

int BoardTest::stop() {
  child_->send_signal(SIGINT);
  return child_->wait();
}

Outcome BoardTest::board(const std::string& mode, const Strings& arguments) const {
  // On a busy machine, both programs may be slow.
  return run(FPGA_STEREO_BOARD, with({mode, device(), "--wait", "20"}, arguments));
}

BoardTest::Strings BoardTest::settings() const {
  return {"--left-info", at("left.yaml"),  "--right-info", at("right.yaml"),     "--min_disparity",
          "1",           "--speckle_size", "20",           "--uniqueness_ratio", "10"};
}

void BoardTest::upload() const {
  const Outcome run = board("upload", settings());
  ASSERT_EQ(run.code, 0) << run.err;
}

const std::string& BoardTest::matched(int i) {
  if (matched_.empty()) matched_.resize(kPairs);
  std::string& png = matched_[static_cast<std::size_t>(i)];
  if (!png.empty()) return png;
  const std::string name = std::to_string(i) + ".png";
  const Outcome run =
      match(with({at("images/left/" + name), at("images/right/" + name), at("matched.png"),
                  "--stereo_algorithm", "window", "--disparity_range", "16", "--census_window_size",
                  "5", "--correlation_window_size", "5"},
                 settings()));
  EXPECT_EQ(run.code, 0) << run.err;
  return png = bytes(at("matched.png"));
}

int BoardTest::expect_matched(const std::string& folder, bool any_pair) {
  int compared = 0;
  std::istringstream table(bytes(at(folder) + "/frames.csv"));
  std::string line;
  std::getline(table, line);  // the names of the columns
  while (std::getline(table, line)) {
    const std::string name = line.substr(0, line.find(','));
    if (name.empty()) continue;  // dropped
    const std::uint64_t id = std::stoull(line.substr(name.size() + 1));
    const std::string path = at(folder) + "/disparity/" + name;
    // The cameras repeat the pairs in order, beginning with the first frame.
    const std::uint64_t first = ~std::uint64_t{0} << 32 | kLinkFirstFrame;
    int pair = static_cast<int>((id - first) % kPairs);
    const std::string captured = bytes(path);
    for (int i = 0; any_pair && i < kPairs; ++i) {
      if (captured == matched(i)) pair = i;
    }
    EXPECT_EQ(captured, matched(pair)) << path;
    ++compared;
  }
  return compared;
}

}  // namespace fpga_stereo::tools
