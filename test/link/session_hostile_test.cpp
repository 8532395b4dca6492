// A session with a hostile board and with clocks that are set.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "link/hostile_board.hpp"
#include "link/session.hpp"
#include "link/streaming_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::LinkTrouble;
using link::PacketType;
using link::Stream;
using State = link::LinkState;
using Step = link::WatchdogStep;

bool is_frame_packet(const link::Header& header) {
  return header.type == PacketType::kLeader || header.type == PacketType::kRows ||
         header.type == PacketType::kTrailer;
}

/// A rig that streams, and whose board's packets can be edited.
class HostileRig : public Streaming {
 public:
  HostileRig() {
    want(1);
    run_until([&] { return good() > 5; });
    received.clear();
    notes.clear();
  }
  void lie(PacketEditor::Edit edit) { to_host = PacketEditor(std::move(edit)); }
  /// Returns why frames were dropped.
  std::set<std::string> reasons() const {
    std::set<std::string> all;
    for (const link::ReceivedFrames& r : received) {
      for (const std::string& text : r.set.dropped) all.insert(text.substr(text.find(" dropped")));
    }
    return all;
  }
};

TEST(HostileBoard, StampsFollowASystemClockThatIsSet) {
  for (const double step : {-3600.0, 3600.0, -0.05}) {
    HostileRig rig;
    const std::uint64_t before = rig.session.counters().configurations;
    rig.host += step;
    rig.run(2000);
    ASSERT_GE(rig.good(), 95U) << step << ": no frame is lost";
    for (const link::ReceivedFrames& r : rig.received) {
      EXPECT_NEAR(r.stamp, r.arrived, 0.03) << step;
      EXPECT_EQ(r.clock_steps, rig.received.back().clock_steps);
    }
    EXPECT_NEAR(rig.received.back().arrived, rig.host, 0.03) << step;
    EXPECT_EQ(std::count_if(rig.notes.begin(), rig.notes.end(),
                            [](const std::string& note) {
                              return note.find("the system clock was set") != std::string::npos;
                            }),
              1);
    EXPECT_EQ(rig.session.counters().configurations, before);
    EXPECT_TRUE(rig.steps.empty());
  }
}

TEST(HostileBoard, FramesFarFromTheirArrivalAreRefused) {
  const std::vector<std::pair<double, std::string>> cases{
      {315576000.5, " dropped: its time stamp is 31557600"},
      {-120.0, " dropped: its time stamp is 12"}};
  for (const auto& [offset, reason] : cases) {
    HostileRig rig;
    rig.lie([us = static_cast<std::int64_t>(offset * 1e6)](link::Header& header, Bytes&) {
      if (is_frame_packet(header)) header.timestamp += static_cast<std::uint64_t>(us);
      return true;
    });
    rig.run(1000);
    EXPECT_EQ(rig.good(), 0U);
    ASSERT_GE(rig.reasons().size(), 1U);
    for (const std::string& text : rig.reasons()) {
      EXPECT_EQ(text.substr(0, reason.size()), reason);
    }
    EXPECT_EQ(rig.received.back().set.verdicts.front(), link::FrameVerdict::kBadStamp);
  }
}

TEST(HostileBoard, AClockOfTwiceTheRateGivesNoStamps) {
  HostileRig rig;
  rig.lie(lying_clock([](std::uint64_t us) { return 2 * us; }));
  rig.run(2000);
  rig.received.clear();
  rig.run(5000);
  EXPECT_EQ(rig.good(), 0U);
  const std::string reason = " dropped: the board's clock does not run at the rate of the host's";
  EXPECT_EQ(rig.reasons(), std::set<std::string>{reason});
  ASSERT_TRUE(rig.run_until([&] { return !rig.steps.empty(); }, 60000));
  EXPECT_EQ(rig.session.trouble(), LinkTrouble::kStalled);
}

TEST(HostileBoard, AClockThatIsSetGivesRightStampsWithinASecond) {
  HostileRig rig;
  rig.lie(lying_clock([](std::uint64_t us) { return us + 3600000000U; }));
  rig.run(1000);
  rig.received.clear();
  rig.run(1000);
  ASSERT_GE(rig.good(), 45U);
  for (const link::ReceivedFrames& r : rig.received) EXPECT_NEAR(r.stamp, r.arrived, 0.03);
  EXPECT_TRUE(rig.noted("the board's clock has stepped"));
}

