// A session on faulty links, with boards that fall silent.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "link/faults.hpp"
#include "link/session.hpp"
#include "link/streaming_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Session;
using link::Stream;
using State = link::LinkState;
using Step = link::WatchdogStep;

TEST(Session, NoLinkFaultMakesAFrameWrong) {
  std::mt19937 random(11);
  Streaming rig;
  rig.want(1);
  const auto faulty = [&](Bytes& bytes) {
    if (bytes.empty() || random() % 4 != 0) return;
    damage(bytes, 0, bytes.size(), static_cast<Fault>(random() % kNumFaults), random);
  };
  for (int round = 0; round < 25; ++round) {
    rig.to_host = faulty;
    rig.to_board = faulty;
    rig.want(1 + round % 7);
    rig.run(400);
    rig.to_host = rig.to_board = nullptr;
    const std::size_t before = rig.good();
    const auto recovered = [&] {
      return rig.good() > before + 2 && rig.received.back().tag == 1U + round % 7;
    };
    ASSERT_TRUE(rig.run_until(recovered, 15000)) << round << ": " << rig.session.trouble_text();
  }
  rig.expect_true_frames();
  EXPECT_GT(rig.session.counters().retries, 10U);
  EXPECT_GT(rig.session.line().bad_payloads, 10U);
  EXPECT_GT(rig.session.frames().dropped, 10U);
}

TEST(Session, SurvivesAThousandUnplugsInEveryState) {
  std::mt19937 random(12);
  Streaming rig;
  std::set<State> states;
  int longest = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.want(1 + random() % 3);
    rig.run(static_cast<int>(random() % 60));
    states.insert(rig.session.state());
    rig.session.closed();
    EXPECT_EQ(rig.session.trouble_text(), "no board");
    if (random() % 2 == 0) rig.board.reset();  // its power comes from the line, or not
    rig.run(static_cast<int>(random() % 5));
    rig.received.clear();
    rig.session.opened(rig.now);
    if (i % 10 != 0) continue;
    int ms = 0;
    while (rig.good() == 0 && ms < 3000) {
      rig.run(1);
      ++ms;
    }
    longest = std::max(longest, ms);
    ASSERT_GT(rig.good(), 0U) << i << ": " << rig.session.trouble_text();
    rig.expect_true_frames();
  }
  EXPECT_EQ(states, (std::set<State>{State::kIdentifying, State::kConfiguring, State::kStreaming}));
  EXPECT_LE(longest, 200) << "ms to the first good frame";
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, RecoversASilentBoardStepByStep) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  rig.line_open = false;
  rig.run(9000);
  ASSERT_GE(rig.steps.size(), 5U);
  const std::vector<Step> expected{Step::kPurge, Step::kRestart, Step::kReopen, Step::kReset,
                                   Step::kReset};
  EXPECT_EQ(std::vector<Step>(rig.steps.begin(), rig.steps.begin() + 5), expected);
  EXPECT_EQ(rig.session.trouble_text(), "the board does not answer");
  rig.line_open = true;
  rig.received.clear();
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  EXPECT_EQ(rig.session.trouble_text(), "");
  // After a success, the next recovery begins with the mildest step.
  rig.line_open = false;
  rig.steps.clear();
  ASSERT_TRUE(rig.run_until([&] { return !rig.steps.empty(); }));
  EXPECT_EQ(rig.steps[0], Step::kPurge);
}

TEST(Session, NoticesThatFramesStayAway) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  // Answers pass; frames are dropped.
  rig.to_host = [](Bytes& bytes) {
    if (bytes.size() > 600) bytes.clear();
  };
  ASSERT_TRUE(rig.run_until([&] { return rig.steps.size() >= 4; }, 20000));
  EXPECT_EQ(rig.steps[3], Step::kReset);
  EXPECT_TRUE(rig.noted("the board takes images but sends no frames: purge"));
}

TEST(Session, ReportsCamerasThatDeliverNothing) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  const auto pairs = std::exchange(rig.pairs, {});
  rig.run(2900);
  EXPECT_TRUE(rig.steps.empty());
  rig.run(200);
  EXPECT_EQ(rig.steps, std::vector<Step>{Step::kPurge});
  EXPECT_EQ(rig.session.trouble(), link::LinkTrouble::kNoImages);
  rig.pairs = pairs;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.trouble() == link::LinkTrouble::kNone; }));
}

TEST(Session, RecoversALinkThatIsCutWithinAFrame) {
  for (const bool keep_incomplete : {false, true}) {
    Streaming rig;
    link::SessionOptions options;
    options.keep_incomplete = keep_incomplete;
    rig.session = Session(options);
    rig.session.opened(rig.now);
    rig.want(1);
    ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
    bool cut = false;
    rig.to_host = [&](SessionRig::Bytes& bytes) {
      if (cut) bytes.clear();
      if (bytes.size() < 600) return;
      bytes.resize(bytes.size() / 2);
      cut = true;
    };
    rig.run(9000);
    ASSERT_GE(rig.steps.size(), 4U);
    const std::vector<Step> expected{Step::kPurge, Step::kRestart, Step::kReopen, Step::kReset};
    EXPECT_EQ(std::vector<Step>(rig.steps.begin(), rig.steps.begin() + 4), expected);
    EXPECT_EQ(rig.session.trouble_text(), "the board does not answer");
  }
}

