#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>
#include <vector>

#include "link/packet.hpp"
#include "link/recording.hpp"

namespace fpga_stereo::link {
namespace {

using Clock = std::chrono::steady_clock;

class Replay : public Transport {
 public:
  Replay(std::ifstream file, std::string path, double speed)
      : file_(std::move(file)), path_(std::move(path)), speed_(speed), start_(Clock::now()) {}

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Status recover(Recovery step) override;
  std::string description() const override { return "the recording " + path_; }
  Counters counters() const override { return {bytes_in_, bytes_out_, 0}; }

 private:
  /// Loads the next record of received bytes; at the end of the file sets end_.
  void next();
  void end(ErrorKind kind, const std::string& message);

  std::ifstream file_;
  const std::string path_;
  const double speed_;
  const Clock::time_point start_;
  std::uint64_t offset_ = kRecordingHeaderBytes;  // in the file, of the next record
  std::uint64_t time_ = 0;                        // us, of the last record
  std::vector<std::uint8_t> record_;
  std::size_t at_ = 0;  // first byte of record_ that was not read
  std::optional<Error> end_;
  std::atomic<std::uint64_t> bytes_in_{0}, bytes_out_{0};
};

void Replay::end(ErrorKind kind, const std::string& message) {
  record_.clear();
  at_ = 0;
  end_ = Error{kind, "the recording " + path_ + message};
}

void Replay::next() {
  while (!end_) {
    std::array<std::uint8_t, kRecordHeaderBytes> header{};
    file_.read(reinterpret_cast<char*>(header.data()), header.size());
    if (file_.gcount() < static_cast<std::streamsize>(header.size())) {
      return end(ErrorKind::kUnplugged, file_.gcount() == 0 ? " has ended" : " breaks off");
    }
    const std::uint64_t time = get_u64(header.data());
    const std::uint32_t size = get_u32(header.data() + 8);
    if (size == 0 || size > kMaxRecordBytes || header[12] > 1 || header[13] != 0 ||
        header[14] != 0 || header[15] != 0 || time < time_) {
      return end(ErrorKind::kIo,
                 fmt::format(" is damaged: byte {} does not begin a record", offset_));
    }
    record_.resize(size);
    file_.read(reinterpret_cast<char*>(record_.data()), size);
    if (file_.gcount() < static_cast<std::streamsize>(size)) {
      return end(ErrorKind::kUnplugged, " breaks off");
    }
    offset_ += kRecordHeaderBytes + size;
    time_ = time;
    at_ = 0;
    if (header[12] == 0) return;
  }
}

Result<std::size_t> Replay::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  if (at_ == record_.size()) next();
  if (end_) return *end_;
  if (speed_ > 0) {
    const std::chrono::duration<double, std::micro> after(static_cast<double>(time_) / speed_);
    const auto due = start_ + std::chrono::duration_cast<Clock::duration>(after);
    const auto until = Clock::now() + timeout;
    std::this_thread::sleep_until(std::min(due, until));
    if (Clock::now() < due) return std::size_t{0};
  }
  const std::size_t part = std::min(size, record_.size() - at_);
  std::memcpy(bytes, record_.data() + at_, part);
  at_ += part;
  bytes_in_ += part;
  return part;
}

Result<std::size_t> Replay::write(const std::uint8_t*, std::size_t size, Timeout) {
  bytes_out_ += size;
  return size;
}

Status Replay::recover(Recovery step) {
  if (step == Recovery::kReset) end(ErrorKind::kUnplugged, " was reset: open it again");
  if (end_) return *end_;
  return {};
}

}  // namespace

Result<std::unique_ptr<Transport>> open_replay(const std::string& path, double speed) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const auto kind = errno == ENOENT   ? ErrorKind::kNotFound
                      : errno == EACCES ? ErrorKind::kPermission
                                        : ErrorKind::kIo;
    return Error{kind, "the recording " + path + " cannot be opened: " + std::strerror(errno)};
  }
  std::array<std::uint8_t, kRecordingHeaderBytes> header{};
  file.read(reinterpret_cast<char*>(header.data()), header.size());
  if (file.gcount() < static_cast<std::streamsize>(header.size()) ||
      std::memcmp(header.data(), kRecordingMagic, 8) != 0) {
    return Error{ErrorKind::kIo, path + " is not a recording of a link: its first bytes are wrong"};
  }
  const std::uint32_t version = get_u32(header.data() + 8);
  if (version != kRecordingVersion) {
    return Error{ErrorKind::kIo,
                 fmt::format("the recording {} has version {}; this program reads version {}", path,
                             version, kRecordingVersion)};
  }
  return std::unique_ptr<Transport>(std::make_unique<Replay>(std::move(file), path, speed));
}

}  // namespace fpga_stereo::link
