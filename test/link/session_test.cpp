// A session with a board of software at the other end of a line that does what lines do.
#include "fpga_stereo/link/session.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "link/faults.hpp"
#include "link/session_rig.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

using link::Session;
using link::Stream;
using State = Session::State;
using Step = Session::Step;

constexpr unsigned bit(Stream s) { return 1U << static_cast<unsigned>(s); }
constexpr unsigned kDisparity = bit(Stream::kDisparity);
constexpr unsigned kAll = kDisparity | bit(Stream::kRectifiedLeft) | bit(Stream::kRectifiedRight) |
                          bit(Stream::kRawLeft) | bit(Stream::kRawRight);

/// A rig whose cameras see two pairs, with what every setting makes of them.
class Streaming : public SessionRig {
 public:
  explicit Streaming(const sim::SoftwareBoard::Options& options = small_board())
      : SessionRig(options) {
    pairs = {pair(1), pair(2)};
  }

  void want(unsigned seed, unsigned streams = kDisparity) {
    session.want(wanted(setting(seed), seed, streams));
  }
  bool streaming() const { return session.state() == State::kStreaming; }

  /// Every disparity that came is what the setting of its tag makes of one of the pairs.
  void expect_true_frames() {
    for (const Session::Received& r : received) {
      const cv::Mat& disparity = r.set.image(Stream::kDisparity);
      if (disparity.empty()) continue;
      const auto& known = known_disparities(static_cast<unsigned>(r.tag));
      const bool found = std::any_of(known.begin(), known.end(), [&](const cv::Mat1w& k) {
        return static_cast<bool>(same("disparity", k, disparity));
      });
      ASSERT_TRUE(found) << "frame " << r.set.frame_id << ", tag " << r.tag;
    }
  }
  std::size_t good() const {
    return static_cast<std::size_t>(std::count_if(
        received.begin(), received.end(),
        [](const Session::Received& r) { return !r.set.image(Stream::kDisparity).empty(); }));
  }
  bool noted(const std::string& text) const {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
      return note.find(text) != std::string::npos;
    });
  }

 private:
  const std::vector<cv::Mat1w>& known_disparities(unsigned seed) {
    std::vector<cv::Mat1w>& known = known_[seed];
    if (known.empty()) {
      for (const sim::RawPair& p : pairs) known.push_back(expected(p, setting(seed)));
    }
    return known;
  }
  std::map<unsigned, std::vector<cv::Mat1w>> known_;
};

TEST(Session, BringsEveryStreamOfABoard) {
  Streaming rig;
  rig.pairs.resize(1);
  rig.want(7, kAll);
  ASSERT_TRUE(rig.run_until([&] { return rig.received.size() >= 20; }));
  ASSERT_TRUE(rig.streaming());
  EXPECT_EQ(rig.session.complaint(), "");
  const SessionRig::Setting setting = SessionRig::setting(7);
  Pipeline pipeline;
  const Taps& taps = pipeline.process(rig.pairs[0].left, rig.pairs[0].right, setting.rectification,
                                      setting.parameters, 1);
  for (const Session::Received& r : rig.received) {
    EXPECT_EQ(r.tag, 7U);
    EXPECT_TRUE(r.set.dropped.empty());
    EXPECT_TRUE(same("disparity", taps.disparity, r.set.image(Stream::kDisparity)));
    EXPECT_TRUE(same("left", taps.left, r.set.image(Stream::kRectifiedLeft)));
    EXPECT_TRUE(same("right", taps.right, r.set.image(Stream::kRectifiedRight)));
    EXPECT_TRUE(same("raw left", rig.pairs[0].left, r.set.image(Stream::kRawLeft)));
    EXPECT_TRUE(same("raw right", rig.pairs[0].right, r.set.image(Stream::kRawRight)));
  }
  for (std::size_t i = 1; i < rig.received.size(); ++i) {
    EXPECT_EQ(rig.received[i].set.frame_id, rig.received[i - 1].set.frame_id + 1);
  }
}

