#include "support/files.hpp"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "fpga_stereo/core/convert.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;

std::string extension(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::ifstream open_file(const std::string& path) {
  if (fs::is_directory(path)) throw std::runtime_error(path + ": is a folder, not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  }
  return file;
}

std::vector<unsigned char> read_bytes(const std::string& path) {
  std::ifstream file = open_file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Removes the colour profiles of a PNG, which no program here uses: libpng prints warnings about
/// many of them. Leaves data that is not a well-formed PNG unchanged.
void drop_colour_profile(std::vector<unsigned char>& png) {
  constexpr std::size_t kSignature = 8, kAroundData = 12;
  constexpr std::array<unsigned char, kSignature> signature{0x89, 'P',  'N',  'G',
                                                            '\r', '\n', 0x1a, '\n'};
  if (png.size() < kSignature || !std::equal(signature.begin(), signature.end(), png.begin())) {
    return;
  }
  std::size_t at = kSignature;
  while (at + kAroundData <= png.size()) {
    const std::size_t length = std::size_t{png[at]} << 24 | std::size_t{png[at + 1]} << 16 |
                               std::size_t{png[at + 2]} << 8 | std::size_t{png[at + 3]};
    if (length > png.size() - at - kAroundData) return;
    const auto chunk = png.begin() + static_cast<std::ptrdiff_t>(at);
    const std::string type(chunk + 4, chunk + 8);
    if (type == "IDAT") return;  // profiles precede the pixels
    if (type == "iCCP") {
      png.erase(chunk, chunk + static_cast<std::ptrdiff_t>(kAroundData + length));
    } else {
      at += kAroundData + length;
    }
  }
}

bool is_image(const fs::path& path) {
  static const std::vector<std::string> known{".png", ".jpg", ".jpeg", ".bmp",
                                              ".pgm", ".ppm", ".tif",  ".tiff"};
  return std::find(known.begin(), known.end(), extension(path.string())) != known.end();
}

std::vector<std::string> expand(const std::string& argument) {
  std::vector<std::string> found;
  if (fs::is_directory(argument)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(argument)) {
      if (entry.is_regular_file() && is_image(entry.path())) found.push_back(entry.path().string());
    }
  } else if (fs::exists(argument)) {
    found.push_back(argument);
  } else {
    glob_t matches{};
    if (glob(argument.c_str(), 0, nullptr, &matches) == 0) {
      found.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    }
    globfree(&matches);
  }
  return found;
}

}  // namespace

cv::Mat read_image(const std::string& path) {
  std::vector<unsigned char> bytes = read_bytes(path);
  drop_colour_profile(bytes);
  cv::Mat image;
  try {
    if (!bytes.empty()) image = cv::imdecode(bytes, cv::IMREAD_ANYCOLOR);
  } catch (const cv::Exception& e) {
    throw std::runtime_error(fmt::format("{}: is not an image: {}", path, e.err));
  }
  if (image.empty()) throw std::runtime_error(path + ": is not an image");
  return image;
}

cv::Mat1b read_grey(const std::string& path) {
  const cv::Mat image = read_image(path);
  if (image.channels() == 1) return image;
  cv::Mat1b grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

cv::Mat1b read_first_channel(const std::string& path) {
  cv::Mat1b channel;
  cv::extractChannel(read_image(path), channel, 0);
  return channel;
}

void write_image(const std::string& path, const cv::Mat& image) {
  bool written = false;
  std::string why;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception& e) {
    why = ": " + e.err;
  }
  if (!written) throw std::runtime_error(path + ": cannot be written" + why);
}

std::ofstream create_file(const std::string& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be written");
  return file;
}

void close_file(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

void require_picture_extension(const std::string& option, const std::string& path) {
  bool known = false;
  try {
    known = !extension(path).empty() && cv::haveImageWriter(path);
  } catch (const cv::Exception&) {
    // OpenCV cannot parse the extension.
  }
  if (known) return;
  throw UsageError(
      fmt::format("{} \"{}\": allowed are files of an image format, such as .png, .jpg and .ppm",
                  option, path));
}

void create_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path)) {
    throw std::runtime_error(fmt::format("{}: cannot be created: {}", path, error.message()));
  }
}

void require_disparity_extension(const std::string& path) {
  const std::string given = extension(path);
  if (given == ".png" || given == ".pfm") return;
  throw UsageError(fmt::format(
      "OUT \"{}\" has the extension \"{}\": allowed are .png and .pfm; other formats lose "
      "disparities",
      path, given));
}

void write_disparity(const std::string& path, const cv::Mat1w& disparity, int min_disparity) {
  if (extension(path) == ".png") {
    write_image(path, disparity);
    return;
  }
  cv::Mat1f values;
  to_float(disparity, min_disparity, std::numeric_limits<float>::infinity(), values);
  write_image(path, values);
}

std::vector<std::string> list_images(const std::string& option,
                                     const std::vector<std::string>& arguments) {
  std::vector<std::string> images;
  for (const std::string& argument : arguments) {
    const std::vector<std::string> found = expand(argument);
    if (found.empty()) {
      throw std::runtime_error(fmt::format("{} {}: no image has this name", option, argument));
    }
    images.insert(images.end(), found.begin(), found.end());
  }
  std::sort(images.begin(), images.end());
  return images;
}

}  // namespace fpga_stereo::tools
