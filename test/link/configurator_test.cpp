// A configurator and its request queue, with a virtual board that answers at once.
#include "link/configurator.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "link/session_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Configurator;
using link::PacketType;
using link::Stream;
using Progress = Configurator::Progress;

class ConfiguratorRig {
 public:
  explicit ConfiguratorRig(const sim::SoftwareBoard::Options& options = SessionRig::small_board())
      : board(options) {}

  /// Runs until no request is pending. Returns the first failure.
  Status run() {
    for (int ms = 0; ms < 3000 && !queue.empty(); ++ms) {
      now_ += std::chrono::milliseconds(1);
      board.run(std::chrono::milliseconds(1));
      if (!queue.tick(now_)) return Error{ErrorKind::kTimeout, "no answer"};
      auto bytes = std::exchange(outbox.bytes(), {});
      for (std::size_t at = 0; at < bytes.size();) {
        const auto header = link::unpack(&bytes[at]);
        requests.push_back(header->type);
        at += link::kHeaderBytes + header->length + link::kCrcBytes;
      }
      outbox.mark_sent(bytes.size());
      queue.on_sent(now_, now_);
      board.receive(bytes.data(), bytes.size());
      std::vector<std::uint8_t> answer(1 << 16);
      answer.resize(board.transmit(answer.data(), answer.size()));
      decoder_.push(answer.data(), answer.size());
      while (const auto packet = decoder_.next()) {
        if (!queue.is_answer(*packet)) continue;
        if (Status status = queue.complete(*packet, now_); !status) return status;
      }
    }
    return {};
  }
  /// Advances until the configurator has nothing more to do.
  Status settle() {
    while (true) {
      const Progress progress = configurator.advance();
      if (progress == Progress::kDone || progress == Progress::kBlocked) return {};
      if (Status status = run(); !status) return status;
    }
  }
  Status bring_up(const link::DesiredState& desired) {
    configurator.set_desired_state(desired);
    configurator.restart();
    if (Status status = run(); !status) return status;
    return settle();
  }
  auto mesh_writes() const {
    return std::count(requests.begin(), requests.end(), PacketType::kWriteMesh);
  }

  sim::SoftwareBoard board;
  link::Outbox outbox;
  link::RequestQueue queue{link::SessionOptions{}, outbox};
  Configurator configurator{queue, 4};
  std::vector<PacketType> requests;

 private:
  link::Decoder decoder_;
  link::Time now_{std::chrono::seconds(100)};
};

link::DesiredState desired(unsigned seed) {
  return SessionRig().wanted(SessionRig::setting(seed), seed, Stream::kDisparity);
}

TEST(Configurator, IdentifiesTheBoardAndTurnsItsStreamsOff) {
  ConfiguratorRig rig;
  rig.configurator.restart();
  EXPECT_FALSE(rig.configurator.is_identified());
  ASSERT_TRUE(rig.run());
  EXPECT_TRUE(rig.configurator.is_identified());
  EXPECT_EQ(rig.configurator.identity()->build.disparities, 16);
  EXPECT_EQ(rig.requests,
            (std::vector<PacketType>{PacketType::kReadRegisters, PacketType::kWriteRegisters,
                                     PacketType::kReadRegisters, PacketType::kReadRegisters}));
  EXPECT_EQ(rig.configurator.advance(), Progress::kBlocked);
}

TEST(Configurator, BringsTheBoardIntoTheDesiredState) {
  ConfiguratorRig rig;
  ASSERT_TRUE(rig.bring_up(desired(4)));
  EXPECT_EQ(rig.configurator.advance(), Progress::kDone);
  EXPECT_EQ(rig.configurator.applied_count(), 1U);
  EXPECT_EQ(rig.configurator.active_tag(), 4U);
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), 1U);
  EXPECT_EQ(rig.board.peek(spec::kRegStreams), link::StreamSet(Stream::kDisparity).bits());
  EXPECT_EQ(rig.configurator.tags().find(1), 4U);
  EXPECT_FALSE(rig.configurator.tags().find(0));
}

TEST(Configurator, RefusesConfigurationsForAnotherBuild) {
  auto options = SessionRig::small_board();
  options.build.line_rows += 1;
  ConfiguratorRig rig(options);
  ASSERT_TRUE(rig.bring_up(desired(4)));
  EXPECT_EQ(rig.configurator.advance(), Progress::kBlocked);
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), 0U);
}

TEST(Configurator, WritesMeshesOnlyWhenTheyChange) {
  ConfiguratorRig rig;
  ASSERT_TRUE(rig.bring_up(desired(3)));
  const auto first = rig.mesh_writes();
  EXPECT_GE(first, 2);
  EXPECT_TRUE(rig.configurator.set_desired_state(desired(6)));  // the same meshes
  ASSERT_TRUE(rig.settle());
  EXPECT_EQ(rig.mesh_writes(), first);
  EXPECT_TRUE(rig.configurator.set_desired_state(desired(7)));
  ASSERT_TRUE(rig.settle());
  EXPECT_GT(rig.mesh_writes(), first);
  EXPECT_EQ(rig.configurator.applied_count(), 3U);
}

TEST(Configurator, RecognisesAnEqualConfiguration) {
  ConfiguratorRig rig;
  ASSERT_TRUE(rig.bring_up(desired(4)));
  EXPECT_FALSE(rig.configurator.set_desired_state(desired(4)));
  EXPECT_FALSE(rig.configurator.is_stale());
  link::DesiredState other_tag = desired(4);
  other_tag.tag = 5;
  EXPECT_TRUE(rig.configurator.set_desired_state(other_tag));
  EXPECT_FALSE(rig.configurator.active_tag());
  ASSERT_TRUE(rig.settle());
  EXPECT_EQ(rig.configurator.active_tag(), 5U);
}

TEST(Configurator, FailsIfTheBoardDoesNotHoldWhatIsWritten) {
  auto options = SessionRig::small_board();
  options.overrides = {{spec::kRegSpeckleSize, 9}};
  ConfiguratorRig rig(options);
  const Status status = rig.bring_up(desired(8));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "the board holds 0x00000009 in register SPECKLE_SIZE instead of 0x00000008");
}

}  // namespace
}  // namespace fpga_stereo::test
