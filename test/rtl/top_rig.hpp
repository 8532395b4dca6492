// Runs the whole simulated gateware and the reference pipeline on the same pairs and compares them.
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
#include "sim/gateware/gateware.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {

/// A build of the gateware and pipeline parameters that it supports.
struct TopBuild {
  std::string name;
  std::string numbers;  // MaxWidth_..._MeshNodes, as in the file name by build_model
  Parameters parameters = window_parameters();
};

inline std::ostream& operator<<(std::ostream& out, const TopBuild& build) {
  return out << build.name;
}

inline TopBuild top_build(const std::string& name, const std::string& numbers, int disparities,
                          int census, CensusPattern pattern, int correlation) {
  TopBuild build{name, numbers, window_parameters()};
  build.parameters.disparity_range = disparities;
  build.parameters.census_window_size = census;
  build.parameters.census_pattern = pattern;
  build.parameters.correlation_window_size = correlation;
  build.parameters.speckle_size = 30;  // the images of these tests are small
  return build;
}

/// Opens the model of a build; throws if that fails. `seed` selects the initial register values.
inline sim::Gateware open_gateware(const TopBuild& build, std::uint32_t seed = 1) {
  auto gateware = sim::Gateware::open(
      std::string(FPGA_STEREO_MODELS) + "/fs_top_" + build.numbers + ".so", seed);
  if (!gateware) throw std::runtime_error(gateware.error().message);
  return std::move(*gateware);
}

inline StereoRectification identity_rectification(cv::Size size, int min_disparity = 0) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return identity_rectification(geometry, min_disparity);
}

/// Returns the rectification of two cameras whose lenses distort in opposite directions and which
/// are rotated against each other. A `strength` of 1 moves the image corners by a few percent.
inline StereoRectification distorted_rectification(cv::Size size, double strength,
                                                   int min_disparity = 0) {
  const double f = size.width;
  const auto camera = [&](double k1, double turn, double p3) {
    const double c = std::cos(turn), s = std::sin(turn);
    CameraCalibration calibration;
    calibration.width = size.width;
    calibration.height = size.height;
    calibration.distortion_model = "plumb_bob";
    calibration.D = {k1, 0.01 * strength, 0.002 * strength, -0.001 * strength, 0};
    calibration.K = {f, 0, size.width / 2.0, 0, f, size.height / 2.0, 0, 0, 1};
    calibration.R = {c, -s, 0, s, c, 0, 0, 0, 1};
    calibration.P = {f, 0, size.width / 2.0, p3, 0, f, size.height / 2.0, 0, 0, 0, 1, 0};
    return calibration;
  };
  const auto rectification =
      make_stereo_rectification(camera(-0.15 * strength, 0.015 * strength, 0),
                                camera(0.12 * strength, -0.01 * strength, -0.1 * f), min_disparity);
  if (!rectification) throw std::runtime_error(rectification.error().message);
  return *rectification;
}

/// Input of the gateware and of the reference pipeline.
struct TopCase {
  Parameters parameters = window_parameters();
  StereoRectification rectification;
  std::vector<sim::GreyPair> pairs;
  std::string about;
};

/// Output of the reference pipeline.
struct Expected {
  std::vector<cv::Mat1w> disparities;
  std::array<std::uint32_t, kNumGatewareStages> signatures{};  // of the last pair
};

inline Expected run_reference(const TopCase& c) {
  Expected expected;
  ReferencePipeline pipeline;
  for (const sim::GreyPair& pair : c.pairs) {
    const Taps& taps = pipeline.process(pair.left, pair.right, c.rectification, c.parameters, 1);
    expected.disparities.push_back(taps.disparity.clone());
    if (&pair == &c.pairs.back()) expected.signatures = stage_signatures(taps, c.parameters);
  }
  return expected;
}

/// Returns the names of the stages whose signatures differ, in pipeline order; "" if all are equal.
inline std::string differing_stages(const std::array<std::uint32_t, kNumGatewareStages>& a,
                                    const std::array<std::uint32_t, kNumGatewareStages>& b) {
  std::string names;
  for (int stage = 0; stage < kNumGatewareStages; ++stage) {
    if (a[stage] != b[stage])
      names += (names.empty() ? "" : " ") + std::string(gateware_stage_name(stage));
  }
  return names;
}

/// Runs a case and expects every disparity image, and each stage's signature of the last frame, to
/// equal those of the reference pipeline. Returns the frames of the gateware.
inline std::vector<sim::Frame> expect_equal(sim::Gateware& gateware, const TopCase& c,
                                            const sim::Flow& flow = {}) {
  SCOPED_TRACE(c.about);
  const Status configured = gateware.apply(c.parameters, c.rectification);
  EXPECT_TRUE(configured) << configured.error().message;
  if (!configured) return {};
  const Expected expected = run_reference(c);
  const auto frames = gateware.process(c.pairs, flow);
  EXPECT_TRUE(frames) << frames.error().message;
  if (!frames) return {};
  EXPECT_EQ(frames->size(), c.pairs.size());
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const Case where{c.parameters, flow.seed, "frame " + std::to_string(i)};
    EXPECT_TRUE(same("disparity", expected.disparities[i], (*frames)[i].disparity, where));
    EXPECT_FALSE((*frames)[i].bad) << "frame " << i;
  }
  EXPECT_EQ(differing_stages(expected.signatures, gateware.signatures()), "")
      << "stages that differ";
  return *frames;
}

/// Returns pairs that show a textured slanted plane, so that some disparities pass the checks.
inline std::vector<sim::GreyPair> textured_pairs(cv::Size size, int count, unsigned seed,
                                                 double disparity = 4.2) {
  std::vector<sim::GreyPair> pairs;
  for (int i = 0; i < count; ++i) {
    const SlantedPair pair = slanted_pair(size, Texture(seed + i), disparity + 0.3 * i, 0.01);
    pairs.push_back({pair.left, pair.right});
  }
  return pairs;
}

}  // namespace fpga_stereo::test
