// Uses termios2, which accepts any rate. Its header excludes <termios.h>.
#include "link/serial.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <grp.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "core/printable.hpp"
#include "link/clock.hpp"

namespace fpga_stereo::link {
namespace {

/// Chips divide a clock to make a rate. UARTs tolerate an error of about 4 %.
constexpr double kBaudTolerance = 0.03;
constexpr std::size_t kMaxNameBytes = 300;  // of a line in a message

class SerialTransport : public Transport {
 public:
  SerialTransport(int file, std::string path, int baud)
      : file_(file), path_(std::move(path)), baud_(baud) {}
  SerialTransport(const SerialTransport&) = delete;
  SerialTransport& operator=(const SerialTransport&) = delete;
  ~SerialTransport() override { close(file_); }

  Status set_up() const;
  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Status recover(Recovery step) override;
  std::string description() const override {
    return path_ + " at " + std::to_string(baud_) + " baud";
  }
  Counters counters() const override;

 private:
  Error gone() const { return {ErrorKind::kUnplugged, path_ + " is gone: it was unplugged"}; }
  Error failure(int code, const char* what) const;
  std::optional<Error> wait(short events, Clock::time_point deadline) const;
  std::uint64_t line_errors() const;

  const int file_;
  const std::string path_;
  const int baud_;
  std::atomic<bool> gone_{false};
  std::atomic<std::uint64_t> bytes_in_{0}, bytes_out_{0};
};

Status SerialTransport::set_up() const {
  struct termios2 settings {};
  if (ioctl(file_, TCGETS2, &settings) != 0) return serial_error(errno, path_);
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = BOTHER | (BOTHER << IBSHIFT) | CS8 | CREAD | CLOCAL;
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud_);
  settings.c_cc[VMIN] = 1;  // a read of 0 bytes means that the line is gone
  settings.c_cc[VTIME] = 0;
  if (ioctl(file_, TCSETS2, &settings) != 0) return serial_error(errno, path_);
  if (ioctl(file_, TCGETS2, &settings) != 0) return serial_error(errno, path_);
  const double rate = settings.c_ospeed;
  if (rate < baud_ * (1 - kBaudTolerance) || rate > baud_ * (1 + kBaudTolerance)) {
    return Error{ErrorKind::kIo, fmt::format("{} does not support {} baud; the nearest rate is {}",
                                             path_, baud_, settings.c_ospeed)};
  }
  // Fails on a pty, which has no modem lines.
  const int lines = TIOCM_DTR | TIOCM_RTS;
  ioctl(file_, TIOCMBIS, &lines);
  return {};
}

Error SerialTransport::failure(int code, const char* what) const {
  if (code == EIO || code == ENXIO || code == ENODEV) return gone();
  return {ErrorKind::kIo, path_ + " cannot be " + what + ": " + std::strerror(code)};
}

/// Blocks until the line is ready or the deadline has passed; returns an error if poll() fails.
std::optional<Error> SerialTransport::wait(short events, Clock::time_point deadline) const {
  for (;;) {
    const auto left = std::chrono::ceil<Timeout>(deadline - Clock::now()).count();
    pollfd line{file_, events, 0};
    const int code = poll(&line, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
    if (code < 0 && errno != EINTR) return failure(errno, "waited for");
    if (code > 0 || left <= 0) return std::nullopt;
  }
}

Result<std::size_t> SerialTransport::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  if (gone_) return gone();
  if (size == 0) return std::size_t{0};
  if (const auto error = wait(POLLIN, Clock::now() + timeout)) return *error;
  const ssize_t got = ::read(file_, bytes, size);
  if (got > 0) {
    bytes_in_ += static_cast<std::uint64_t>(got);
    return static_cast<std::size_t>(got);
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
  const Error error = got == 0 ? gone() : failure(errno, "read");
  gone_ = error.kind == ErrorKind::kUnplugged;
  return error;
}

Result<std::size_t> SerialTransport::write(const std::uint8_t* bytes, std::size_t size,
                                           Timeout timeout) {
  const auto until = Clock::now() + timeout;
  std::size_t done = 0;
  while (done < size) {
    if (gone_) return gone();
    const ssize_t went = ::write(file_, bytes + done, size - done);
    if (went > 0) {
      done += static_cast<std::size_t>(went);
      bytes_out_ += static_cast<std::uint64_t>(went);
      continue;
    }
    if (went < 0 && errno != EAGAIN && errno != EINTR) {
      const Error error = failure(errno, "written");
      gone_ = error.kind == ErrorKind::kUnplugged;
      return error;
    }
    if (Clock::now() >= until) break;
    if (const auto error = wait(POLLOUT, until)) return *error;
  }
  return done;
}

Status SerialTransport::recover(Recovery step) {
  if (gone_) return gone();
  if (ioctl(file_, TCFLSH, TCIOFLUSH) != 0) return failure(errno, "purged");
  if (step == Recovery::kPurge) return {};
  if (step == Recovery::kRestart) return set_up();
  // Toggling the modem lines is all that can be done to the device.
  const int lines = TIOCM_DTR | TIOCM_RTS;
  ioctl(file_, TIOCMBIC, &lines);
  gone_ = true;
  return {};
}

/// Returns how often the chip or the kernel lost bytes; 0 for a pty.
std::uint64_t SerialTransport::line_errors() const {
  serial_icounter_struct counts{};
  if (ioctl(file_, TIOCGICOUNT, &counts) != 0) return 0;
  return static_cast<std::uint64_t>(counts.overrun) + counts.buf_overrun + counts.frame;
}

Transport::Counters SerialTransport::counters() const {
  return {bytes_in_, bytes_out_, line_errors()};
}

std::string group_of(const std::string& path) {
  struct stat state {};
  if (stat(path.c_str(), &state) != 0) return "";
  const group* entry = getgrgid(state.st_gid);
  return entry == nullptr ? std::to_string(state.st_gid) : entry->gr_name;
}

std::string known_lines() {
  std::string text;
  for (const auto& line : list_serial()) {
    text += (text.empty() ? "" : ", ") + printable(line.name, kMaxNameBytes);
  }
  return text.empty() ? "no serial lines found" : "found: " + text;
}

}  // namespace

Error serial_error(int code, const std::string& path) {
  const std::string message = path + " cannot be opened: " + std::strerror(code);
  switch (code) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
    case EIO:  // its device was just unplugged
      return {ErrorKind::kNotFound, message + "; " + known_lines()};
    case EBUSY:
    case EWOULDBLOCK:
      return {ErrorKind::kBusy, path + " is used by another program: stop that program first"};
    case EACCES:
    case EPERM: {
      const std::string group = group_of(path);
      return {
          ErrorKind::kPermission,
          message + (group.empty() ? ""
                                   : "; it belongs to group " + group + ": run 'sudo usermod -aG " +
                                         group + " $USER' and log in again")};
    }
    case ENOTTY:
      return {ErrorKind::kIo, path + " is not a serial line"};
    default:
      return {ErrorKind::kIo, message};
  }
}