// Before, such a board was called streaming for ever.
TEST(HostileBoard, IsNoticedIfItStopsReadingButSendsHeartbeats) {
  HostileRig rig;
  rig.bytes_per_ms = 0;
  rig.to_host = [&](Bytes& bytes) {
    bytes.clear();
    link::Header heartbeat;
    link::append_packet(heartbeat, nullptr, 0, bytes);
  };
  ASSERT_TRUE(rig.run_until([&] { return rig.steps.size() >= 4; }, 9000));
  EXPECT_EQ(rig.steps[3], Step::kReset);
  EXPECT_EQ(rig.session.trouble_text(), "the board does not answer");
  EXPECT_NE(rig.session.state(), State::kStreaming);
}

TEST(HostileBoard, IsNoticedIfItAnswersButSendsNoFrames) {
  HostileRig rig;
  rig.lie([](link::Header& header, Bytes& payload) {
    if (header.type == PacketType::kRegisters) {
      for (std::size_t i = 0; i + 8 <= payload.size(); i += 8) {
        if (link::get_u32(&payload[i]) == spec::kRegFramesIn) link::put_u32(&payload[i + 4], 5);
      }
    }
    return !is_frame_packet(header);
  });
  ASSERT_TRUE(rig.run_until([&] { return !rig.steps.empty(); }, 4000));
  EXPECT_EQ(rig.session.trouble(), LinkTrouble::kNoImages);
  EXPECT_EQ(rig.session.trouble_text(), "the board's cameras deliver no images");
  rig.run(60000);
  EXPECT_LE(rig.steps.size(), 5U) << "ever more rarely";
  EXPECT_EQ(rig.session.trouble(), LinkTrouble::kNoImages);
}

TEST(HostileBoard, LeadersWithFallingIdsCostNoMoreThanOthers) {
  HostileRig rig;
  link::Header header;
  header.type = PacketType::kLeader;
  header.stream = Stream::kDisparity;
  link::Leader leader;
  leader.width = 64;
  leader.height = 24;
  leader.configuration = 1;
  const auto contents = pack(leader);
  Bytes bytes;
  for (int i = 0; i < 20000; ++i) {
    header.frame_id = static_cast<std::uint64_t>(40000 - i);
    link::append_packet(header, contents.data(), contents.size(), bytes);
  }
  rig.session.receive(bytes.data(), bytes.size(), rig.now, rig.host);
  const auto received = rig.session.take_received();
  EXPECT_GE(received.size(), 19990U) << "each is reported as lost, none waits";
  for (const link::ReceivedFrames& r : received)
    EXPECT_TRUE(r.set.image(Stream::kDisparity).empty());
}

TEST(HostileBoard, ImpossibleBuildsAreRefused) {
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> lies{
      {spec::kRegBuild, 0},          {spec::kRegBuild, 0xFFFFFFFF},
      {spec::kRegBuildLineRows, 0},  {spec::kRegBuildLineRows, 0x80000000},
      {spec::kRegBuildMeshNodes, 0}, {spec::kRegBuildMeshNodes, 0xFFFFFFFF}};
  for (const auto& [address, value] : lies) {
    Streaming rig;
    rig.to_host = PacketEditor([at = address, word = value](link::Header& header, Bytes& payload) {
      if (header.type != PacketType::kRegisters) return true;
      for (std::size_t i = 0; i + 8 <= payload.size(); i += 8) {
        if (link::get_u32(&payload[i]) == at) link::put_u32(&payload[i + 4], word);
      }
      return true;
    });
    rig.want(1);
    ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; })) << address;
    EXPECT_EQ(rig.session.trouble(), LinkTrouble::kIncompatible);
    EXPECT_EQ(rig.session.trouble_text().find("the board claims an impossible build: "), 0U)
        << rig.session.trouble_text();
  }
}

}  // namespace
}  // namespace fpga_stereo::test
