// Compares the whole gateware (fs_top) with the reference pipeline over sequences of frames,
// settings and meshes.
#include <gtest/gtest.h>

#include "fpga_stereo/core/spec.hpp"
#include "support/data_test.hpp"
#include "top_rig.hpp"

namespace fpga_stereo::test {
namespace {

using sim::Frame;
using sim::Gateware;
using sim::GreyPair;
using sim::Pixel;

const TopBuild kSparse =
    top_build("sparse", "640_16_11_15_0_102_5120", 16, 11, CensusPattern::kSparse, 15);
const TopBuild kFull =
    top_build("full", "640_20_11_15_1_102_5120", 20, 11, CensusPattern::kFull, 15);
const TopBuild kOther =
    top_build("other", "752_32_11_5_0_104_6144", 32, 11, CensusPattern::kSparse, 5);

class RtlTop : public ::testing::TestWithParam<TopBuild> {
 protected:
  Gateware open_model(std::uint32_t seed = 1) const { return open_gateware(GetParam(), seed); }
  Parameters parameters() const { return GetParam().parameters; }
  int min_width() const { return std::max(16, parameters().correlation_window_size + 1); }
};
INSTANTIATE_TEST_SUITE_P(Builds, RtlTop, ::testing::Values(kSparse, kFull, kOther),
                         [](const auto& build) { return build.param.name; });

std::vector<GreyPair> noise_pairs(cv::Size size, int count, unsigned seed) {
  std::vector<GreyPair> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back({random_image(size, seed + 2 * i), random_image(size, seed + 2 * i + 1)});
  }
  return pairs;
}

/// Varies every parameter that may change between frames at random, sometimes to its maximum.
Parameters varied_parameters(Parameters p, unsigned seed) {
  cv::RNG random(seed + 1);
  const auto any = [&](int usual, int largest) {
    return random.uniform(0, 4) == 0 ? largest : random.uniform(0, usual + 1);
  };
  p.left_right_check = random.uniform(0, 2) != 0;
  p.uniqueness_check = random.uniform(0, 2) != 0;
  p.subpixel = random.uniform(0, 2) != 0;
  p.disp12MaxDiff = any(3, 128);
  p.uniqueness_ratio = any(50, 100);
  p.speckle_size = any(60, kSpeckleMax);
  p.speckle_range = any(4, 31);
  return p;
}

TEST_P(RtlTop, ReportsItsBuildAndResetValues) {
  Gateware gateware = open_model();
  EXPECT_EQ(gateware.read(spec::kRegIdentity), spec::kRegIdentityReset);
  EXPECT_EQ(gateware.read(spec::kRegSpecHash), kSpecHash);
  EXPECT_EQ(gateware.read(spec::kRegVersion), spec::kRegVersionReset);
  const sim::ModelParameters& model = gateware.model_parameters();
  const GatewareBuild& build = gateware.build();
  EXPECT_EQ(build.max_width, model.max_width);
  EXPECT_EQ(build.disparities, model.disparities);
  EXPECT_EQ(build.census_window, model.census_window);
  EXPECT_EQ(build.correlation_window, model.correlation_window);
  EXPECT_EQ(build.census_pattern == CensusPattern::kFull, model.census_full != 0);
  EXPECT_EQ(build.line_rows, model.line_rows);
  EXPECT_EQ(build.mesh_nodes, model.mesh_nodes);
  EXPECT_EQ(build.disparities, parameters().disparity_range);
  for (const spec::Register& r : spec::register_table()) {
    if (!r.reset || r.address >= kLinkFirstRegister) continue;
    EXPECT_EQ(gateware.read(r.address), r.access == spec::Access::kWriteOnly ? 0 : *r.reset)
        << r.name;
  }
}

TEST_P(RtlTop, EqualsSoftwareAtManySizesBackToBack) {
  Gateware gateware = open_model();
  unsigned seed = 10;
  // Some images are smaller than the windows and than the minimum distance between frames.
  for (const cv::Size size :
       {cv::Size(0, 1), cv::Size(0, 2), cv::Size(1, 7), cv::Size(3, 8), cv::Size(0, 15),
        cv::Size(7, 16), cv::Size(15, 31), cv::Size(48, 20), cv::Size(81, 61)}) {
    const cv::Size padded(size.width + min_width(), size.height);
    ++seed;
    for (const auto& pairs : {noise_pairs(padded, 3, seed), textured_pairs(padded, 3, seed)}) {
      TopCase c{varied_parameters(parameters(), seed), identity_rectification(padded), pairs, ""};
      c.about = std::to_string(padded.width) + " x " + std::to_string(padded.height);
      expect_equal(gateware, c);
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST_P(RtlTop, EqualsSoftwareOnExtremeImages) {
  const cv::Size size(41, 37);
  std::vector<GreyPair> pairs;
  for (const NamedImage& named : extreme_images(size, 5)) {
    pairs.push_back({named.image, named.image});
    pairs.push_back({named.image, 255 - named.image});
  }
  cv::Mat1b bright(size, std::uint8_t{0});
  bright(20, 25) = 255;
  cv::Mat1b moved(size, std::uint8_t{0});
  moved(20, 20) = 255;
  pairs.push_back({bright, moved});
  Gateware gateware = open_model();
  expect_equal(gateware, {parameters(), identity_rectification(size), pairs, "checked"});
  Parameters unchecked = parameters();
  unchecked.left_right_check = unchecked.uniqueness_check = false;
  unchecked.speckle_size = 0;
  expect_equal(gateware, {unchecked, identity_rectification(size), pairs, "unchecked"});
}

TEST_P(RtlTop, EqualsSoftwareWithStallsAtInputAndOutput) {
  const cv::Size size(37, 30);
  Gateware gateware = open_model();
  unsigned seed = 1;
  for (const double valid : {0.05, 0.5, 1.0}) {
    for (const double ready : {0.05, 0.5, 1.0}) {
      sim::Flow flow;
      flow.valid = valid;
      flow.ready = ready;
      flow.seed = ++seed;
      expect_equal(
          gateware,
          {parameters(), distorted_rectification(size, 1), textured_pairs(size, 3, seed), ""},
          flow);
    }
  }
}

TEST_P(RtlTop, EqualsSoftwareWithLensesAndMinDisparity) {
  Gateware gateware = open_model();
  for (const cv::Size size : {cv::Size(120, 80), cv::Size(97, 73)}) {
    for (const double strength : {0.3, 1.0, 2.0}) {
      for (const int min_disparity : {0, -3, 5}) {
        Parameters p = parameters();
        p.min_disparity = min_disparity;
        expect_equal(gateware,
                     {p, distorted_rectification(size, strength, min_disparity),
                      textured_pairs(size, 1, 3), "strength " + std::to_string(strength)});
      }
    }
  }
}

TEST_P(RtlTop, ChangesSettingsSizesAndMeshesAfterTheFrameInFlight) {
  Gateware gateware = open_model();
  constexpr int kFrames = 12;
  std::vector<Expected> expected;
  std::vector<bool> may_be_bad;  // in flight while a mesh is written
  int last_pairs = 0;
  std::vector<Frame> frames;
  const auto append = [&](Result<std::vector<Frame>> received) {
    ASSERT_TRUE(received) << received.error().message;
    frames.insert(frames.end(), received->begin(), received->end());
  };
  cv::RNG random(7);
  sim::Flow flow;
  TopCase c;
  for (int i = 0; i < kFrames; ++i) {
    const bool has_new_meshes = i % 3 != 1;
    if (has_new_meshes) {
      const cv::Size size(33 + 2 * i, 20 + 3 * i);
      c.rectification = distorted_rectification(size, random.uniform(0.0, 2.0));
    }
    c.parameters = varied_parameters(parameters(), i / 2);
    c.pairs = textured_pairs(c.rectification.geometry.image_size, 1 + i % 2, 20 + i);
    expected.push_back(run_reference(c));
    // An apply waits until no frame is in flight, so only those behind the last one are.
    if (has_new_meshes) std::fill(may_be_bad.end() - last_pairs, may_be_bad.end(), true);
    last_pairs = static_cast<int>(c.pairs.size());
    may_be_bad.resize(may_be_bad.size() + c.pairs.size(), false);
    const auto configuration =
        make_gateware_configuration(gateware.build(), c.parameters, c.rectification);
    ASSERT_TRUE(configuration);
    std::vector<RegisterWrite> writes = configuration->writes();
    if (!has_new_meshes) {
      const auto is_mesh = [](const RegisterWrite& w) {
        return w.address == spec::kRegMeshAddress || w.address == spec::kRegMeshData;
      };
      writes.erase(std::remove_if(writes.begin(), writes.end(), is_mesh), writes.end());
    }
    // Every other time, the registers are written while the previous frame is streaming.
    if (i % 2 == 0) {
      for (const RegisterWrite& w : writes) gateware.write(w.address, w.value);
    } else {
      flow.writes = writes;
      append(gateware.stream({}, 0, flow));
      flow.writes.clear();
    }
    append(gateware.stream(to_pixels(c.pairs), 0, flow));
    flow.seed = i;
    flow.valid = flow.ready = i % 4 == 3 ? 0.5 : 1;
  }
  std::size_t count = 0;
  for (const Expected& e : expected) count += e.disparities.size();
  ASSERT_LT(frames.size(), count) << "no frame was in flight";
  append(gateware.stream({}, count - frames.size()));
  std::size_t i = 0, bad = 0;
  for (const Expected& e : expected) {
    for (const cv::Mat1w& disparity : e.disparities) {
      const Frame& frame = frames[i];
      EXPECT_TRUE(may_be_bad[i] || !frame.bad) << "frame " << i;
      bad += frame.bad ? 1 : 0;
      if (!frame.bad) {
        EXPECT_TRUE(same("disparity of frame " + std::to_string(i), disparity, frame.disparity));
      }
      ++i;
    }
  }
  EXPECT_GE(bad, 1U) << "no mesh was written while a frame was in flight";
  EXPECT_LE(bad, count / 2);
  EXPECT_EQ(differing_stages(expected.back().signatures, gateware.signatures()), "");
  EXPECT_EQ(gateware.counters().mesh_uploads, kFrames * 2 / 3);
  EXPECT_EQ(gateware.counters().frames_out, count);
  EXPECT_EQ(gateware.counters().buffer_errors, bad);
}

TEST_P(RtlTop, ProcessesOnePixelPerClock) {
  Gateware gateware = open_model();
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(39, 25)}) {
    const auto frames = expect_equal(gateware, {parameters(), distorted_rectification(size, 1),
                                                textured_pairs(size, 6, 1), "steady state"});
    ASSERT_EQ(frames.size(), 6U);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      SCOPED_TRACE(i);
      EXPECT_EQ(frames[i].last_out - frames[i].first_out, size.area() - 1);
      if (i == 0) continue;
      const int gap = parameters().correlation_window_size / 2 * size.width;
      // The first frame finds the FIFO at the input empty.
      if (i > 1) {
        EXPECT_EQ(frames[i].last_in - frames[i - 1].last_in, size.area() + gap);
      }
      EXPECT_EQ(frames[i].first_out - frames[i - 1].first_out, size.area() + gap);
    }
  }
}

TEST_P(RtlTop, PutsOutNothingAfterTheLastFrame) {
  const cv::Size size(30, 20);
  Gateware gateware = open_model();
  const TopCase c{parameters(), identity_rectification(size), textured_pairs(size, 2, 1), ""};
  expect_equal(gateware, c);
  gateware.idle(100 * size.width);
  const auto nothing = gateware.stream({}, 0);
  ASSERT_TRUE(nothing) << nothing.error().message;
  EXPECT_TRUE(nothing->empty());
  EXPECT_EQ(gateware.counters().frames_in, 2U);
  EXPECT_EQ(gateware.counters().frames_out, 2U);
  EXPECT_EQ(gateware.read(spec::kRegStatus) & spec::kStatusBusy.mask(), 0U);
  expect_equal(gateware, c);
}

TEST_P(RtlTop, FlagsFramesThatAreCutOrTooLong) {
  const cv::Size size(34, 26);
  Gateware gateware = open_model();
  const TopCase c{parameters(), distorted_rectification(size, 1), textured_pairs(size, 1, 9), ""};
  ASSERT_TRUE(gateware.apply(c.parameters, c.rectification));
  const Expected expected = run_reference(c);
  const std::vector<Pixel> good = to_pixels(c.pairs);
  const auto without = [&](int first, int count) {
    std::vector<Pixel> words = good;
    words.erase(words.begin() + first, words.begin() + first + count);
    return words;
  };
  std::vector<Pixel> long_frame = good;
  long_frame.insert(long_frame.end(), good.begin() + 34, good.begin() + 3 * 34);
  std::vector<Pixel> long_line = good;
  long_line.insert(long_line.begin() + 5 * 34 + 10, 8, Pixel{1, 2, false, false});
  struct Fault {
    std::string about;
    std::vector<Pixel> words;
    bool is_cut, is_long;
  };
  const std::vector<Fault> faults{
      {"cut in the middle of a line", {good.begin(), good.begin() + 34 * 11 + 17}, true, false},
      {"a single pixel", {good.begin(), good.begin() + 1}, true, false},
      {"a row is missing", without(34 * 7, 34), true, false},
      {"the last pixel is missing", without(34 * 26 - 1, 1), true, false},
      {"a short line", without(34 * 7 + 3, 5), true, false},
      {"too many rows", long_frame, false, true},
      {"a long line", long_line, false, true},
  };
  std::uint32_t cut = 0, too_long = 0, frames = 0;
  for (const double flowing : {1.0, 0.4}) {
    sim::Flow flow;
    flow.valid = flow.ready = flowing;
    for (const Fault& fault : faults) {
      SCOPED_TRACE(fault.about);
      cut += fault.is_cut;
      too_long += fault.is_long;
      frames += 3;
      std::vector<Pixel> words = good;
      words.insert(words.end(), fault.words.begin(), fault.words.end());
      words.insert(words.end(), good.begin(), good.end());
      const auto received = gateware.stream(words, 3, flow);
      ASSERT_TRUE(received) << received.error().message;
      ASSERT_EQ(received->size(), 3U);
      EXPECT_FALSE((*received)[0].bad);
      EXPECT_TRUE(same("previous frame", expected.disparities[0], (*received)[0].disparity));
      EXPECT_TRUE((*received)[1].bad);
      EXPECT_EQ((*received)[1].disparity.size(), size);
      EXPECT_FALSE((*received)[2].bad);
      EXPECT_TRUE(same("next frame", expected.disparities[0], (*received)[2].disparity));
      const sim::Counters counters = gateware.counters();
      EXPECT_EQ(counters.cut_frames, cut);
      EXPECT_EQ(counters.long_frames, too_long);
      EXPECT_EQ(counters.frames_in, frames);
      EXPECT_EQ(counters.frames_out, frames);
    }
  }
  EXPECT_EQ(gateware.read(spec::kRegErrors),
            spec::kErrorsCutFrame.mask() | spec::kErrorsLongFrame.mask());
  gateware.write(spec::kRegControl, spec::kControlClear.put(1));
  EXPECT_EQ(gateware.read(spec::kRegErrors), 0U);
  EXPECT_EQ(gateware.counters().cut_frames, 0U);
}

TEST_P(RtlTop, FlagsFramesWhoseMeshReadsOutsideTheLineBuffer) {
  const cv::Size size(34, 26);
  Gateware gateware = open_model();
  const TopCase c{parameters(), distorted_rectification(size, 1), textured_pairs(size, 1, 9), ""};
  expect_equal(gateware, c);
  EXPECT_EQ(gateware.counters().buffer_errors, 0U);
  // Reading starts too early.
  gateware.write(spec::kRegReadStart, spec::kReadStartPixels.put(1));
  gateware.write(spec::kRegControl, spec::kControlApply.put(1));
  const auto bad = gateware.process({c.pairs[0], c.pairs[0]});
  ASSERT_TRUE(bad) << bad.error().message;
  EXPECT_TRUE((*bad)[0].bad);
  EXPECT_TRUE((*bad)[1].bad);
  EXPECT_EQ(gateware.counters().buffer_errors, 2U);
  EXPECT_NE(gateware.read(spec::kRegErrors) & spec::kErrorsBufferLeft.mask(), 0U);
  EXPECT_NE(gateware.read(spec::kRegErrors) & spec::kErrorsBufferRight.mask(), 0U);
  expect_equal(gateware, c);
}

TEST_P(RtlTop, RecoversFromAResetInTheMiddleOfAFrame) {
  const cv::Size size(36, 28);
  Gateware gateware = open_model();
  const TopCase c{parameters(), distorted_rectification(size, 1), textured_pairs(size, 2, 3), ""};
  const std::vector<Pixel> words = to_pixels(c.pairs);
  for (const int sent : {1, 36 * 9 + 5, 36 * 28 - 1, 36 * 40, 36 * 55}) {
    ASSERT_TRUE(gateware.apply(c.parameters, c.rectification));
    ASSERT_TRUE(gateware.stream({words.begin(), words.begin() + sent}, 0));
    gateware.reset(1 + sent % 3);
    EXPECT_EQ(gateware.read(spec::kRegStatus), spec::kRegStatusReset);
    EXPECT_EQ(gateware.counters().frames_in, 0U);
    expect_equal(gateware, c);
    ASSERT_FALSE(HasFailure()) << "after " << sent << " pixels";
  }
}

TEST_P(RtlTop, SignaturesIdentifyTheFirstStageThatDiffers) {
  const cv::Size size(60, 40);
  Gateware gateware = open_model();
  const StereoRectification rectification = identity_rectification(size);
  // Grey values up to 128 leave headroom for brighter pixels.
  const GreyPair bright = textured_pairs(size, 1, 3)[0];
  const std::vector<GreyPair> pairs{{bright.left / 2, bright.right / 2}};
  Parameters p = parameters();
  p.speckle_size = 0;
  const auto expected = run_reference({p, rectification, pairs, ""}).signatures;
  const auto found = [&](const Parameters& given, const GreyPair& pair) {
    EXPECT_TRUE(gateware.apply(given, rectification));
    EXPECT_TRUE(gateware.process({pair}));
    return differing_stages(expected, gateware.signatures());
  };
  const auto first = [](const std::string& names) { return names.substr(0, names.find(' ')); };
  EXPECT_EQ(found(p, pairs[0]), "");
  // Census does not change with brightness.
  EXPECT_EQ(found(p, {pairs[0].left + 9, pairs[0].right}), "rectify");
  cv::Mat1b other = pairs[0].left.clone();
  other(20, 30) += 128;
  EXPECT_EQ(first(found(p, {other, pairs[0].right})), "rectify");
  EXPECT_NE(found(p, {other, pairs[0].right}).find("census"), std::string::npos);
  Parameters changed = p;
  changed.left_right_check = changed.uniqueness_check = false;
  EXPECT_EQ(first(found(changed, pairs[0])), "check");
  changed = p;
  changed.subpixel = false;
  EXPECT_EQ(first(found(changed, pairs[0])), "subpixel");
  changed = p;
  changed.speckle_size = 1000;
  changed.speckle_range = 0;
  EXPECT_EQ(found(changed, pairs[0]), "speckle");
}

TEST_P(RtlTop, RefusesWhatTheBuildDoesNotSupport) {
  const cv::Size size(40, 30);
  Gateware gateware = open_model();
  const auto expect_refused = [&](const Parameters& p, const StereoRectification& r,
                                  const std::vector<std::string>& words) {
    const Status status = gateware.apply(p, r);
    ASSERT_FALSE(status) << words.front();
    for (const std::string& word : words) {
      EXPECT_NE(status.error().message.find(word), std::string::npos)
          << "\"" << word << "\" in: " << status.error().message;
    }
  };
  const GatewareBuild& build = gateware.build();
  Parameters p = parameters();
  p.disparity_range = 64;
  expect_refused(p, identity_rectification(size),
                 {"disparity_range = 64", std::to_string(build.disparities)});
  p = parameters();
  p.census_window_size = 5;
  expect_refused(p, identity_rectification(size),
                 {"census_window_size = 5", std::to_string(build.census_window)});
  p = parameters();
  const bool full = p.census_pattern == CensusPattern::kFull;
  p.census_pattern = full ? CensusPattern::kSparse : CensusPattern::kFull;
  expect_refused(p, identity_rectification(size), {"census_pattern = ", "sparse", "full"});
  p = parameters();
  p.correlation_window_size = 21;
  expect_refused(p, identity_rectification(size), {"correlation_window_size = 21", "built for"});
  p = parameters();
  expect_refused(p, identity_rectification({15, 30}), {"image width = 15", "allows 16 to"});
  expect_refused(p, identity_rectification({build.max_width + 1, 30}),
                 {"image width = ", std::to_string(build.max_width)});
  expect_refused(p, identity_rectification({40, 1201}),
                 {"image height = 1201", "allows 1 to 1200"});
  expect_refused(p, identity_rectification({build.max_width, 1200}),
                 {"nodes of a mesh", std::to_string(build.mesh_nodes)});
  StereoRectification high = identity_rectification({40, 300});
  high.right.mesh.nodes(10, 2)[1] = kMeshScale * 60;
  high.right.mesh.nodes(20, 2)[1] = -kMeshScale * 60;
  high.right.line_buffer = line_buffer_need(high.right.mesh, {40, 300});
  expect_refused(p, high, {"right camera", "line buffer", std::to_string(build.line_rows)});
  // The refused configurations have no effect.
  expect_equal(gateware, {p, identity_rectification(size), textured_pairs(size, 1, 1), ""});
  gateware.write(spec::kRegWidth, build.max_width + 1);
  gateware.write(spec::kRegControl, spec::kControlApply.put(1));
  gateware.idle(8);
  EXPECT_EQ(gateware.read(spec::kRegErrors), spec::kErrorsConfig.mask());
  const auto frames = gateware.process(textured_pairs(size, 1, 1));
  ASSERT_TRUE(frames);
  EXPECT_EQ((*frames)[0].disparity.size(), size);
}

class RtlTopData : public DataTest {};

TEST_F(RtlTopData, EqualsSoftwareOnRealImages) {
  const auto part = [](const std::string& name, cv::Rect rect) {
    const MiddleburyPair pair = middlebury_pair(name);
    return GreyPair{pair.left(rect), pair.right(rect)};
  };
  const cv::Rect rect(90, 80, 171, 93);
  const std::vector<std::pair<TopBuild, std::string>> scenes{
      {kSparse, "tsukuba"}, {kFull, "venus"}, {kOther, "cones"}};
  for (const auto& [build, scene] : scenes) {
    Gateware gateware = open_gateware(build);
    Parameters p = build.parameters;
    p.speckle_size = 200;
    if (scene == "cones") p.min_disparity = 20;
    const auto frames = expect_equal(
        gateware,
        {p, identity_rectification(rect.size(), p.min_disparity), {part(scene, rect)}, scene});
    ASSERT_EQ(frames.size(), 1U);
    const int found = cv::countNonZero(frames[0].disparity != kNoDisparity);
    EXPECT_GT(found, rect.area() / 4) << scene;
  }
}

}  // namespace
}  // namespace fpga_stereo::test
