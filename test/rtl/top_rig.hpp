// For tests of the whole gateware: it runs beside the pipeline in software, which it must equal.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/reference_pipeline.hpp"
#include "core/signature.hpp"
#include "sim/gateware.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {

/// A build of the gateware and the parameters that go with it.
struct TopBuild {
  std::string name;
  std::string numbers;  // MaxWidth_..._MeshNodes, as build_model names the file
  Parameters parameters;
};

inline std::ostream& operator<<(std::ostream& out, const TopBuild& build) {
  return out << build.name;
}

inline TopBuild top_build(const std::string& name, const std::string& numbers, int disparities,
                          int census, CensusPattern pattern, int correlation) {
  TopBuild build{name, numbers, {}};
  build.parameters.disparity_range = disparities;
  build.parameters.census_window_size = census;
  build.parameters.census_pattern = pattern;
  build.parameters.correlation_window_size = correlation;
  build.parameters.speckle_size = 30;  // the images of these tests are small
  return build;
}

inline sim::Gateware open(const TopBuild& build, std::uint32_t seed = 1) {
  auto opened = sim::Gateware::open(
      std::string(FPGA_STEREO_MODELS) + "/fs_top_" + build.numbers + ".so", seed);
  if (!opened) throw std::runtime_error(opened.error().message);
  return std::move(*opened);
}

inline StereoRectification unmoved(cv::Size size, int min_disparity = 0) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return identity_rectification(geometry, min_disparity);
}

/// Cameras whose lenses bend the image, the left outwards and the right inwards, and which look a
/// little past each other. `strength` 1 moves the corners of the image by some percent.
inline StereoRectification distorted(cv::Size size, double strength, int min_disparity = 0) {
  const double f = size.width;
  const auto camera = [&](double k1, double turn, double p3) {
    const double c = std::cos(turn), s = std::sin(turn);
    CameraCalibration made;
    made.width = size.width;
    made.height = size.height;
    made.distortion_model = "plumb_bob";
    made.D = {k1, 0.01 * strength, 0.002 * strength, -0.001 * strength, 0};
    made.K = {f, 0, size.width / 2.0, 0, f, size.height / 2.0, 0, 0, 1};
    made.R = {c, -s, 0, s, c, 0, 0, 0, 1};
    made.P = {f, 0, size.width / 2.0, p3, 0, f, size.height / 2.0, 0, 0, 0, 1, 0};
    return made;
  };
  const auto made =
      make_stereo_rectification(camera(-0.15 * strength, 0.015 * strength, 0),
                                camera(0.12 * strength, -0.01 * strength, -0.1 * f), min_disparity);
  if (!made) throw std::runtime_error(made.error().message);
  return *made;
}

/// What both sides get.
struct TopCase {
  Parameters parameters;
  StereoRectification rectification;
  std::vector<sim::RawPair> pairs;
  std::string about;
};

struct Expected {
  std::vector<cv::Mat1w> disparities;
  std::array<std::uint32_t, kNumStages> signatures{};  // of the last pair
};

inline Expected in_software(const TopCase& c) {
  Expected expected;
  ReferencePipeline pipeline;
  for (const sim::RawPair& pair : c.pairs) {
    const Taps& taps = pipeline.process(pair.left, pair.right, c.rectification, c.parameters, 1);
    expected.disparities.push_back(taps.disparity.clone());
    if (&pair == &c.pairs.back()) expected.signatures = stage_signatures(taps, c.parameters);
  }
  return expected;
}

/// The stages whose signatures differ, in data order; "" = none.
inline std::string differing(const std::array<std::uint32_t, kNumStages>& a,
                             const std::array<std::uint32_t, kNumStages>& b) {
  std::string names;
  for (int stage = 0; stage < kNumStages; ++stage) {
    if (a[stage] != b[stage]) names += (names.empty() ? "" : " ") + std::string(kStageNames[stage]);
  }
  return names;
}

/// The gateware gives what software gives, for every frame and, of the last, after every stage.
inline std::vector<sim::Frame> expect_equal(sim::Gateware& gateware, const TopCase& c,
                                            const sim::Flow& flow = {}) {
  SCOPED_TRACE(c.about);
  const Status configured = gateware.configure(c.parameters, c.rectification);
  EXPECT_TRUE(configured) << configured.error().message;
  if (!configured) return {};
  const Expected expected = in_software(c);
  const auto made = gateware.process(c.pairs, flow);
  EXPECT_TRUE(made) << made.error().message;
  if (!made) return {};
  EXPECT_EQ(made->size(), c.pairs.size());
  for (std::size_t i = 0; i < made->size(); ++i) {
    const Case where{c.parameters, flow.seed, "frame " + std::to_string(i)};
    EXPECT_TRUE(same("disparity", expected.disparities[i], (*made)[i].disparity, where));
    EXPECT_FALSE((*made)[i].bad) << "frame " << i;
  }
  EXPECT_EQ(differing(expected.signatures, gateware.signatures()), "") << "stages that differ";
  return *made;
}

/// Pairs with structure: slanted planes, so that some pixels pass the checks.
inline std::vector<sim::RawPair> textured(cv::Size size, int count, unsigned seed,
                                          double disparity = 4.2) {
  std::vector<sim::RawPair> pairs;
  for (int i = 0; i < count; ++i) {
    const SlantedPair pair = slanted_pair(size, Texture(seed + i), disparity + 0.3 * i, 0.01);
    pairs.push_back({pair.left, pair.right});
  }
  return pairs;
}

}  // namespace fpga_stereo::test
