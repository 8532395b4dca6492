// Signatures: checksums of the output of a stage for one frame. The gateware reports them in its
// SIGNATURE registers, so that tests can compare every stage with software without transferring all
// images. fpga_fw/spec/registers.md defines them.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// The signature of the words of a frame, one per pixel in raster order.
class Signature {
 public:
  explicit Signature(std::uint32_t value = kSignatureStart) : value_(value) {}

  /// s <- x s + word, modulo the polynomial of CRC-32C.
  void add(std::uint32_t word) {
    const std::uint32_t carried = (value_ >> 31) != 0 ? kSignaturePolynomial : 0;
    value_ = (value_ << 1) ^ carried ^ word;
  }
  std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_;
};

// The word of a pixel, by stage. For check it is `kept`, for subpixel and speckle the disparity.

std::uint32_t rectify_word(std::uint8_t left, std::uint8_t right);
/// `left` and `right` point to the census bits of a pixel, which census packs into `words` words.
std::uint32_t census_word(const std::uint32_t* left, const std::uint32_t* right, int words);
/// `sums` holds the window sums of a row: column x has S(x, y, d) for every d.
std::uint32_t match_word(const cv::Mat1w& sums, int x);
std::uint32_t select_word(const Selection& s, int x, int y);

/// Returns the signature of an image (8UC1 or 16UC1) whose pixels are the words.
std::uint32_t image_signature(const cv::Mat& image);

/// Returns the signatures of a frame of window matching, in the order of kGatewareStages. Taps have
/// no window sums, so match runs again.
std::array<std::uint32_t, kNumGatewareStages> stage_signatures(const Taps& taps,
                                                               const Parameters& p);

}  // namespace fpga_stereo
