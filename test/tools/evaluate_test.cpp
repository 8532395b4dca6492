// evaluate, on small scenes with known percentages and on the real images.
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>

#include "programs.hpp"
#include "support/middlebury.hpp"

namespace fpga_stereo::tools {
namespace {

const cv::Size kSize(96, 48);
// Away from the borders of the image, where windows contain pixels that only one camera sees.
const cv::Rect kAllRect(50, 0, 28, 48);
const cv::Rect kNonOccludedRect(50, 0, 20, 48);
const cv::Rect kDiscRect(50, 0, 10, 48);
const cv::Rect kWrongTruth(50, 0, 5, 48);  // no disparity agrees with the truth here
// The resulting percentages of bad pixels:
constexpr double kNonocc = 25, kAllBad = 100.0 * 5 / 28, kDisc = 50;
constexpr double kMean = (kNonocc + kAllBad + kDisc) / 3;

// Rows of an algorithm: dense, filled and semi-dense; raw.
constexpr std::size_t kWindowRows = 5 + 5 + 3, kSgmRows = 5 + 3, kPeerRows = 5 + 3, kRawRows = 4;

/// Disparity of each scene. That of venus is beyond the 20 disparities of the benchmark.
constexpr std::array<int, 4> kShifts{5, 22, 9, 30};

/// algorithm, configuration, measure -> tsukuba, venus, teddy, cones, average.
std::map<std::string, std::vector<double>> read_csv(const std::string& path) {
  std::istringstream file(bytes(path));
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "algorithm,configuration,measure,tsukuba,venus,teddy,cones,average");
  std::map<std::string, std::vector<double>> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string name, cell;
    for (int i = 0; i < 3; ++i) {
      std::getline(cells, cell, ',');
      name += (i > 0 ? " " : "") + cell;
    }
    while (std::getline(cells, cell, ',')) rows[name].push_back(std::stod(cell));
  }
  return rows;
}

class Evaluate : public ProgramTest {
 protected:
  void write_tree() const {
    for (std::size_t i = 0; i < kMiddleburyScenes.size(); ++i) {
      const MiddleburyScene& scene = kMiddleburyScenes[i];
      const std::string folder = std::string("data/") + scene.name + "/";
      const NoisePair pair = noise_pair(kSize, kShifts[i], static_cast<int>(i) + 1);
      write(folder + "imL.png", pair.left);
      write(folder + "imR.png", pair.right);
      cv::Mat1b truth(kSize, static_cast<std::uint8_t>(kShifts[i] * scene.truth_scale));
      truth(kWrongTruth) = static_cast<std::uint8_t>((kShifts[i] + 2) * scene.truth_scale);
      write(folder + "groundtruth.png", truth);
      write(folder + "all.png", mask(kAllRect, 0));
      cv::Mat three_channels;
      cv::merge(std::vector<cv::Mat>(3, mask(kNonOccludedRect, 0)), three_channels);
      write(folder + "nonocc.png", three_channels);
      write(folder + "disc.png", mask(kDiscRect, 128));
    }
  }
  static cv::Mat1b mask(const cv::Rect& evaluated, int elsewhere) {
    cv::Mat1b image(kSize, static_cast<std::uint8_t>(elsewhere));
    image(evaluated) = 255;
    return image;
  }
  static void expect_row(const std::map<std::string, std::vector<double>>& rows,
                         const std::string& name, double value, double venus) {
    ASSERT_EQ(rows.count(name), 1U) << name;
    const std::vector<double>& row = rows.at(name);
    ASSERT_EQ(row.size(), 5U) << name;
    for (const std::size_t i : {0, 2, 3}) EXPECT_NEAR(row[i], value, 1e-4) << name << " " << i;
    EXPECT_NEAR(row[1], venus, 1e-4) << name << " venus";
    EXPECT_NEAR(row[4], (3 * value + venus) / 4, 1e-4) << name << " average";
  }
};

