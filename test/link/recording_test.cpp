#include "link/recording.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "link/recording_file.hpp"
#include "link/test_folder.hpp"
#include "link/transport_suite.hpp"

namespace fpga_stereo::test {
namespace {

using Clock = std::chrono::steady_clock;

class Recording : public testing::Test {
 protected:
  void store(const Bytes& bytes) const {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  /// Reads a file to its end; returns the bytes and the final error.
  Bytes replay(const Bytes& file, Error& end) const {
    store(file);
    const auto opened = link::open_replay(path_, 0);
    if (!opened) {
      end = opened.error();
      return {};
    }
    Bytes bytes;
    std::uint8_t byte = 0;
    for (;;) {
      const auto got = (*opened)->read(&byte, 1, Milliseconds(0));
      if (!got) {
        end = got.error();
        return bytes;
      }
      if (*got == 1) bytes.push_back(byte);
    }
  }

  const TestFolder folder_;
  const std::string path_ = folder_ / "recording";
};

TEST_F(Recording, ReplaysTheBytesThatWereRead) {
  const Bytes sent = random_bytes(100000, 1);
  {
    const auto line = make_memory_line();
    auto inner = line->open();
    ASSERT_TRUE(inner);
    auto opened = link::Recorder::open(std::move(*inner), path_);
    ASSERT_TRUE(opened) << opened.error().message;
    auto& recorder = **opened;
    for (std::size_t at = 0; at < sent.size(); at += 20000) {
      const Bytes part(sent.begin() + static_cast<std::ptrdiff_t>(at),
                       sent.begin() + static_cast<std::ptrdiff_t>(at) + 20000);
      line->send(part);
      EXPECT_EQ(read_all(recorder, part.size(), 3000), part);
      EXPECT_EQ(write_all(recorder, part), part.size());
      EXPECT_EQ(line->take(part.size()), part);
    }
    EXPECT_TRUE(recorder.status());
    EXPECT_EQ(recorder.counters().bytes_in, sent.size());
    EXPECT_EQ(recorder.description(), "memory, recorded to " + path_);
  }
  auto replay = link::open_transport("replay:" + path_ + ":0");
  for (const std::size_t piece : {1, 511, 3000, 65536}) {
    replay = link::open_transport("replay:" + path_ + ":0");
    ASSERT_TRUE(replay) << replay.error().message;
    EXPECT_TRUE(read_all(**replay, sent.size(), piece) == sent) << piece;
  }
  EXPECT_EQ(write_all(**replay, sent), sent.size());
  EXPECT_EQ((*replay)->counters().bytes_in, sent.size());
  std::uint8_t byte = 0;
  for (int i = 0; i < 2; ++i) {
    const auto end = (*replay)->read(&byte, 1, Milliseconds(0));
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().kind, ErrorKind::kUnplugged);
    EXPECT_EQ(end.error().message, "the recording " + path_ + " has ended");
  }
}

TEST_F(Recording, MayBreakOffAnywhere) {
  Bytes file = recording_header();
  append_record(file, 5, 0, {1, 2, 3});
  append_record(file, 6, 1, {9, 9});
  const std::size_t whole = file.size();
  append_record(file, 7, 0, {4, 5, 6, 7});
  for (std::size_t size = whole; size <= file.size(); ++size) {
    Error end;
    const Bytes read =
        replay(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)), end);
    const bool all = size == file.size();
    EXPECT_EQ(read, all ? (Bytes{1, 2, 3, 4, 5, 6, 7}) : (Bytes{1, 2, 3})) << size;
    EXPECT_EQ(end.kind, ErrorKind::kUnplugged) << size;
    const bool at_a_record = all || size == whole;
    EXPECT_EQ(end.message.find("breaks off") == std::string::npos, at_a_record) << end.message;
  }
}

TEST_F(Recording, NamesTheDamage) {
  Bytes good = recording_header();
  append_record(good, 5, 0, {1, 2, 3});
  const std::size_t second = good.size();
  append_record(good, 6, 0, {4});
  const std::size_t damages[][2] = {{7, 0xFF}, {11, 1}, {12, 2}, {13, 1}, {14, 1}, {15, 1}};
  for (const auto& damage : damages) {
    Bytes file = good;
    file[second + damage[0]] = static_cast<std::uint8_t>(damage[1]);
    // Damage to byte 7 makes the second record late, which is allowed; then the third is too early.
    append_record(file, 7, 0, {5});
    Error end;
    const Bytes read = replay(file, end);
    EXPECT_EQ(Bytes(read.begin(), read.begin() + 3), (Bytes{1, 2, 3}));
    EXPECT_EQ(read.size(), damage[0] == 7 ? 4U : 3U);
    EXPECT_EQ(end.kind, ErrorKind::kIo) << damage[0];
    const std::size_t at = damage[0] == 7 ? second + 17 : second;
    EXPECT_NE(end.message.find("byte " + std::to_string(at) + " does not begin a record"),
              std::string::npos)
        << end.message;
  }
}

TEST_F(Recording, RefusesOtherFiles) {
  Error error;
  replay(Bytes(15), error);
  EXPECT_EQ(error.kind, ErrorKind::kIo);
  Bytes file = recording_header();
  file[0] = 'f';
  replay(file, error);
  EXPECT_NE(error.message.find("not a recording of a link"), std::string::npos) << error.message;
  file = recording_header();
  file[8] = 2;
  replay(file, error);
  EXPECT_NE(error.message.find("has version 2; this program reads version 1"), std::string::npos)
      << error.message;
  const auto absent = link::open_transport("replay:" + folder_ / "absent");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::kNotFound);
}

TEST_F(Recording, KeepsItsPace) {
  Bytes file = recording_header();
  append_record(file, 0, 0, {1});
  append_record(file, 80000, 0, {2});
  store(file);
  const auto opened = link::open_transport("replay:" + path_ + ":2");
  ASSERT_TRUE(opened) << opened.error().message;
  const auto begin = Clock::now();
  EXPECT_EQ(read_all(**opened, 1), Bytes{1});
  std::uint8_t byte = 0;
  const auto early = (*opened)->read(&byte, 1, Milliseconds(5));
  ASSERT_TRUE(early);
  EXPECT_LE(*early, 1U);
  EXPECT_EQ(*early == 1 ? Bytes{byte} : read_all(**opened, 1), Bytes{2});
  EXPECT_GE(Clock::now() - begin, Milliseconds(39));
}

TEST_F(Recording, AFullDiskEndsTheRecordingOnly) {
  const auto line = make_memory_line();
  auto inner = line->open();
  ASSERT_TRUE(inner);
  auto opened = link::Recorder::open(std::move(*inner), "/dev/full");
  ASSERT_TRUE(opened) << opened.error().message;
  const Bytes sent(3000000, 1);
  line->send(sent);
  EXPECT_TRUE(read_all(**opened, sent.size()) == sent);
  const Status status = (*opened)->status();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("/dev/full cannot be written: No space left"),
            std::string::npos)
      << status.error().message;
  EXPECT_FALSE(link::Recorder::open(nullptr, folder_ / "absent/file"));
}

}  // namespace
}  // namespace fpga_stereo::test
