// Assembling frames: a frame is exactly what was sent, or it is not called good.
#include "link/frame_assembler.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "link/faults.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

using link::AssembledFrame;
using link::FrameAssembler;
using link::Header;
using link::Leader;
using link::PacketType;
using link::Stream;
using link::Trailer;
using Verdict = link::FrameVerdict;

cv::Mat random_frame(cv::Size size, int type, unsigned seed) {
  cv::Mat image(size, type);
  cv::RNG rng(seed);
  rng.fill(image, cv::RNG::UNIFORM, 0, type == CV_8UC1 ? 256 : 65536);
  return image;
}

/// Returns a frame's packets one by one: leader, rows, trailer.
std::vector<Bytes> packets(const cv::Mat& image, std::uint64_t frame_id, int rows_each = 1,
                           std::uint32_t flags = 0, Stream stream = Stream::kNone) {
  const bool wide = image.depth() == CV_16U;
  Header header;
  header.frame_id = frame_id;
  header.stream = stream != Stream::kNone ? stream
                  : wide                  ? Stream::kDisparity
                                          : Stream::kRectifiedLeft;
  header.timestamp = 1000 * frame_id;
  std::vector<Bytes> out;
  const auto add = [&](PacketType type, std::uint16_t index, const auto& payload) {
    header.type = type;
    header.index = index;
    out.emplace_back();
    link::append_packet(header, payload.data(), payload.size(), out.back());
  };
  Leader leader;
  leader.width = static_cast<std::uint16_t>(image.cols);
  leader.height = static_cast<std::uint16_t>(image.rows);
  leader.format = wide ? link::PixelFormat::kDisparity : link::PixelFormat::kGrey;
  leader.configuration = 42;
  add(PacketType::kLeader, 0, pack(leader));
  for (int y = 0; y < image.rows; y += rows_each) {
    Bytes rows;
    for (int i = y; i < std::min(image.rows, y + rows_each); ++i) {
      link::append_row(image.row(i), rows);
    }
    add(PacketType::kRows, static_cast<std::uint16_t>(y), rows);
  }
  Trailer trailer;
  trailer.rows = leader.height;
  trailer.flags = flags;
  trailer.signature = image_signature(image);
  add(PacketType::kTrailer, 0, pack(trailer));
  return out;
}

std::vector<AssembledFrame> assemble(FrameAssembler& assembler, const std::vector<Bytes>& packets) {
  link::Decoder decoder;
  std::vector<AssembledFrame> out;
  for (const Bytes& packet : packets) {
    decoder.push(packet.data(), packet.size());
    while (const auto found = decoder.next()) assembler.add(*found, out);
  }
  return out;
}

TEST(FrameAssembler, AssemblesFramesOfEveryStream) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    for (const cv::Size size : {cv::Size(16, 1), cv::Size(17, 5), cv::Size(23, 12)}) {
      for (const int rows_each : {1, 3}) {
        FrameAssembler assembler;
        const cv::Mat image = random_frame(size, type, 7);
        const auto out = assemble(assembler, packets(image, ~std::uint64_t{0}, rows_each));
        ASSERT_EQ(out.size(), 1U);
        EXPECT_EQ(out[0].verdict, Verdict::kGood);
        EXPECT_TRUE(same("frame", image, out[0].image));
        EXPECT_EQ(out[0].frame_id, ~std::uint64_t{0});
        EXPECT_EQ(out[0].configuration, 42U);
        EXPECT_EQ(assembler.counters().refused_packets, 0U);
      }
    }
  }
}

TEST(FrameAssembler, AcceptsInterleavedStreams) {
  FrameAssembler assembler;
  const cv::Mat disparity = random_frame({20, 6}, CV_16UC1, 1);
  const cv::Mat left = random_frame({20, 6}, CV_8UC1, 2);
  const auto a = packets(disparity, 5), b = packets(left, 5);
  std::vector<Bytes> both;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both.push_back(a[i]);
    both.push_back(b[i]);
  }
  const auto out = assemble(assembler, both);
  ASSERT_EQ(out.size(), 2U);
  EXPECT_TRUE(same("frame", disparity, out[0].image));
  EXPECT_TRUE(same("frame", left, out[1].image));
}