TEST_F(Evaluate, KnownPercentages) {
  write_tree();
  const Outcome run = evaluate({at("data"), "--csv", at("out.csv"), "--disparity_range", "64",
                                "--raw", "--pictures", at("a/b")});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto rows = read_csv(at("out.csv"));
  EXPECT_EQ(rows.size(), 2U * kWindowRows + 2U * kSgmRows + 4U * kRawRows);
  for (const std::string algorithm : {"window sparse", "window full", "sgm full", "sgm small"}) {
    for (const std::string configuration : {" dense ", " raw ", " filled "}) {
      if (algorithm.find("sgm") == 0 && configuration == " filled ") continue;
      expect_row(rows, algorithm + configuration + "nonocc", kNonocc, kNonocc);
      expect_row(rows, algorithm + configuration + "all", kAllBad, kAllBad);
      expect_row(rows, algorithm + configuration + "disc", kDisc, kDisc);
      expect_row(rows, algorithm + configuration + "mean", kMean, kMean);
    }
    expect_row(rows, algorithm + " semi-dense nonocc", kNonocc, kNonocc);
    expect_row(rows, algorithm + " semi-dense coverage", 100, 100);
    for (const std::string configuration : {" dense ", " semi-dense "}) {
      const std::vector<double>& rms = rows.at(algorithm + configuration + "rms");
      for (const double value : rms) EXPECT_LT(value, 0.2) << algorithm << configuration;
      // Without tsukuba.
      EXPECT_NEAR(rms[4], (rms[1] + rms[2] + rms[3]) / 3, 1e-4);
    }
  }
  // The table has a title, a header and all rows; its lines have equal width.
  std::istringstream table(run.out);
  std::string line;
  std::vector<std::size_t> widths;
  while (std::getline(table, line)) widths.push_back(line.size());
  ASSERT_EQ(widths.size(), rows.size() + 2) << run.out;
  for (std::size_t i = 2; i < widths.size(); ++i) EXPECT_EQ(widths[i], widths[1]) << run.out;
  EXPECT_NE(run.out.find("30.95"), std::string::npos) << run.out;  // kMean

  const cv::Mat errors =
      cv::imread(at("a/b/teddy_window_full_raw_errors.png"), cv::IMREAD_UNCHANGED);
  cv::Mat1b expected(kSize, std::uint8_t{128});
  expected(kAllRect) = 0;
  expected(kWrongTruth) = 255;
  EXPECT_TRUE(equal(errors, expected));
  EXPECT_EQ(cv::imread(at("a/b/venus_sgm_small_semi-dense_disparity.png")).size(), kSize);
}

