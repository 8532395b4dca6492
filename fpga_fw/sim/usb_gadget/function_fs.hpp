// The files of a FunctionFS: through them, a program is a function of a USB gadget.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace fpga_stereo::sim {

/// A file descriptor, closed by the destructor.
class File {
 public:
  File() = default;
  /// Opens an existing file for reading and writing. Throws std::runtime_error.
  explicit File(const std::string& path);
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// One interface with the endpoints of an FT232H. Every path that the program needs has been opened
/// and removed again when the constructor returns, so a program that is killed leaves nothing here.
class FunctionFs {
 public:
  /// Mounts the FunctionFS `name`, describes the function, and opens its files. Throws
  /// std::runtime_error.
  explicit FunctionFs(const std::string& name);

  int control() const { return control_->descriptor(); }
  int in() const { return in_->descriptor(); }
  int out() const { return out_->descriptor(); }
  /// Returns the packet size of the bulk endpoints at the speed of the present connection.
  std::size_t packet_bytes() const;

 private:
  void open_files(const std::string& folder);

  std::unique_ptr<File> control_, in_, out_;
};

}  // namespace fpga_stereo::sim
