// Replaces a file such that a crash or a full disk leaves the old one or the new one, and no part.
#pragma once

#include <string>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// The new contents of a file, complete and on the disk, beside the file that they will replace.
class PendingFile {
 public:
  /// Writes `text` to the temporary file of `path`. Creates the folder, and overwrites a temporary
  /// file that a crash has left. Refuses a `path` that exists but is no file or may not be written.
  static Result<PendingFile> write(const std::string& path, const std::string& text);
  /// Returns the name of the temporary file.
  static std::string temporary(const std::string& path);
  /// Takes over a temporary file that a crash has left.
  static PendingFile take_over(const std::string& path);

  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&&) = delete;
  /// Removes the temporary file, unless it has replaced the file.
  ~PendingFile();

  /// Replaces the file.
  Status commit();

 private:
  explicit PendingFile(std::string path);

  std::string path_;  // empty: committed or moved from
};

}  // namespace fpga_stereo