Result<std::unique_ptr<Transport>> open_serial(const std::string& path, int baud) {
  // O_NONBLOCK, because open() otherwise waits for a carrier.
  const int file = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return serial_error(errno, path);
  auto transport = std::make_unique<SerialTransport>(file, path, baud);
  if (isatty(file) == 0) return serial_error(ENOTTY, path);
  // flock() keeps out programs that ask for the lock, TIOCEXCL all others except root's.
  if (flock(file, LOCK_EX | LOCK_NB) != 0) return serial_error(errno, path);
  if (ioctl(file, TIOCEXCL) != 0) return serial_error(errno, path);
  if (const Status set_up = transport->set_up(); !set_up) return set_up.error();
  ioctl(file, TCFLSH, TCIOFLUSH);
  return std::unique_ptr<Transport>(std::move(transport));
}

std::vector<FoundDevice> list_serial(const std::string& dev) {
  namespace fs = std::filesystem;
  std::vector<FoundDevice> found;
  const auto add = [&](const fs::path& folder, const std::vector<std::string>& prefixes) {
    std::error_code failed;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed)) {
      const std::string file = entry->path().filename().string();
      for (const auto& prefix : prefixes) {
        if (file.compare(0, prefix.size(), prefix) != 0) continue;
        std::error_code none;
        const auto target = fs::canonical(entry->path(), none);
        found.push_back({"serial:" + entry->path().string(),
                         "serial line " + printable(none ? file : target.filename().string())});
        break;
      }
    }
  };
  add(dev + "/serial/by-id", {""});
  if (found.empty()) add(dev, {"ttyUSB", "ttyACM"});
  std::sort(found.begin(), found.end(),
            [](const FoundDevice& a, const FoundDevice& b) { return a.name < b.name; });
  return found;
}

}  // namespace fpga_stereo::link