TEST_F(Evaluate, SearchesTheRangeOfTheBenchmark) {
  write_tree();
  const Outcome run = evaluate({at("data"), "--csv", at("out.csv"), "--stereo_algorithm", "window",
                                "--census_pattern", "full", "--raw", "--threads", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto rows = read_csv(at("out.csv"));
  EXPECT_EQ(rows.size(), 1U * kWindowRows + kRawRows);  // a single algorithm
  expect_row(rows, "window full raw nonocc", kNonocc, 100);
  expect_row(rows, "window full raw mean", kMean, 100);
}

// OpenCV finds the same disparities in the columns that it computes; the columns to their left are
// filled holes.
TEST_F(Evaluate, OpencvMatchers) {
  write_tree();
  const Outcome run = evaluate({at("data"), "--csv", at("out.csv"), "--disparity_range", "32",
                                "--stereo_algorithm", "window", "--opencv"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto rows = read_csv(at("out.csv"));
  EXPECT_EQ(rows.size(), 2U * kWindowRows + 4U * kPeerRows);
  for (const std::string peer : {"StereoBM", "StereoSGBM", "StereoSGBM_3WAY", "StereoSGBM_HH"}) {
    expect_row(rows, peer + " filled nonocc", kNonocc, kNonocc);
    expect_row(rows, peer + " filled disc", kDisc, kDisc);
    expect_row(rows, peer + " semi-dense nonocc", kNonocc, kNonocc);
    EXPECT_GT(rows.at(peer + " semi-dense coverage")[0], 60) << peer;
    for (const double rms : rows.at(peer + " semi-dense rms")) EXPECT_LT(rms, 0.2) << peer;
  }
}

TEST_F(Evaluate, ParametersReachEveryConfiguration) {
  write_tree();
  ASSERT_EQ(evaluate({at("data"), "--csv", at("out.csv"), "--raw", "--min_disparity", "7",
                      "--disparity_range", "32"})
                .code,
            0);
  const auto rows = read_csv(at("out.csv"));
  // 5 px, the disparity of tsukuba, is more than 1 px below the search range.
  for (const std::string algorithm : {"window sparse", "sgm full"}) {
    for (const std::string configuration : {" dense nonocc", " raw nonocc"}) {
      EXPECT_NEAR(rows.at(algorithm + configuration)[2], kNonocc, 1e-4) << algorithm;
      EXPECT_GT(rows.at(algorithm + configuration)[0], 75) << algorithm << configuration;
    }
  }
}

TEST_F(Evaluate, OptionsLeaveRowsOut) {
  write_tree();
  const auto names = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{at("data"), "--csv", at("out.csv"), "--disparity_range",
                                       "32"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(evaluate(arguments).code, 0);
    std::set<std::string> found;
    for (const auto& [name, values] : read_csv(at("out.csv"))) {
      found.insert(name.substr(0, name.rfind(' ')));
    }
    return found;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(names({"--dense", "true"}), (Names{"window sparse dense", "window full dense",
                                               "sgm full dense", "sgm small dense"}));
  EXPECT_EQ(names({"--stereo_algorithm", "sgm", "--sgm_build", "small", "--dense", "false"}),
            (Names{"sgm small semi-dense"}));
  EXPECT_EQ(names({"--sgm_build", "full", "--census_pattern", "sparse"}),
            (Names{"window sparse dense", "window sparse filled", "window sparse semi-dense",
                   "sgm full dense", "sgm full semi-dense"}));
}

TEST_F(Evaluate, NamesMissingFiles) {
  write_tree();
  std::remove(at("data/teddy/disc.png").c_str());
  Outcome run = evaluate({at("data")});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find(at("data/teddy/disc.png")), std::string::npos) << run.err;
  write("data/teddy/disc.png", cv::Mat1b(3, 4, std::uint8_t{0}));
  run = evaluate({at("data")});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find("disc.png: is 4x3: imL.png is 96x48"), std::string::npos) << run.err;
  run = evaluate({at("nowhere")});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find(at("nowhere/tsukuba")), std::string::npos) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST_F(Evaluate, Usage) {
  EXPECT_EQ(evaluate({"--help"}).code, 0);
  EXPECT_EQ(evaluate({}).code, 2);
  const Outcome run = evaluate({at("data"), "--speckle_size", "1001"});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("0 to 1000"), std::string::npos) << run.err;
}

TEST_F(Evaluate, RealImages) {
  const std::string folder = test_data("middlebury_v2");
  if (folder.empty()) GTEST_SKIP() << "the test images have no folder middlebury_v2";
  const Outcome run = evaluate({folder, "--csv", at("out.csv"), "--raw", "--opencv"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("libpng"), std::string::npos) << run.err;
  const auto rows = read_csv(at("out.csv"));
  EXPECT_NEAR(rows.at("sgm full dense mean")[4], 6.14, 0.005);
  EXPECT_NEAR(rows.at("sgm small dense mean")[4], 6.98, 0.005);
  EXPECT_NEAR(rows.at("sgm full semi-dense nonocc")[4], 2.18, 0.005);
  EXPECT_NEAR(rows.at("sgm full semi-dense coverage")[4], 94.14, 0.005);
  const std::vector<double>& rms = rows.at("sgm full dense rms");
  EXPECT_NEAR(rms[1], 0.148, 0.0005);
  EXPECT_NEAR(rms[2], 0.231, 0.0005);
  EXPECT_NEAR(rms[3], 0.191, 0.0005);
  EXPECT_LE(rows.at("window sparse raw mean")[4], 14.8);
  EXPECT_LE(rows.at("window full raw mean")[4], 15.2);
  EXPECT_LE(rows.at("window sparse semi-dense nonocc")[4], 2.5);
  EXPECT_GE(rows.at("window sparse semi-dense coverage")[4], 80);
  EXPECT_LT(rows.at("window sparse filled mean")[4], rows.at("StereoBM filled mean")[4]);
  EXPECT_LT(rows.at("sgm full dense mean")[4], rows.at("StereoSGBM_HH filled mean")[4]);
}

}  // namespace
}  // namespace fpga_stereo::tools
