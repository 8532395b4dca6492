#include "core/pending_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace fpga_stereo {
namespace {

namespace fs = std::filesystem;

Error write_error(const std::string& path, const std::string& why) {
  return {ErrorKind::kIo, fmt::format("{}: cannot be written: {}", path, why)};
}

/// Writes all bytes to the disk, not only to the system's memory. Closes the file in any case.
/// Returns 0 or an error of errno.
int write_and_close(int file, const std::string& text) {
  int code = 0;
  for (std::size_t done = 0; code == 0 && done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (written == 0) {
      code = ENOSPC;
    } else if (errno != EINTR) {
      code = errno;
    }
  }
  if (code == 0 && fsync(file) != 0) code = errno;
  if (close(file) != 0 && code == 0) code = errno;
  return code;
}

/// Returns the path of the file itself if `path` is a symbolic link.
std::string resolved(const std::string& path) {
  std::error_code failed;
  const fs::path real = fs::canonical(path, failed);
  return failed ? path : real.string();
}

}  // namespace

PendingFile::PendingFile(std::string path) : path_(std::move(path)) {}

PendingFile::PendingFile(PendingFile&& other) noexcept : path_(std::exchange(other.path_, {})) {}

PendingFile::~PendingFile() {
  if (!path_.empty()) unlink(temporary(path_).c_str());
}

std::string PendingFile::temporary(const std::string& path) { return resolved(path) + ".new"; }

PendingFile PendingFile::take_over(const std::string& path) { return PendingFile(resolved(path)); }

Result<PendingFile> PendingFile::write(const std::string& path, const std::string& text) {
  const std::string target = resolved(path);
  std::error_code failed;
  const fs::path folder = fs::path(target).parent_path();
  if (!folder.empty()) fs::create_directories(folder, failed);
  if (failed) return write_error(path, failed.message());
  struct stat present {};
  const bool exists = stat(target.c_str(), &present) == 0;
  if (exists && !S_ISREG(present.st_mode)) return write_error(path, "it is not a file");
  if (exists && access(target.c_str(), W_OK) != 0) return write_error(path, std::strerror(errno));
  const std::string name = temporary(target);
  unlink(name.c_str());
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0) return write_error(path, std::strerror(errno));
  PendingFile pending(target);
  // The new file belongs to whom the old one does, as far as this process may arrange that.
  if (exists && fchown(file, present.st_uid, present.st_gid) == 0) fchmod(file, present.st_mode);
  if (const int code = write_and_close(file, text); code != 0) {
    return write_error(path, std::strerror(code));
  }
  return pending;
}

Status PendingFile::commit() {
  if (rename(temporary(path_).c_str(), path_.c_str()) != 0) {
    return write_error(path_, std::strerror(errno));
  }
  const std::string folder = fs::path(std::exchange(path_, {})).parent_path().string();
  // Without this, a power failure may undo the renaming.
  const int directory = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (directory >= 0) {
    fsync(directory);
    close(directory);
  }
  return {};
}

}  // namespace fpga_stereo