TEST(Session, StampsInTheHostsTimeAcrossTheWrapOfTheBoards) {
  Streaming rig;
  rig.want(1);
  rig.run(15000);  // the board's clock wraps after 10 s, its frame_id after 16 frames
  ASSERT_GE(rig.good(), 700U);
  double last = 0;
  for (const Session::Received& r : rig.received) {
    EXPECT_GT(r.stamp, last);
    last = r.stamp;
  }
  EXPECT_NEAR(last, rig.host, 0.021);
  EXPECT_NEAR(rig.session.clock().drift(), 0, 1e-5);
}

TEST(Session, MidExposureIsBeforeTheFirstPixel) {
  Streaming rig;
  link::Wanted wanted = rig.wanted(SessionRig::setting(1), 1, kDisparity);
  wanted.mid_exposure = std::chrono::microseconds(8000);
  rig.session.want(wanted);
  ASSERT_TRUE(rig.run_until([&] { return rig.received.size() >= 3; }));
  EXPECT_NEAR(rig.received.back().stamp, rig.host - 0.008, 0.003);
}

TEST(Session, ChangedSettingsNeverMixWithFramesOfTheOldOnes) {
  Streaming rig;
  std::set<std::uint64_t> tags;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    rig.want(seed);
    rig.run(20 + static_cast<int>(seed) % 90);
  }
  rig.expect_true_frames();
  for (const Session::Received& r : rig.received) tags.insert(r.tag);
  EXPECT_GE(tags.size(), 30U);
  EXPECT_EQ(rig.received.back().tag, 40U);
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, MeshesAreSentWhereTheyChangeOnly) {
  Streaming rig;
  rig.want(3);
  ASSERT_TRUE(rig.run_until([&] { return rig.streaming(); }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshSwaps), 1U);
  rig.want(6);  // the same min_disparity
  ASSERT_TRUE(rig.run_until([&] { return rig.session.counters().configured == 2; }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshSwaps), 1U);
  rig.want(7);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.counters().configured == 3; }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshSwaps), 2U);
}

TEST(Session, NothingComesThatNobodyWants) {
  Streaming rig;
  rig.want(1, 0);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kReady; }));
  const auto packets = rig.session.line().bytes;
  rig.run(2000);
  EXPECT_LT(rig.session.line().bytes - packets, 1200U) << "four polls and four heartbeats";
  EXPECT_TRUE(rig.received.empty());
  rig.want(1, bit(Stream::kRawLeft));
  ASSERT_TRUE(rig.run_until([&] { return !rig.received.empty(); }));
  EXPECT_TRUE(rig.received[0].set.image(Stream::kDisparity).empty());
  EXPECT_FALSE(rig.received[0].set.image(Stream::kRawLeft).empty());
}

TEST(Session, ABoardIsTakenAsItIs) {
  Streaming rig;
  rig.want(3, 0);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kReady; }));
  const std::uint32_t configuration = rig.board.peek(spec::kRegConfiguration);
  // Another session: it knows nothing of that configuration, and leaves it alone.
  rig.session = link::Session();
  link::Wanted wanted;
  wanted.as_it_is = true;
  wanted.tag = 3;  // the setting that the frames are compared with
  wanted.streams = kDisparity;
  rig.session.want(wanted);
  rig.session.opened(rig.now);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 5; }));
  rig.expect_true_frames();
  EXPECT_TRUE(rig.streaming());
  EXPECT_EQ(rig.received[0].set.configuration, configuration);
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), configuration);
  EXPECT_EQ(rig.session.counters().configured, 0U);
}

TEST(Session, RawImagesOfEveryNthPair) {
  Streaming rig;
  link::Wanted wanted = rig.wanted(SessionRig::setting(1), 1, kAll);
  wanted.frame_interval = 2;
  wanted.raw_interval = 3;
  rig.session.want(wanted);
  rig.run(2000);
  ASSERT_GE(rig.received.size(), 40U);
  int raw = 0;
  for (std::size_t i = 4; i < rig.received.size(); ++i) {
    EXPECT_EQ(rig.received[i].set.frame_id - rig.received[i - 1].set.frame_id, 2U);
    EXPECT_FALSE(rig.received[i].set.image(Stream::kDisparity).empty());
    const bool left = !rig.received[i].set.image(Stream::kRawLeft).empty();
    EXPECT_EQ(left, !rig.received[i].set.image(Stream::kRawRight).empty());
    raw += left ? 1 : 0;
  }
  EXPECT_NEAR(raw, static_cast<double>(rig.received.size() - 4) / 3, 1);
}

