// Recordings of a session: the player knows what made each frame, or says that it does not.
#include "fpga_stereo/link/recording_player.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "link/recording_file.hpp"
#include "link/streaming_rig.hpp"
#include "link/test_folder.hpp"

namespace fpga_stereo::test {
namespace {

using link::RecordingPlayer;
using link::Stream;

/// A session whose bytes are recorded.
class RecordedSession : public Streaming {
 public:
  RecordedSession() {
    to_host = [this](Bytes& bytes) { append(0, bytes); };
    to_board = [this](Bytes& bytes) { append(1, bytes); };
  }
  /// Streams with the setting of this seed until `frames` more frames have come.
  void stream(unsigned seed, std::size_t frames, link::StreamSet streams = kDisparity) {
    want(seed, streams);
    const std::size_t wanted = good() + frames;
    ASSERT_TRUE(run_until([&] { return good() >= wanted && received.back().tag == seed; }));
  }
  void append(std::uint8_t direction, const Bytes& bytes) {
    if (!bytes.empty()) append_record(file, time_++, direction, bytes);
  }

  Bytes file = recording_header();

 private:
  std::uint64_t time_ = 0;
};

class Player : public testing::Test {
 protected:
  /// Plays a recording to its end.
  std::vector<RecordingPlayer::Frames> play(const Bytes& file,
                                            link::StreamSet streams = link::StreamSet::all()) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()),
               static_cast<std::streamsize>(file.size()));
    auto opened = RecordingPlayer::open("replay:" + path_ + ":0", streams);
    EXPECT_TRUE(opened);
    player_ = std::move(*opened);
    std::vector<RecordingPlayer::Frames> all;
    while (true) {
      auto played = player_->take(Milliseconds(100));
      if (!played) {
        end_ = played.error();
        return all;
      }
      for (auto& frames : *played) all.push_back(std::move(frames));
    }
  }
  static GatewareConfiguration configuration(unsigned seed) {
    const auto setting = SessionRig::setting(seed);
    return *make_gateware_configuration(SessionRig::small_board().build, setting.parameters,
                                        setting.rectification);
  }
  using Milliseconds = std::chrono::milliseconds;

  const TestFolder folder_;
  const std::string path_ = folder_ / "recording";
  std::unique_ptr<RecordingPlayer> player_;
  Error end_;
};

TEST_F(Player, KnowsTheConfigurationOfEveryFrame) {
  RecordedSession session;
  session.stream(1, 4);
  session.stream(2, 4, kAll);
  session.stream(3, 4);
  const auto played = play(session.file);
  EXPECT_EQ(end_.kind, ErrorKind::kUnplugged);
  EXPECT_EQ(player_->transport_counters().bytes_in, player_->decoder_counters().bytes);
  ASSERT_TRUE(player_->identity());
  EXPECT_TRUE(player_->identity()->check());
  std::map<std::uint64_t, const link::ReceivedFrames*> received;
  for (const auto& frames : session.received) received[frames.set.frame_id] = &frames;
  std::size_t compared = 0;
  for (const auto& frames : played) {
    const auto found = received.find(frames.set.frame_id);
    if (found == received.end()) continue;
    const auto tag = static_cast<unsigned>(found->second->tag);
    ASSERT_TRUE(frames.configuration) << tag;
    for (const unsigned seed : {1U, 2U, 3U}) {
      EXPECT_EQ(frames.configuration->equals(configuration(seed)), seed == tag) << seed;
    }
    const Parameters parameters = frames.configuration->parameters();
    EXPECT_EQ(parameters.speckle_size, SessionRig::setting(tag).parameters.speckle_size);
    EXPECT_EQ(uniqueness_factor(parameters),
              uniqueness_factor(SessionRig::setting(tag).parameters));
    for (const Stream stream : link::StreamSet::all()) {
      EXPECT_TRUE(same(name(stream), found->second->set.image(stream), frames.set.image(stream)));
    }
    ++compared;
  }
  EXPECT_EQ(compared, received.size());
}

TEST_F(Player, SelectsStreams) {
  RecordedSession session;
  session.stream(2, 4, kAll);
  for (const auto& frames : play(session.file, Stream::kRawLeft)) {
    EXPECT_FALSE(frames.set.image(Stream::kRawLeft).empty());
    EXPECT_TRUE(frames.set.image(Stream::kDisparity).empty());
  }
}

TEST_F(Player, KnowsNothingWithoutTheHostsBytes) {
  RecordedSession session;
  session.to_board = nullptr;
  session.stream(1, 4);
  const auto played = play(session.file);
  EXPECT_GE(played.size(), 4U);
  for (const auto& frames : played) EXPECT_FALSE(frames.configuration);
}

TEST_F(Player, ForgetsWhatAnotherHostChanges) {
  RecordedSession session;
  session.stream(1, 4);
  // Another host configures the board, and its bytes are not recorded.
  session.to_board = nullptr;
  session.stream(2, 4);
  const auto played = play(session.file);
  ASSERT_GE(played.size(), 8U);
  EXPECT_TRUE(played.front().configuration);
  EXPECT_FALSE(played.back().configuration);
}

TEST_F(Player, ComparesRegistersAndMeshes) {
  link::RecordedConfiguration held;
  held.configuration = configuration(1);
  EXPECT_TRUE(held.equals(configuration(1)));
  for (RegisterWrite& each : held.configuration.registers) {
    if (each.address == spec::kRegSpeckleSize) ++each.value;
  }
  EXPECT_FALSE(held.equals(configuration(1)));
  held.configuration = configuration(1);
  held.configuration.mesh[1].back() ^= 1;
  EXPECT_FALSE(held.equals(configuration(1)));
}

TEST_F(Player, OpensRecordingsOnly) {
  const auto usb = RecordingPlayer::open("usb");
  ASSERT_FALSE(usb);
  EXPECT_EQ(usb.error().message, "'usb' is not a recording");
  EXPECT_EQ(RecordingPlayer::open("replay:" + (folder_ / "none")).error().kind,
            ErrorKind::kNotFound);
}

}  // namespace
}  // namespace fpga_stereo::test
