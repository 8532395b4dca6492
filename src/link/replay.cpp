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

#include "link/clock.hpp"
#include "link/packet.hpp"
#include "link/recording.hpp"

namespace fpga_stereo::link {
namespace {

class Replay : public Transport {
 public:
  Replay(RecordReader reader, double speed) : reader_(std::move(reader)), clock_(speed) {}

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Status recover(Recovery step) override;
  std::string description() const override { return reader_.description(); }
  Counters counters() const override { return {bytes_in_, bytes_out_, 0}; }

 private:
  RecordReader reader_;
  const RecordClock clock_;
  RecordReader::Record record_;  // of received bytes
  std::size_t at_ = 0;           // first byte of record_ that was not read
  std::optional<Error> end_;
  std::atomic<std::uint64_t> bytes_in_{0}, bytes_out_{0};
};

Result<std::size_t> Replay::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  while (!end_ && at_ == record_.bytes.size()) {
    if (const Status next = reader_.next(record_); !next) end_ = next.error();
    at_ = record_.is_from_host ? record_.bytes.size() : 0;
  }
  if (end_) return *end_;
  if (!clock_.wait(record_.time, timeout)) return std::size_t{0};
  const std::size_t part = std::min(size, record_.bytes.size() - at_);
  std::memcpy(bytes, record_.bytes.data() + at_, part);
  at_ += part;
  bytes_in_ += part;
  return part;
}

Result<std::size_t> Replay::write(const std::uint8_t*, std::size_t size, Timeout) {
  bytes_out_ += size;
  return size;
}

Status Replay::recover(Recovery step) {
  if (step == Recovery::kReset) {
    end_ = Error{ErrorKind::kUnplugged, description() + " was reset: open it again"};
  }
  if (end_) return *end_;
  return {};
}

}  // namespace

Result<RecordReader> RecordReader::open(const std::string& path) {
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
  return RecordReader(std::move(file), path);
}

Error RecordReader::end(ErrorKind kind, const std::string& message) {
  end_ = Error{kind, description() + message};
  return *end_;
}

Status RecordReader::next(Record& record) {
  record.bytes.clear();
  if (end_) return *end_;
  std::array<std::uint8_t, kRecordHeaderBytes> header{};
  file_.read(reinterpret_cast<char*>(header.data()), header.size());
  if (file_.gcount() < static_cast<std::streamsize>(header.size())) {
    return end(ErrorKind::kUnplugged, file_.gcount() == 0 ? " has ended" : " breaks off");
  }
  const std::uint64_t time = get_u64(header.data());
  const std::uint32_t size = get_u32(header.data() + 8);
  if (size == 0 || size > kMaxRecordBytes || header[12] > 1 || header[13] != 0 || header[14] != 0 ||
      header[15] != 0 || time < time_) {
    return end(ErrorKind::kIo,
               fmt::format(" is damaged: byte {} does not begin a record", offset_));
  }
  // In parts: a damaged size must not have memory allocated for bytes that are not there.
  constexpr std::size_t kPart = 1 << 16;
  while (record.bytes.size() < size) {
    const std::size_t at = record.bytes.size(), part = std::min<std::size_t>(size - at, kPart);
    record.bytes.resize(at + part);
    file_.read(reinterpret_cast<char*>(&record.bytes[at]), static_cast<std::streamsize>(part));
    if (file_.gcount() == static_cast<std::streamsize>(part)) continue;
    record.bytes.clear();
    return end(ErrorKind::kUnplugged, " breaks off");
  }
  offset_ += kRecordHeaderBytes + size;
  record.time = time_ = time;
  record.is_from_host = header[12] != 0;
  return {};
}

bool RecordClock::wait(std::uint64_t time, std::chrono::milliseconds timeout) const {
  if (speed_ <= 0) return true;
  constexpr double kMaxTime = 1e14;  // us: later than any deadline, and not too much for a duration
  const std::chrono::duration<double, std::micro> after(
      std::min(static_cast<double>(time) / speed_, kMaxTime));
  const auto due = start_ + std::chrono::duration_cast<Clock::duration>(after);
  std::this_thread::sleep_until(std::min(due, Clock::now() + timeout));
  return Clock::now() >= due;
}

Result<std::unique_ptr<Transport>> open_replay(const std::string& path, double speed) {
  auto reader = RecordReader::open(path);
  if (!reader) return reader.error();
  return std::unique_ptr<Transport>(std::make_unique<Replay>(std::move(*reader), speed));
}

}  // namespace fpga_stereo::link