TEST(Session, PairsOfTheHostComeBackWithItsNumbersAndStamps) {
  Streaming rig;
  link::Wanted wanted = rig.wanted(SessionRig::setting(5), 5, kDisparity);
  wanted.host_input = true;
  rig.session.want(wanted);
  ASSERT_TRUE(rig.run_until([&] { return rig.streaming(); }));
  for (std::uint64_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(rig.session.send_pair(rig.pairs[i % 2].left, rig.pairs[i % 2].right, 100 + i,
                                      1600000000000000 + 33333 * i));
    rig.run(5);
  }
  ASSERT_EQ(rig.received.size(), 6U) << "and none of the cameras";
  for (std::size_t i = 0; i < 6; ++i) {
    const Session::Received& r = rig.received[i];
    EXPECT_EQ(r.set.frame_id, 100 + i);
    EXPECT_EQ(r.set.timestamp, 1600000000000000 + 33333 * i);
    EXPECT_TRUE(same("disparity", SessionRig::expected(rig.pairs[i % 2], SessionRig::setting(5)),
                     r.set.image(Stream::kDisparity)));
  }
}

// Boards that this software cannot work with.

struct Misfit {
  std::map<std::uint32_t, std::uint32_t> wrong;
  std::uint8_t version;
  std::string complaint;
};

class Misfits : public ::testing::TestWithParam<Misfit> {};

TEST_P(Misfits, AreRefusedByName) {
  auto options = SessionRig::small_board();
  options.wrong = GetParam().wrong;
  options.version = GetParam().version;
  Streaming rig(options);
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  EXPECT_EQ(rig.session.complaint().rfind(GetParam().complaint, 0), 0U) << rig.session.complaint();
  rig.run(1500);
  EXPECT_TRUE(rig.received.empty());
  EXPECT_TRUE(rig.steps.empty());
  EXPECT_EQ(rig.notes.size(), 1U) << "said once";
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), 0U) << "nothing is written to it";
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Misfits,
    ::testing::Values(
        Misfit{{{spec::kRegIdentity, 0x12345678}},
               1,
               "what answers is no board of this kind: IDENTITY = 0x12345678, expected 0x46535431"},
        Misfit{{{spec::kRegVersion, 0x00020003}},
               1,
               "the board's gateware has version 2.3, this software works with 0.x: flash the "
               "gateware of this release (rosrun fpga_stereo board flash)"},
        Misfit{{{spec::kRegSpecHash, 0xDEADBEEF}},
               1,
               "the board's gateware is of specification 0xDEADBEEF, this software of 0x"},
        Misfit{
            {}, 2, "the board speaks version 2 of the packets, this software version 1: flash"}));

class Defects : public ::testing::TestWithParam<Misfit> {};

TEST_P(Defects, AreFoundByReadingBack) {
  auto options = SessionRig::small_board();
  options.wrong = GetParam().wrong;
  Streaming rig(options);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  EXPECT_EQ(rig.session.complaint(), GetParam().complaint);
  EXPECT_TRUE(rig.received.empty());
  EXPECT_EQ(rig.board.peek(spec::kRegStreams), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Defects,
    ::testing::Values(
        Misfit{{{spec::kRegSpeckleSize, 9}},
               1,
               "the board holds 0x00000009 in register SPECKLE_SIZE instead of 0x00000008"},
        Misfit{{{spec::kRegMeshSignature, 1}},
               1,
               "the board holds 0x00000001 in register MESH_SIGNATURE instead of 0xDC0DF191"},
        Misfit{{{spec::kRegConfiguration, 0}, {spec::kRegErrors, spec::kErrorsConfig.put(1)}},
               1,
               "the board refuses its configuration: ERRORS.config"}));

TEST(Session, AnotherSettingIsTriedWhereOneWasRefused) {
  auto options = SessionRig::small_board();
  options.wrong = {{spec::kRegSpeckleSize, 9}};
  Streaming rig(options);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  rig.want(9);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 0; }));
  rig.expect_true_frames();
}

