// Synthetic images: extremes, noise from fixed seeds, and textures whose values between pixels are
// known.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo::test {

cv::Mat1b random_image(cv::Size size, unsigned seed);
cv::Mat3b random_color_image(cv::Size size, unsigned seed);
cv::Mat1b checkerboard(cv::Size size);
/// Returns an image of (step_x x + step_y y) mod 256.
cv::Mat1b ramp(cv::Size size, int step_x, int step_y);

struct NamedImage {
  std::string name;
  cv::Mat1b image;
};
/// Returns flat, black and white images, a checkerboard, ramps, noise, and noise of 0 and 255.
std::vector<NamedImage> extreme_images(cv::Size size, unsigned seed);

/// Returns the same pixels as part of a larger image full of noise, so that the row pitch exceeds
/// the width.
cv::Mat padded(const cv::Mat& image, unsigned seed);

/// A smooth random texture, 0 .. 255, with a value at every real position: a sum of sines.
class Texture {
 public:
  explicit Texture(unsigned seed);
  double operator()(double x, double y) const;

 private:
  struct Wave {
    double x, y, phase;
  };
  std::vector<Wave> waves_;
};

struct SlantedPair {
  cv::Mat1b left, right;
};
/// Returns the images of a slanted plane: left pixel x has disparity a + b x.
/// right(x, y) = texture(x, y), left(x, y) = texture(x - (a + b x), y).
SlantedPair slanted_pair(cv::Size size, const Texture& texture, double a, double b);

}  // namespace fpga_stereo::test
