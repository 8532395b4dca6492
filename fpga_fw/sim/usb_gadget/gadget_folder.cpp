#include "sim/usb_gadget/gadget_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace fpga_stereo::sim {
namespace {

const char* const kGadgets = "/sys/kernel/config/usb_gadget";
const char* const kControllers = "/sys/class/udc";

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error(what + ": " + std::strerror(error));
}

/// Writes the text with one system call, as configfs needs it. Returns 0 or an errno.
int write_text(const std::string& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = write(file, text.data(), text.size()) < 0 ? errno : 0;
  close(file);
  return error;
}

void require_text(const std::string& path, const std::string& text) {
  if (const int error = write_text(path, text); error != 0) {
    fail(path + ": cannot be set to \"" + text + "\"", error);
  }
}

void make_folder(const std::string& path) {
  if (mkdir(path.c_str(), 0755) != 0) fail(path + ": cannot be created", errno);
}

std::string hex(unsigned number) {
  char digits[8];
  std::snprintf(digits, sizeof(digits), "0x%04x", number & 0xFFFF);
  return digits;
}

std::vector<std::string> controllers() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& each : std::filesystem::directory_iterator(kControllers, none)) {
    names.push_back(each.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

GadgetFolder::GadgetFolder(const std::string& name, const Options& options)
    : name_(name), path_(std::string(kGadgets) + "/" + name) {
  if (access(kGadgets, F_OK) != 0) {
    throw std::runtime_error(
        std::string(kGadgets) +
        ": not found: a USB gadget needs configfs (mount -t configfs none /sys/kernel/config) and "
        "the module usb_f_fs");
  }
  std::string bound;
  std::getline(std::ifstream(path_ + "/UDC"), bound);
  if (!bound.empty()) {
    throw std::runtime_error(path_ + ": another program uses this gadget on " + bound);
  }
  remove();
  try {
    make_folder(path_);
    require_text(path_ + "/idVendor", hex(options.identity.vendor));
    require_text(path_ + "/idProduct", hex(options.identity.product));
    require_text(path_ + "/bcdDevice", hex(options.identity.release));
    if (!options.high_speed) require_text(path_ + "/max_speed", "full-speed");
    const std::string strings = path_ + "/strings/0x409";  // US English
    make_folder(strings);
    require_text(strings + "/manufacturer", options.identity.manufacturer);
    require_text(strings + "/product", options.identity.product_name);
    require_text(strings + "/serialnumber", options.identity.serial_number);
    make_folder(path_ + "/configs/c.1");
    require_text(path_ + "/configs/c.1/MaxPower", std::to_string(options.max_power));
    const std::string function = path_ + "/functions/ffs." + name_;
    make_folder(function);
    const std::string link = path_ + "/configs/c.1/ffs." + name_;
    if (symlink(function.c_str(), link.c_str()) != 0) fail(link + ": cannot be created", errno);
  } catch (...) {
    remove();
    throw;
  }
}

GadgetFolder::~GadgetFolder() {
  unbind();
  remove();
}

/// Removes the folder, in the order that configfs demands. Missing parts are no error.
void GadgetFolder::remove() const {
  unlink((path_ + "/configs/c.1/ffs." + name_).c_str());
  const std::string function = "functions/ffs." + name_;
  for (const auto* part : {"configs/c.1", function.c_str(), "strings/0x409", ""}) {
    rmdir((path_ + "/" + part).c_str());
  }
}

void GadgetFolder::bind() {
  const std::string file = path_ + "/UDC";
  if (!controller_.empty()) return require_text(file, controller_);
  const auto names = controllers();
  if (names.empty()) {
    throw std::runtime_error(
        std::string(kControllers) +
        ": empty: this machine has no USB device controller (the module dummy_hcd is a virtual "
        "one)");
  }
  std::string refusals;
  for (const auto& name : names) {
    const int error = write_text(file, name);
    if (error == 0) {
      controller_ = name;
      return;
    }
    refusals += (refusals.empty() ? "" : "; ") + name + ": " + std::strerror(error);
  }
  throw std::runtime_error(file + ": no USB device controller takes the gadget: " + refusals);
}

void GadgetFolder::unbind() { write_text(path_ + "/UDC", "\n"); }

}  // namespace fpga_stereo::sim
