// The output of a stage for one frame in one number, as the gateware reports it in its registers
// SIGNATURE_...: what a board computed is compared with software without carrying every image.
// fpga_fw/spec/registers.md defines it.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// Of the words of a frame, one per pixel in raster order.
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

/// The word of one pixel. For check it is `kept`, for subpixel and speckle the disparity.
std::uint32_t rectify_word(std::uint8_t left, std::uint8_t right);
/// Census bits of a pixel, as census packs them into `words` words.
std::uint32_t census_word(const std::uint32_t* left, const std::uint32_t* right, int words);
/// Column x of the sums of a row: S(x, y, d) for every d.
std::uint32_t match_word(const cv::Mat1w& sums, int x);
std::uint32_t select_word(const Selection& s, int x, int y);

/// Of an image (8UC1 or 16UC1), its pixels as words.
std::uint32_t image_signature(const cv::Mat& image);

/// The signatures of a frame, by Stage. The sums of match are no tap: they are computed again.
std::array<std::uint32_t, kNumStages> stage_signatures(const Taps& taps, const Parameters& p);

}  // namespace fpga_stereo