// Lines that do what lines do.

TEST(Session, NoFaultOfTheLineMakesAFrameWrong) {
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
    ASSERT_TRUE(rig.run_until(recovered, 15000)) << round << ": " << rig.session.complaint();
  }
  rig.expect_true_frames();
  EXPECT_GT(rig.session.counters().repeated, 10U);
  EXPECT_GT(rig.session.line().bad_payloads, 10U);
  EXPECT_GT(rig.session.frames().dropped, 10U);
}

TEST(Session, AThousandUnplugsInEveryState) {
  std::mt19937 random(12);
  Streaming rig;
  std::set<State> states;
  int longest = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.want(1 + random() % 3);
    rig.run(static_cast<int>(random() % 60));
    states.insert(rig.session.state());
    rig.session.closed();
    EXPECT_EQ(rig.session.complaint(), "no board");
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
    ASSERT_GT(rig.good(), 0U) << i << ": " << rig.session.complaint();
    rig.expect_true_frames();
  }
  EXPECT_EQ(states, (std::set<State>{State::kIdentifying, State::kConfiguring, State::kStreaming}));
  EXPECT_LE(longest, 200) << "ms to the first good frame";
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, ABoardThatWasResetIsConfiguredAgain) {
  Streaming rig;
  rig.want(4);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(rig.run_until([&] { return rig.good() > 10; }));
    rig.run(i * 7);
    rig.board.reset();
    rig.received.clear();
  }
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 10; }));
  rig.expect_true_frames();
  EXPECT_TRUE(rig.noted("the board was reset"));
}

TEST(Session, ASilentBoardIsPurgedRestartedReopenedReset) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  rig.line_open = false;
  rig.run(9000);
  ASSERT_GE(rig.steps.size(), 5U);
  const std::vector<Step> expected{Step::kPurge, Step::kRestart, Step::kReopen, Step::kReset,
                                   Step::kReset};
  EXPECT_EQ(std::vector<Step>(rig.steps.begin(), rig.steps.begin() + 5), expected);
  EXPECT_EQ(rig.session.complaint(), "the board does not answer");
  rig.line_open = true;
  rig.received.clear();
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  EXPECT_EQ(rig.session.complaint(), "");
  // The next time it begins with the mildest.
  rig.line_open = false;
  rig.steps.clear();
  ASSERT_TRUE(rig.run_until([&] { return !rig.steps.empty(); }));
  EXPECT_EQ(rig.steps[0], Step::kPurge);
}

TEST(Session, FramesThatStayAwayAreAStall) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  // Answers pass, frames do not.
  rig.to_host = [](Bytes& bytes) {
    if (bytes.size() > 600) bytes.clear();
  };
  ASSERT_TRUE(rig.run_until([&] { return rig.steps.size() >= 4; }, 20000));
  EXPECT_EQ(rig.steps[3], Step::kReset);
  EXPECT_TRUE(rig.noted("the board takes images, and no frame comes: purge"));
}

TEST(Session, CamerasThatDeliverNothingAreNoStall) {
  Streaming rig;
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  rig.pairs.clear();
  rig.run(10000);
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, FramesOfAnUnknownConfigurationAreDropped) {
  Streaming rig;
  // The board goes on with what another host has configured.
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

TEST(Session, RegistersOfOthersBetweenItsOwn) {
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
  EXPECT_EQ(error->message, "the board refuses a request: it does not know that request");

  rig.session.closed();
  error.reset();
  rig.session.ask(link::read_request({0}), answer);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, ErrorKind::kGone);
}

TEST(Session, ALostAnswerIsAskedForAgain) {
  Streaming rig;
  int lost = 3;
  rig.to_host = [&](Bytes& bytes) {
    if (!bytes.empty() && lost-- > 0) bytes.clear();
  };
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 0; }));
  EXPECT_EQ(rig.session.counters().repeated, 3U);
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Board, FallsSilentWithItsHost) {
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