TEST(FrameAssembler, DropsOrMarksFramesThatLackRows) {
  const cv::Mat image = random_frame({20, 6}, CV_16UC1, 1);
  auto sent = packets(image, 7);
  sent.erase(sent.begin() + 2, sent.begin() + 4);  // rows 1 and 2
  FrameAssembler strict;
  auto out = assemble(strict, sent);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_TRUE(out[0].is_dropped());
  EXPECT_EQ(out[0].text(), "disparity frame 7 dropped: 2 of 6 rows are missing");
  EXPECT_EQ(strict.counters().dropped, 1U);

  FrameAssembler lenient(FrameAssembler::Options{true});
  out = assemble(lenient, sent);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_EQ(out[0].verdict, Verdict::kIncomplete);
  cv::Mat expected = image.clone();
  expected.rowRange(1, 3).setTo(kNoDisparity);
  EXPECT_TRUE(same("frame", expected, out[0].image));
  EXPECT_EQ(lenient.counters().incomplete, 1U);

  // A frame of which little came would cost more memory than a device has sent.
  auto little = packets(image, 9);
  little.erase(little.begin() + 1, little.end() - 2);
  EXPECT_EQ(assemble(lenient, little).at(0).verdict, Verdict::kRowsMissing);

  // A grey image cannot mark missing pixels.
  auto grey = packets(random_frame({20, 6}, CV_8UC1, 1), 8);
  grey.erase(grey.begin() + 1);
  EXPECT_EQ(assemble(lenient, grey).at(0).verdict, Verdict::kRowsMissing);
}

TEST(FrameAssembler, HandlesALostTrailerAndALostLeader) {
  FrameAssembler assembler;
  const auto first = packets(random_frame({20, 3}, CV_16UC1, 1), 1);
  auto sent = std::vector<Bytes>(first.begin(), first.end() - 1);
  const auto second = packets(random_frame({20, 3}, CV_16UC1, 2), 2);
  sent.insert(sent.end(), second.begin(), second.end());
  const auto third = packets(random_frame({20, 3}, CV_16UC1, 3), 3);
  sent.insert(sent.end(), third.begin() + 1, third.end());
  const auto out = assemble(assembler, sent);
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(out[0].text(), "disparity frame 1 dropped: it did not end");
  EXPECT_EQ(out[1].text(), "disparity frame 2 is good");
  EXPECT_EQ(assembler.counters().refused_packets, 4U);  // of the third
}

TEST(FrameAssembler, RefusesRowsOfAnotherFrame) {
  FrameAssembler assembler;
  auto sent = packets(random_frame({20, 3}, CV_16UC1, 1), 1);
  sent[2] = packets(random_frame({20, 3}, CV_16UC1, 2), 2)[2];
  EXPECT_EQ(assemble(assembler, sent).at(0).verdict, Verdict::kRowsMissing);
}

TEST(FrameAssembler, ToleratesRepeatedPackets) {
  FrameAssembler assembler;
  const cv::Mat image = random_frame({20, 3}, CV_16UC1, 1);
  std::vector<Bytes> sent;
  for (const Bytes& packet : packets(image, 1)) sent.insert(sent.end(), 2, packet);
  const auto out = assemble(assembler, sent);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_TRUE(same("frame", image, out[0].image));
}

TEST(FrameAssembler, DropsFramesThatTheBoardFlags) {
  const cv::Mat image = random_frame({20, 3}, CV_16UC1, 1);
  const std::pair<std::uint32_t, const char*> cases[] = {
      {link::kCutFrame, "the camera's frame was cut"},
      {link::kLongFrame, "the camera's frame was too long"},
      {link::kBufferError,
       "the rectification read outside the line buffer, or a mesh was being written"},
      {link::kOverrun, "the link was too slow"},
      {64, "flags 64"},
  };
  for (const auto& [flags, text] : cases) {
    FrameAssembler assembler(FrameAssembler::Options{true});
    const auto out = assemble(assembler, packets(image, 1, 1, flags));
    ASSERT_EQ(out.size(), 1U);
    EXPECT_TRUE(out[0].is_dropped());
    EXPECT_EQ(out[0].text(), std::string("disparity frame 1 dropped: ") + text);
  }
}

TEST(FrameAssembler, DropsFramesWithAnotherSignature) {
  // Two intact rows have changed places.
  FrameAssembler assembler;
  auto sent = packets(random_frame({20, 3}, CV_16UC1, 1), 1);
  const auto other = packets(random_frame({20, 3}, CV_16UC1, 2), 1);
  sent[2] = other[2];
  const auto out = assemble(assembler, sent);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_TRUE(out[0].is_dropped());
  EXPECT_EQ(out[0].text(), "disparity frame 1 dropped: its signature does not match");
}

