#include "core/pending_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "link/test_folder.hpp"

namespace fpga_stereo::test {
namespace {

namespace fs = std::filesystem;

class PendingFiles : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return folder_ / name; }
  static std::string contents(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  static void write(const std::string& path, const std::string& text) {
    std::ofstream(path) << text;
  }
  std::size_t count_files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  void expect_refused(const std::string& path, const std::string& why) const {
    const auto pending = PendingFile::write(path, "new");
    ASSERT_FALSE(pending) << path;
    EXPECT_EQ(pending.error().message, path + ": cannot be written: " + why);
    EXPECT_EQ(pending.error().kind, ErrorKind::kIo);
  }

  TestFolder folder_;
};

TEST_F(PendingFiles, ReplaceAFileOnlyWhenTheyAreCommitted) {
  write(at("file"), "old");
  auto pending = PendingFile::write(at("file"), "new");
  ASSERT_TRUE(pending);
  EXPECT_EQ(contents(at("file")), "old");
  EXPECT_EQ(contents(at("file.new")), "new");
  ASSERT_TRUE((*pending).commit());
  EXPECT_EQ(contents(at("file")), "new");
  EXPECT_EQ(count_files(), 1U);
}

TEST_F(PendingFiles, LeaveNothingBehindUnlessTheyAreCommitted) {
  write(at("file"), "old");
  { ASSERT_TRUE(PendingFile::write(at("file"), "new")); }
  EXPECT_EQ(contents(at("file")), "old");
  EXPECT_EQ(count_files(), 1U);
}

TEST_F(PendingFiles, CreateTheirFolder) {
  auto pending = PendingFile::write(at("a/b/c/file"), "new");
  ASSERT_TRUE(pending) << pending.error().message;
  ASSERT_TRUE((*pending).commit());
  EXPECT_EQ(contents(at("a/b/c/file")), "new");
}

TEST_F(PendingFiles, OverwriteWhatACrashHasLeft) {
  write(at("file.new"), std::string(100000, 'x'));
  auto pending = PendingFile::write(at("file"), "new");
  ASSERT_TRUE(pending && (*pending).commit());
  EXPECT_EQ(contents(at("file")), "new");
}

TEST_F(PendingFiles, TakeOverWhatACrashHasLeft) {
  write(at("file"), "old");
  write(at("file.new"), "new");
  ASSERT_TRUE(PendingFile::take_over(at("file")).commit());
  EXPECT_EQ(contents(at("file")), "new");
  EXPECT_EQ(count_files(), 1U);
  const Status missing = PendingFile::take_over(at("file")).commit();
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message, at("file") + ": cannot be written: No such file or directory");
}

TEST_F(PendingFiles, FollowSymbolicLinksAndKeepTheMode) {
  fs::create_directory(at("a"));
  write(at("a/file"), "old");
  chmod(at("a/file").c_str(), 0600);
  fs::create_symlink("a/file", at("link"));
  auto pending = PendingFile::write(at("link"), "new");
  ASSERT_TRUE(pending && (*pending).commit());
  EXPECT_TRUE(fs::is_symlink(at("link")));
  EXPECT_EQ(contents(at("a/file")), "new");
  EXPECT_EQ(fs::status(at("a/file")).permissions(), fs::perms(0600));
  // Nobody can make a link of the temporary file to have another file overwritten.
  write(at("victim"), "old");
  fs::create_symlink("victim", at("a/file.new"));
  auto again = PendingFile::write(at("link"), "newer");
  ASSERT_TRUE(again && (*again).commit());
  EXPECT_EQ(contents(at("victim")), "old");
  EXPECT_EQ(contents(at("a/file")), "newer");
}

TEST_F(PendingFiles, RefuseWhatCannotBeWritten) {
  write(at("file"), "old");
  expect_refused(at("file/left.yaml"), "Not a directory");
  expect_refused(folder_.path(), "it is not a file");
  expect_refused("/dev/null", "it is not a file");
  expect_refused("/proc/fpga_stereo/left.yaml", "No such file or directory");
  if (geteuid() == 0) return;  // root may write anywhere
  fs::create_directory(at("locked"));
  write(at("locked/file"), "old");
  chmod(at("locked").c_str(), 0500);
  expect_refused(at("locked/file"), "Permission denied");
  chmod(at("locked").c_str(), 0700);
  chmod(at("locked/file").c_str(), 0400);
  expect_refused(at("locked/file"), "Permission denied");
}

TEST_F(PendingFiles, LeaveTheOldFileOnAFullDisk) {
  write(at("file"), "old");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  {
    const auto pending = PendingFile::write(at("file"), std::string(5000, 'x'));
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    ASSERT_FALSE(pending);
    EXPECT_EQ(pending.error().message, at("file") + ": cannot be written: File too large");
  }
  EXPECT_EQ(contents(at("file")), "old");
  EXPECT_EQ(count_files(), 1U);
}

}  // namespace
}  // namespace fpga_stereo::test
