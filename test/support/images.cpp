#include "support/images.hpp"

#include <cmath>

namespace fpga_stereo::test {
namespace {

template <class Pixel>
cv::Mat_<Pixel> noise(cv::Size size, unsigned seed) {
  cv::Mat_<Pixel> image(size);
  cv::RNG(seed + 1).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

}  // namespace

cv::Mat1b random_image(cv::Size size, unsigned seed) { return noise<std::uint8_t>(size, seed); }

cv::Mat3b random_color_image(cv::Size size, unsigned seed) { return noise<cv::Vec3b>(size, seed); }

cv::Mat1b checkerboard(cv::Size size) {
  cv::Mat1b image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(y, x) = (x + y) % 2 == 0 ? 0 : 255;
  }
  return image;
}

cv::Mat1b ramp(cv::Size size, int step_x, int step_y) {
  cv::Mat1b image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image(y, x) = static_cast<std::uint8_t>(step_x * x + step_y * y);
    }
  }
  return image;
}

std::vector<NamedImage> extreme_images(cv::Size size, unsigned seed) {
  const cv::Mat1b random = random_image(size, seed);
  return {{"flat", cv::Mat1b(size, std::uint8_t{128})},
          {"black", cv::Mat1b(size, std::uint8_t{0})},
          {"white", cv::Mat1b(size, std::uint8_t{255})},
          {"checker", checkerboard(size)},
          {"ramp", ramp(size, 1, 3)},
          {"falling ramp", ramp(size, -3, -1)},
          {"random", random},
          {"random of 0 and 255", random >= 128}};
}

cv::Mat padded(const cv::Mat& image, unsigned seed) {
  cv::Mat large(image.rows + 7, image.cols + 13, image.type());
  const cv::Mat bytes(large.rows, large.cols * static_cast<int>(large.elemSize()), CV_8UC1,
                      large.data, large.step);
  cv::Mat1b(random_image(bytes.size(), seed)).copyTo(bytes);
  const cv::Mat part = large(cv::Rect({5, 3}, image.size()));
  image.copyTo(part);
  return part;
}

Texture::Texture(unsigned seed) {
  cv::RNG rng(seed + 1);
  for (int i = 0; i < 40; ++i) {
    // Wavelengths of 5 px and more: a pixel grid samples them without aliasing.
    const double frequency = rng.uniform(0.2, 1.2);
    const double direction = rng.uniform(0.0, CV_PI);
    waves_.push_back({frequency * std::cos(direction), frequency * std::sin(direction),
                      rng.uniform(0.0, 2 * CV_PI)});
  }
}

double Texture::operator()(double x, double y) const {
  double sum = 0;
  for (const Wave& wave : waves_) sum += std::sin(wave.x * x + wave.y * y + wave.phase);
  const double deviation = std::sqrt(0.5 * static_cast<double>(waves_.size()));
  return std::min(255.0, std::max(0.0, 128 + 45 * sum / deviation));
}

SlantedPair slanted_pair(cv::Size size, const Texture& texture, double a, double b) {
  SlantedPair pair{cv::Mat1b(size), cv::Mat1b(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      pair.left(y, x) = cv::saturate_cast<std::uint8_t>(texture(x - (a + b * x), y));
      pair.right(y, x) = cv::saturate_cast<std::uint8_t>(texture(x, y));
    }
  }
  return pair;
}

}  // namespace fpga_stereo::test