TEST(FrameAssembler, RefusesImpossibleContents) {
  const auto refused = [](const Header& header, const Bytes& payload) {
    FrameAssembler assembler;
    auto sent = packets(random_frame({20, 3}, CV_16UC1, 1), 1);
    sent.insert(sent.begin() + 1, Bytes());
    link::append_packet(header, payload.data(), payload.size(), sent[1]);
    const auto out = assemble(assembler, sent);
    return assembler.counters().refused_packets == 1 && out.size() == 1 && !out[0].is_dropped();
  };
  Header rows;
  rows.frame_id = 1;
  rows.stream = Stream::kDisparity;
  rows.type = PacketType::kRows;
  rows.index = 3;
  EXPECT_TRUE(refused(rows, Bytes(40)));  // below the image
  rows.index = 0;
  EXPECT_TRUE(refused(rows, Bytes(160)));  // four rows of three
  EXPECT_TRUE(refused(rows, Bytes(36)));   // not a row
  rows.stream = static_cast<Stream>(7);
  EXPECT_TRUE(refused(rows, Bytes(40)));
  rows.stream = Stream::kNone;
  EXPECT_TRUE(refused(rows, Bytes(40)));
  Header trailer;
  trailer.frame_id = 1;
  trailer.stream = Stream::kDisparity;
  trailer.type = PacketType::kTrailer;
  EXPECT_TRUE(refused(trailer, Bytes(8)));
  Header leader = trailer;
  leader.type = PacketType::kLeader;
  leader.stream = Stream::kRawLeft;
  EXPECT_TRUE(refused(leader, Bytes(12)));  // 0 x 0
  Leader valid;
  valid.width = 20;
  valid.height = 3;
  valid.format = link::PixelFormat::kGrey;
  const auto try_leader = [&](const Leader& contents) {
    const auto bytes = pack(contents);
    return refused(leader, Bytes(bytes.begin(), bytes.end()));
  };
  EXPECT_FALSE(try_leader(valid));
  Leader wrong = valid;
  wrong.width = 15;
  EXPECT_TRUE(try_leader(wrong));
  wrong.width = 1281;
  EXPECT_TRUE(try_leader(wrong));
  wrong = valid;
  wrong.height = 1201;
  EXPECT_TRUE(try_leader(wrong));
  wrong = valid;
  wrong.format = link::PixelFormat::kDisparity;  // of a raw image
  EXPECT_TRUE(try_leader(wrong));
}

TEST(FrameAssembler, ALostLinkEndsTheFramesInFlight) {
  FrameAssembler assembler;
  auto sent = packets(random_frame({20, 3}, CV_16UC1, 1), 1);
  sent.pop_back();
  auto out = assemble(assembler, sent);
  EXPECT_TRUE(out.empty());
  assembler.reset(out);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_EQ(out[0].verdict, Verdict::kNoTrailer);
  assembler.reset(out);
  EXPECT_EQ(out.size(), 1U);
}

// However the bytes are damaged, a good frame is one that was sent.
TEST(FrameAssembler, DamagedStreamsGiveGoodFramesOrNone) {
  std::mt19937 random(9);
  int good = 0, bad = 0;
  for (int round = 0; round < 3000; ++round) {
    Bytes stream;
    std::vector<cv::Mat> images;
    std::vector<std::size_t> ends;
    for (int i = 0; i < 4; ++i) {
      images.push_back(random_frame({16 + round % 5, 4}, CV_16UC1, 4 * round + i));
      for (const Bytes& packet : packets(images.back(), i)) {
        stream.insert(stream.end(), packet.begin(), packet.end());
      }
    }
    const int damages = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < damages; ++i) {
      damage(stream, 0, stream.size(), static_cast<Fault>(random() % kNumFaults), random);
    }
    FrameAssembler assembler;
    for (const AssembledFrame& out : assemble(assembler, {stream})) {
      if (out.is_dropped()) {
        ++bad;
        continue;
      }
      ++good;
      ASSERT_LT(out.frame_id, images.size());
      ASSERT_TRUE(same("frame", images[out.frame_id], out.image)) << round;
    }
  }
  EXPECT_GT(good, 3000);
  EXPECT_GT(bad, 1000);
}

}  // namespace
}  // namespace fpga_stereo::test
