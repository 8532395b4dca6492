#include "fpga_stereo/link/streams.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fpga_stereo::test {
namespace {

using link::Stream;
using link::StreamSet;

TEST(StreamSet, HoldsStreams) {
  StreamSet set{Stream::kDisparity, Stream::kRawLeft};
  EXPECT_TRUE(set.contains(Stream::kDisparity));
  EXPECT_FALSE(set.contains(Stream::kRawRight));
  EXPECT_FALSE(set.contains(Stream::kNone));
  EXPECT_EQ(set.bits(), 1U << kStreamDisparity | 1U << kStreamRawLeft);
  set.insert(Stream::kRawRight);
  set.erase(Stream::kDisparity);
  EXPECT_EQ(set, (StreamSet{Stream::kRawRight, Stream::kRawLeft}));
  EXPECT_TRUE(StreamSet().empty());
  EXPECT_FALSE(set.empty());
}

TEST(StreamSet, CombinesSets) {
  constexpr StreamSet kRaw{Stream::kRawLeft, Stream::kRawRight};
  constexpr StreamSet kLeft{Stream::kRectifiedLeft, Stream::kRawLeft};
  EXPECT_EQ(kRaw & kLeft, StreamSet(Stream::kRawLeft));
  EXPECT_EQ(kRaw - kLeft, StreamSet(Stream::kRawRight));
  EXPECT_EQ(kRaw | kLeft, kLeft | Stream::kRawRight);
  EXPECT_TRUE((kRaw | kLeft).contains_all(kRaw));
  EXPECT_FALSE(kLeft.contains_all(kRaw));
  EXPECT_TRUE(kLeft.contains_any(kRaw));
  EXPECT_FALSE(kRaw.contains_any(Stream::kDisparity));
}

TEST(StreamSet, IgnoresBitsThatStandForNoStream) {
  EXPECT_EQ(StreamSet::from_bits(0xFFFFFFFF), StreamSet::all());
  EXPECT_EQ(StreamSet::from_bits(1), StreamSet());
}

TEST(StreamSet, VisitsItsStreamsInOrder) {
  std::vector<Stream> visited;
  for (const Stream stream : StreamSet{Stream::kInput, Stream::kDisparity, Stream::kRawLeft}) {
    visited.push_back(stream);
  }
  EXPECT_EQ(visited, (std::vector<Stream>{Stream::kDisparity, Stream::kRawLeft, Stream::kInput}));
  EXPECT_EQ(link::to_text({Stream::kDisparity, Stream::kRawLeft}), "disparity, raw left");
  EXPECT_EQ(link::to_text({}), "none");
}

}  // namespace
}  // namespace fpga_stereo::test
