// What went over a link, in a file, and the file as a link again. The format stands in
// fpga_fw/spec/link.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

constexpr char kRecordingMagic[] = "FSLINK\r\n";  // 8 bytes
constexpr std::uint32_t kRecordingVersion = 1;
constexpr std::size_t kRecordingHeaderBytes = 16, kRecordHeaderBytes = 16;
constexpr std::uint32_t kMaxRecordBytes = 1 << 24;

/// Another transport, all bytes of which are written to a file. A file that cannot be written any
/// more (a full disk) ends the recording, not the link.
class Recorder : public Transport {
 public:
  /// Overwrites `path`. On failure `inner` is lost.
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

  /// Why the recording has ended before the link.
  Status status() const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  Recorder(std::unique_ptr<Transport> inner, std::string path, std::FILE* file);
  void append(std::uint8_t direction, const std::uint8_t* bytes, std::size_t size);

  const std::unique_ptr<Transport> inner_;
  const std::string path_;
  const std::chrono::steady_clock::time_point start_;
  mutable std::mutex mutex_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::optional<Error> failed_;
};

/// What was read then is read again, at `speed` times its own pace (0: at once); what is written is
/// swallowed. A recording that breaks off in a record ends there, with kUnplugged as any other.
Result<std::unique_ptr<Transport>> open_replay(const std::string& path, double speed = 1);

}  // namespace fpga_stereo::link
