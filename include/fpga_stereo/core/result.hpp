// Expected failures are values: a function that can fail for reasons outside the program returns a
// Result or a Status. Error messages name the thing, its value and what is allowed.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace fpga_stereo {

enum class ErrorKind {
  kInvalid,       // a value is out of range
  kUncalibrated,  // the camera has not been calibrated yet
  kCalibration,   // the calibration cannot be used
  kImageSize,     // an image has an unexpected size
  // Errors of the link to a board.
  kNotFound,      // the device does not exist
  kBusy,          // another program has the device
  kPermission,    // the user may not open the device
  kUnplugged,     // the device was unplugged
  kIo,            // reading or writing failed
  kIncompatible,  // this software cannot work with the board
  kTimeout,       // no answer in time
};

struct Error {
  ErrorKind kind = ErrorKind::kInvalid;
  std::string message;
};

/// A value, or the Error that prevented it. Access * and -> only if the Result is true, and error()
/// only if it is false: anything else throws std::bad_variant_access.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return state_.index() == 0; }
  const T& operator*() const { return std::get<0>(state_); }
  T& operator*() { return std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or the Error that explains the failure.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error)  // NOLINT(google-explicit-constructor)
      : error_(std::move(error)), ok_(false) {}

  explicit operator bool() const { return ok_; }
  const Error& error() const { return error_; }

 private:
  Error error_;
  bool ok_ = true;
};

}  // namespace fpga_stereo
