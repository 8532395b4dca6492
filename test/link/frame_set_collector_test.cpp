#include "link/frame_set_collector.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using link::AssembledFrame;
using link::FrameSet;
using link::FrameSetCollector;
using link::Stream;
using link::StreamSet;
using Verdict = link::FrameVerdict;

constexpr StreamSet kTwo{Stream::kDisparity, Stream::kRectifiedLeft};
constexpr StreamSet kWithRaw = kTwo | Stream::kRawLeft;

AssembledFrame frame(Stream stream, std::uint64_t id, Verdict verdict = Verdict::kGood) {
  AssembledFrame a;
  a.stream = stream;
  a.frame_id = id;
  a.timestamp = 10 * id;
  a.configuration = 3;
  a.verdict = verdict;
  a.height = 4;
  if (verdict == Verdict::kGood) a.image = cv::Mat1b(4, 4, static_cast<std::uint8_t>(id));
  return a;
}

struct Sets {
  FrameSetCollector sets;
  std::vector<FrameSet> out;

  void end(Stream stream, std::uint64_t id, StreamSet streams, Verdict verdict = Verdict::kGood) {
    sets.add(frame(stream, id, verdict), streams, out);
  }
  std::vector<std::uint64_t> ids() const {
    std::vector<std::uint64_t> all;
    for (const FrameSet& s : out) all.push_back(s.frame_id);
    return all;
  }
};

TEST(FrameSetCollector, WaitForEveryStream) {
  Sets s;
  s.end(Stream::kRectifiedLeft, 7, kTwo);
  EXPECT_TRUE(s.out.empty());
  s.end(Stream::kDisparity, 7, kTwo);
  ASSERT_EQ(s.out.size(), 1U);
  EXPECT_EQ(s.out[0].timestamp, 70U);
  EXPECT_EQ(s.out[0].configuration, 3U);
  EXPECT_FALSE(s.out[0].image(Stream::kDisparity).empty());
  EXPECT_FALSE(s.out[0].image(Stream::kRectifiedLeft).empty());
  EXPECT_TRUE(s.out[0].image(Stream::kRawLeft).empty());
}

TEST(FrameSetCollector, CompleteWithDroppedFrames) {
  Sets s;
  s.end(Stream::kDisparity, 7, kTwo, Verdict::kBadSignature);
  s.end(Stream::kRectifiedLeft, 7, kTwo);
  ASSERT_EQ(s.out.size(), 1U);
  EXPECT_TRUE(s.out[0].image(Stream::kDisparity).empty());
  EXPECT_EQ(s.out[0].dropped,
            std::vector<std::string>{"disparity frame 7 dropped: its signature does not match"});
}

TEST(FrameSetCollector, WaitForRawImagesThatHaveBegun) {
  Sets s;
  s.end(Stream::kRectifiedLeft, 1, kWithRaw);
  s.end(Stream::kDisparity, 1, kWithRaw);
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{1})) << "no raw images accompany this pair";
  s.sets.begin(Stream::kRawLeft, 2, s.out);
  s.end(Stream::kRectifiedLeft, 2, kWithRaw);
  s.end(Stream::kDisparity, 2, kWithRaw);
  EXPECT_EQ(s.out.size(), 1U);
  s.end(Stream::kRawLeft, 2, kWithRaw);
  ASSERT_EQ(s.out.size(), 2U);
  EXPECT_FALSE(s.out[1].image(Stream::kRawLeft).empty());
}

TEST(FrameSetCollector, MayConsistOfRawImagesOnly) {
  Sets s;
  constexpr StreamSet kRaw{Stream::kRawLeft, Stream::kRawRight};
  s.end(Stream::kRawLeft, 1, kRaw);
  EXPECT_TRUE(s.out.empty());
  s.end(Stream::kRawRight, 1, kRaw);
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{1}));
}

TEST(FrameSetCollector, KeepTheOrderOfFramesAcrossTheWrap) {
  Sets s;
  const std::uint64_t last = ~std::uint64_t{0};
  s.end(Stream::kRectifiedLeft, last, kTwo);
  s.end(Stream::kRectifiedLeft, 0, kTwo);
  s.end(Stream::kDisparity, 0, kTwo);
  EXPECT_TRUE(s.out.empty()) << "the last set is in flight";
  s.end(Stream::kDisparity, last, kTwo);
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{last, 0}));
}

TEST(FrameSetCollector, DoNotWaitLongForALostFrame) {
  Sets s;
  for (std::uint64_t id = 1; id <= 5; ++id) {
    s.end(Stream::kRectifiedLeft, id, kTwo);
    if (id != 1) s.end(Stream::kDisparity, id, kTwo);
  }
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(s.out[0].image(Stream::kDisparity).empty());
}

TEST(FrameSetCollector, KeepAFewWhateverBegins) {
  Sets s;
  s.end(Stream::kRectifiedLeft, 5000, kTwo);
  for (std::uint64_t id = 4000; id > 0; --id) s.sets.begin(Stream::kDisparity, id, s.out);
  EXPECT_TRUE(s.out.empty()) << "nothing of what was forgotten had ended";
  s.sets.reset(s.out);
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{5000}));
}

TEST(FrameSetCollector, DropImagesOfAnotherSize) {
  Sets s;
  s.end(Stream::kRectifiedLeft, 7, kTwo);
  AssembledFrame other = frame(Stream::kDisparity, 7);
  other.image = cv::Mat1w(4, 5);
  s.sets.add(std::move(other), kTwo, s.out);
  ASSERT_EQ(s.out.size(), 1U);
  EXPECT_FALSE(s.out[0].image(Stream::kRectifiedLeft).empty());
  EXPECT_TRUE(s.out[0].image(Stream::kDisparity).empty());
  ASSERT_EQ(s.out[0].dropped.size(), 1U);
  EXPECT_EQ(s.out[0].dropped[0],
            "disparity frame 7 dropped: another image of its pair has another size");
}

TEST(FrameSetCollector, AreReturnedIncompleteByReset) {
  Sets s;
  s.end(Stream::kDisparity, 3, kTwo);
  s.sets.reset(s.out);
  EXPECT_EQ(s.ids(), (std::vector<std::uint64_t>{3}));
  s.sets.reset(s.out);
  EXPECT_EQ(s.out.size(), 1U);
}

}  // namespace
}  // namespace fpga_stereo::test
