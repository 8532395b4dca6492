// The image streams of a board, and sets of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::link {

/// The stream that a frame belongs to. kNone marks packets that belong to no frame.
enum class Stream : std::uint8_t {
  kNone = 0,
  kDisparity = kStreamDisparity,
  kRectifiedLeft = kStreamRectifiedLeft,
  kRectifiedRight = kStreamRectifiedRight,
  kRawLeft = kStreamRawLeft,
  kRawRight = kStreamRawRight,
  kInput = kStreamInput,  // host to board: pairs; each row holds the left row, then the right row
};
constexpr int kNumStreams = 7;  // including kNone

/// Returns the stream's name for messages: "disparity", "rectified left", ...
const char* name(Stream stream);

/// A set of streams. On the wire it is a bit mask in which bit s stands for stream s.
class StreamSet {
 public:
  constexpr StreamSet() = default;
  constexpr StreamSet(Stream stream)  // NOLINT(google-explicit-constructor)
      : bits_(bit(stream)) {}
  constexpr StreamSet(std::initializer_list<Stream> streams) {
    for (const Stream stream : streams) bits_ |= bit(stream);
  }
  /// Builds a set from a register's bits. Ignores bits that stand for no stream.
  static constexpr StreamSet from_bits(std::uint32_t bits) {
    StreamSet set;
    set.bits_ = bits & kAllBits;
    return set;
  }
  static constexpr StreamSet all() { return from_bits(kAllBits); }
  /// Returns the set as registers hold it.
  constexpr std::uint32_t bits() const { return bits_; }

  constexpr bool contains(Stream stream) const { return (bits_ & bit(stream)) != 0; }
  constexpr bool contains_all(StreamSet other) const { return (other.bits_ & ~bits_) == 0; }
  constexpr bool contains_any(StreamSet other) const { return (other.bits_ & bits_) != 0; }
  constexpr bool empty() const { return bits_ == 0; }

  constexpr void insert(StreamSet other) { bits_ |= other.bits_; }
  constexpr void erase(StreamSet other) { bits_ &= ~other.bits_; }

  /// Union.
  friend constexpr StreamSet operator|(StreamSet a, StreamSet b) {
    return from_bits(a.bits_ | b.bits_);
  }
  /// Intersection.
  friend constexpr StreamSet operator&(StreamSet a, StreamSet b) {
    return from_bits(a.bits_ & b.bits_);
  }
  /// Difference: the streams of `a` that `b` lacks.
  friend constexpr StreamSet operator-(StreamSet a, StreamSet b) {
    return from_bits(a.bits_ & ~b.bits_);
  }
  constexpr StreamSet& operator|=(StreamSet other) { return *this = *this | other; }
  constexpr StreamSet& operator&=(StreamSet other) { return *this = *this & other; }
  constexpr StreamSet& operator-=(StreamSet other) { return *this = *this - other; }
  friend constexpr bool operator==(StreamSet a, StreamSet b) { return a.bits_ == b.bits_; }
  friend constexpr bool operator!=(StreamSet a, StreamSet b) { return a.bits_ != b.bits_; }

  /// Visits the streams of the set in ascending order.
  class Iterator {
   public:
    constexpr explicit Iterator(std::uint32_t rest) : rest_(rest) {}
    constexpr Stream operator*() const {
      int number = 0;
      while ((rest_ >> number & 1) == 0) ++number;
      return static_cast<Stream>(number);
    }
    constexpr Iterator& operator++() {
      rest_ &= rest_ - 1;
      return *this;
    }
    constexpr bool operator!=(Iterator other) const { return rest_ != other.rest_; }

   private:
    std::uint32_t rest_;
  };
  constexpr Iterator begin() const { return Iterator(bits_); }
  constexpr Iterator end() const { return Iterator(0); }

 private:
  static constexpr std::uint32_t kAllBits = (1U << kNumStreams) - 2;
  static constexpr std::uint32_t bit(Stream stream) {
    const auto number = static_cast<int>(stream);  // a packet may hold any
    return number > 0 && number < kNumStreams ? 1U << number : 0;
  }

  std::uint32_t bits_ = 0;
};

/// Returns the names of the streams, separated by commas; "none" for an empty set.
std::string to_text(StreamSet streams);

}  // namespace fpga_stereo::link
