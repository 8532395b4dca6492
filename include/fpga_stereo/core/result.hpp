// Expected failures are values: a function that can fail for reasons outside the program returns
// a Result, and says what is wrong, which value it has and what is allowed.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace fpga_stereo {

enum class ErrorKind {
  kInvalid,       // a value out of its range
  kUncalibrated,  // a camera that nobody has calibrated yet
  kCalibration,   // a calibration that cannot be used
  kImageSize,     // an image whose size is not the expected one
  // Of a link.
  kNotFound,      // no such device
  kBusy,          // another program has the device
  kPermission,    // the device may not be opened
  kUnplugged,     // the device was unplugged
  kIo,            // the line does not work
  kIncompatible,  // a board that this software cannot work with
  kTimeout,       // no answer in time
};

struct Error {
  ErrorKind kind = ErrorKind::kInvalid;
  std::string message;
};

/// A value, or the Error that explains why there is none.
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
