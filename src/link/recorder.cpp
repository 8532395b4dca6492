#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "link/packet.hpp"
#include "link/recording.hpp"

namespace fpga_stereo::link {
namespace {

Error file_error(const std::string& path) {
  const int code = errno;
  const auto kind = code == EACCES || code == EPERM ? ErrorKind::kPermission
                    : code == ENOENT                ? ErrorKind::kNotFound
                                                    : ErrorKind::kIo;
  return {kind, fmt::format("the recording {} cannot be written: {}", path, std::strerror(code))};
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::open(std::unique_ptr<Transport> inner,
                                                 const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "wbe");
  if (file == nullptr) return file_error(path);
  std::unique_ptr<Recorder> recorder(new Recorder(std::move(inner), path, file));
  std::array<std::uint8_t, kRecordingHeaderBytes> header{};
  std::copy_n(kRecordingMagic, 8, header.begin());
  put_u32(header.data() + 8, kRecordingVersion);
  if (std::fwrite(header.data(), header.size(), 1, file) != 1) return file_error(path);
  return recorder;
}

Recorder::Recorder(std::unique_ptr<Transport> inner, std::string path, std::FILE* file)
    : inner_(std::move(inner)), path_(std::move(path)), start_(Clock::now()), file_(file) {
  // A large buffer: at 40 MB/s in pieces of some KiB, 40 system calls per second.
  std::setvbuf(file, nullptr, _IOFBF, 1 << 20);
}

Recorder::~Recorder() = default;

void Recorder::append(std::uint8_t direction, const std::uint8_t* bytes, std::size_t size) {
  const auto time = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start_);
  const MutexLock lock(mutex_);
  while (size > 0 && file_) {
    const std::size_t part = std::min<std::size_t>(size, kMaxRecordBytes);
    std::array<std::uint8_t, kRecordHeaderBytes> header{};
    put_u64(header.data(), static_cast<std::uint64_t>(time.count()));
    put_u32(header.data() + 8, static_cast<std::uint32_t>(part));
    header[12] = direction;
    if (std::fwrite(header.data(), header.size(), 1, file_.get()) != 1 ||
        std::fwrite(bytes, part, 1, file_.get()) != 1) {
      failure_ = file_error(path_);
      file_.reset();
    }
    bytes += part;
    size -= part;
  }
}

Result<std::size_t> Recorder::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  auto got = inner_->read(bytes, size, timeout);
  if (got) append(0, bytes, *got);
  return got;
}

Result<std::size_t> Recorder::write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  auto went = inner_->write(bytes, size, timeout);
  if (went) append(1, bytes, *went);
  return went;
}

std::string Recorder::description() const {
  return inner_->description() + ", recorded to " + path_;
}

Status Recorder::status() const {
  const MutexLock lock(mutex_);
  if (failure_) return *failure_;
  return {};
}

}  // namespace fpga_stereo::link
