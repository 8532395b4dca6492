// Recordings of a link: a transport that writes one, and a transport that replays one. The file
// format is in fpga_fw/spec/link.md.
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"
#include "link/clock.hpp"

namespace fpga_stereo::link {

constexpr char kRecordingMagic[] = "FSLINK\r\n";  // 8 bytes
constexpr std::uint32_t kRecordingVersion = 1;
constexpr std::size_t kRecordingHeaderBytes = 16, kRecordHeaderBytes = 16;
constexpr std::uint32_t kMaxRecordBytes = 1 << 24;

/// Passes on what another transport carries and writes all bytes to a file. An error of the file (a
/// full disk) ends the recording, not the link.
class Recorder : public Transport {
 public:
  /// Overwrites the file `path`. On failure `inner` is closed.
  static Result<std::unique_ptr<Recorder>> open(std::unique_ptr<Transport> inner,
                                                const std::string& path);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() override;

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Status recover(Recovery step) override { return inner_->recover(step); }
  std::string description() const override;
  Counters counters() const override { return inner_->counters(); }

  /// Returns the error of the file that ended the recording, if any.
  Status status() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  Recorder(std::unique_ptr<Transport> inner, std::string path, std::FILE* file);
  void append(std::uint8_t direction, const std::uint8_t* bytes, std::size_t size)
      FPGA_STEREO_EXCLUDES(mutex_);

  const std::unique_ptr<Transport> inner_;
  const std::string path_;
  const Time start_;
  mutable Mutex mutex_;
  /// Null once the recording has ended.
  std::unique_ptr<std::FILE, CloseFile> file_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::optional<Error> failure_ FPGA_STEREO_GUARDED_BY(mutex_);
};

/// Reads the records of a recording.
class RecordReader {
 public:
  struct Record {
    std::uint64_t time = 0;  // us since the recording began
    bool is_from_host = false;
    std::vector<std::uint8_t> bytes;
  };

  /// Opens a recording. Fails with kNotFound, kPermission, or kIo if it is none.
  static Result<RecordReader> open(const std::string& path);
  /// Reads the next record. Fails with kUnplugged at the end of the file, also within a record, and
  /// with kIo at damage. A failure lasts.
  Status next(Record& record);
  /// Returns a text for people.
  std::string description() const { return "the recording " + path_; }

 private:
  RecordReader(std::ifstream file, std::string path)
      : file_(std::move(file)), path_(std::move(path)) {}
  Error end(ErrorKind kind, const std::string& message);

  std::ifstream file_;
  std::string path_;
  std::uint64_t offset_ = kRecordingHeaderBytes;  // in the file, of the next record
  std::uint64_t time_ = 0;                        // us, of the last record
  std::optional<Error> end_;
};

/// Waits for the records of a recording, whose time may run faster.
class RecordClock {
 public:
  /// `speed` 0: nothing is waited for.
  explicit RecordClock(double speed) : speed_(speed) {}
  /// Waits until the record with this time is due, `timeout` at most. Returns whether it is due.
  bool wait(std::uint64_t time, std::chrono::milliseconds timeout) const;

 private:
  const double speed_;
  const Clock::time_point start_ = Clock::now();
};

/// Opens a recording as a transport: read() gives what was read then, `speed` times as fast (0:
/// without waiting); what is written is discarded. A recording ends with kUnplugged, also one that
/// breaks off within a record.
Result<std::unique_ptr<Transport>> open_replay(const std::string& path, double speed = 1);

}  // namespace fpga_stereo::link