TEST(Session, ExpectsNoFramesBeforeTheStreamsAreOn) {
  Streaming rig;
  rig.frame_ms = 43;              // more than ten between two polls
  for (int i = 0; i < 40; ++i) {  // at all times between two polls
    rig.want(1, {});
    rig.run(913);
    ASSERT_EQ(rig.session.state(), State::kReady);
    rig.want(1);
    rig.run(100);
    EXPECT_TRUE(rig.steps.empty()) << i;
  }
}

TEST(Session, EndsTheTroubleThoughNothingIsStreamed) {
  Streaming rig;
  rig.want(1, {});
  rig.run(1000);
  rig.line_open = false;
  ASSERT_TRUE(rig.run_until([&] { return !rig.steps.empty(); }));
  EXPECT_NE(rig.session.trouble_text(), "");
  rig.line_open = true;
  rig.run(2000);
  EXPECT_EQ(rig.session.state(), State::kReady);
  EXPECT_EQ(rig.session.trouble_text(), "");
}

TEST(Session, RetriesARefusedSettingSeldom) {
  auto options = SessionRig::small_board();
  options.overrides = {{spec::kRegSpeckleSize, 9}};
  Streaming rig(options);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  const auto requests = rig.session.counters().requests;
  rig.run(35000);
  EXPECT_EQ(rig.session.state(), State::kRefused);
  EXPECT_TRUE(rig.steps.empty());
  EXPECT_EQ(rig.notes.size(), 3U) << "reported once, after two attempts";
  EXPECT_NEAR(static_cast<double>(rig.session.counters().requests - requests), 70, 40)
      << "heartbeats, and three attempts";
}

TEST(Session, TriesARefusedSettingAgain) {
  Streaming rig;
  rig.board.hold_frame(true);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }, 10000));
  EXPECT_EQ(rig.session.trouble_text(),
            "the board does not take its configuration: no frame has ended for 2 s");
  rig.board.hold_frame(false);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }, 11000));
  rig.expect_true_frames();
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, DropsFramesOfAnUnknownConfiguration) {
  Streaming rig;
  // The board continues with the configuration of another host.
  rig.want(2);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  bool held = false;
  rig.to_board = [&](Bytes& bytes) {
    if (!bytes.empty()) held = true;
    bytes.clear();
  };
  rig.session.closed();
  rig.received.clear();
  rig.session.opened(rig.now);
  rig.run(200);
  EXPECT_TRUE(held);
  EXPECT_TRUE(rig.received.empty());
}

TEST(Session, AnswersUserRequestsBetweenItsOwn) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  std::optional<std::vector<RegisterWrite>> values;
  std::optional<Error> error;
  const auto answer = [&](Result<std::vector<RegisterWrite>> r) {
    if (r) {
      values = *r;
    } else {
      error = r.error();
    }
  };
  rig.session.ask(link::read_request({spec::kRegIdentity, spec::kRegWidth}), answer);
  rig.run(10);
  ASSERT_TRUE(values);
  ASSERT_EQ(values->size(), 2U);
  EXPECT_EQ((*values)[0].value, spec::kRegIdentityReset);
  EXPECT_EQ((*values)[1].value, 64U);

  rig.session.ask({link::PacketType::kLeader, {}}, answer);
  rig.session.ask({static_cast<link::PacketType>(0x55), {1, 2, 3, 4}}, answer);
  rig.run(3000);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "the board refuses a request: it does not know this type of request");

  rig.session.closed();
  error.reset();
  rig.session.ask(link::read_request({0}), answer);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, ErrorKind::kUnplugged);
}

TEST(Session, RetriesARequestWhoseAnswerIsLost) {
  Streaming rig;
  int lost = 3;
  rig.to_host = [&](Bytes& bytes) {
    const bool answer = bytes.size() > link::kHeaderBytes + link::kCrcBytes;  // no heartbeat
    if (answer && lost-- > 0) bytes.clear();
  };
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 0; }));
  EXPECT_EQ(rig.session.counters().retries, 3U);
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Board, FallsSilentWhenItsHostDoes) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  rig.to_board = [](Bytes& bytes) { bytes.clear(); };
  rig.to_host = [](Bytes& bytes) { bytes.clear(); };
  rig.run(kHostTimeoutMs + 100);
  std::size_t sent = 0;
  rig.to_host = [&](Bytes& bytes) {
    sent += bytes.size();
    bytes.clear();
  };
  rig.run(2000);
  EXPECT_EQ(sent, 0U);
}

}  // namespace
}  // namespace fpga_stereo::test
