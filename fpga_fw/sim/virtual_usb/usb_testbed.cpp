#include "sim/virtual_usb/usb_testbed.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace fpga_stereo::sim {
namespace {

constexpr std::size_t kMaxRetired = 16;

std::string hex(const std::vector<unsigned>& bytes) {
  std::string text;
  for (const unsigned byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02X", byte & 0xFF);
    text += digits;
  }
  return text;
}

/// Returns device and configuration descriptor (USB 2.0, section 9.6) in hexadecimal.
std::string descriptors(unsigned vendor, unsigned product, unsigned release, bool hub,
                        unsigned packet) {
  std::vector<unsigned> bytes = {
      18,          1,       0x00,         0x02,    hub ? 9U : 0U, 0, 0, 64, vendor,
      vendor >> 8, product, product >> 8, release, release >> 8,  1, 2, 3,  1};
  const std::vector<unsigned> configuration = {9, 2, hub ? 25U : 32U, 0, 1, 1, 0, 0x80, 50};
  const std::vector<unsigned> interface = {
      9, 4, 0, 0, hub ? 1U : 2U, hub ? 9U : 0xFF, hub ? 0U : 0xFF, hub ? 0U : 0xFF, 2};
  const std::vector<unsigned> endpoints =
      hub ? std::vector<unsigned>{7, 5, 0x81, 3, 4, 0, 12}
          : std::vector<unsigned>{7, 5, 0x81, 2, packet, packet >> 8, 0,
                                  7, 5, 0x02, 2, packet, packet >> 8, 0};
  for (const auto* part : {&configuration, &interface, &endpoints}) {
    bytes.insert(bytes.end(), part->begin(), part->end());
  }
  return hex(bytes);
}

std::string four(unsigned number) {
  char digits[5];
  std::snprintf(digits, sizeof(digits), "%04x", number & 0xFFFF);
  return digits;
}

std::string three(int number) {
  char digits[12];
  std::snprintf(digits, sizeof(digits), "%03d", number);
  return digits;
}

int number_of(const std::string& node) { return std::stoi(node.substr(node.rfind('/') + 1)); }

/// Returns the text for umockdev_testbed_add_from_string(). The attribute `dev` must not end with a
/// newline, because umockdev_testbed_remove_device() uses it as the name of a link.
std::string description(const std::string& path, int number, const std::string& attributes) {
  return "P: " + path + "\nE: DEVNAME=/dev/bus/usb/001/" + three(number) +
         "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=" + three(number) +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(number - 1) +
         "\nA: busnum=1\\n\nA: devnum=" + std::to_string(number) +
         "\\n\nA: dev=189:" + std::to_string(number - 1) + "\nA: bConfigurationValue=1\\n\n" +
         attributes;
}

}  // namespace

UsbTestbed& UsbTestbed::get() {
  static UsbTestbed testbed;
  return testbed;
}

UsbTestbed::UsbTestbed() : testbed_(umockdev_testbed_new()) {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  root_ = root;
  g_free(root);
  if (umockdev_in_mock_environment() == FALSE) {
    throw std::runtime_error("libumockdev-preload.so.0 is not loaded");
  }
  // Without a bus, libusb would search /dev of this machine.
  const std::lock_guard lock(mutex_);
  std::filesystem::create_directories(root_ + "/dev/bus/usb/001");
  add_hub("usb1", "/devices/usb1");
}

UsbTestbed::~UsbTestbed() {
  g_object_unref(testbed_);
  std::error_code ignored;
  if (moved_) std::filesystem::remove_all(root_, ignored);
}

void UsbTestbed::move_to(const std::string& folder) {
  const std::lock_guard lock(mutex_);
  // Other programs use the real path; umockdev, which chose the old name, follows the link.
  std::filesystem::rename(root_, folder);
  std::filesystem::create_directory_symlink(folder, root_);
  root_ = folder;
  moved_ = true;
  setenv("UMOCKDEV_DIR", root_.c_str(), 1);
}

std::vector<std::string> UsbTestbed::environment() const {
  return {"UMOCKDEV_DIR=" + root_, "LD_PRELOAD=libumockdev-preload.so.0"};
}

void UsbTestbed::describe(const std::string& text) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) != FALSE) return;
  const std::string message = error != nullptr ? error->message : "unknown";
  g_clear_error(&error);
  throw std::runtime_error("umockdev refuses the device: " + message);
}

/// Returns the next free device number. Like the kernel, it counts up to 127 and starts again.
int UsbTestbed::next_number() {
  do {
    last_number_ = last_number_ % 127 + 1;
  } while (!numbers_.insert(last_number_).second);
  return last_number_;
}

std::string UsbTestbed::make_node(_UMockdevIoctlBase* handler, int& fifo) {
  const std::lock_guard lock(mutex_);
  std::string node = "/dev/bus/usb/001/" + three(next_number());
  // Attach first: once the device is shown, programs may open it at once.
  if (umockdev_testbed_attach_ioctl(testbed_, node.c_str(), handler, nullptr) == FALSE) {
    throw std::runtime_error("umockdev refuses the handler of " + node);
  }
  const std::string file = root_ + node;
  std::filesystem::create_directories(root_ + "/dev/bus/usb/001");
  if (mkfifo(file.c_str(), 0666) != 0 || chmod(file.c_str(), 0666) != 0) {
    throw std::runtime_error("cannot create " + file + ": " + std::strerror(errno));
  }
  fifo = open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fifo < 0) throw std::runtime_error("cannot open " + file + ": " + std::strerror(errno));
  fcntl(fifo, F_SETPIPE_SZ, 4096);
  return node;
}

void UsbTestbed::add_hub(const std::string& name, const std::string& path) {
  if (!hubs_.emplace(name, path).second) return;
  const int number = next_number();
  // Nobody opens a hub, but libusb reads its position. Its file keeps the folder from being
  // removed.
  std::ofstream(root_ + "/dev/bus/usb/001/" + three(number));
  describe(description(path, number,
                       "A: speed=480\\n\nA: idVendor=1d6b\\n\nA: idProduct=0002\\n\n"
                       "A: bDeviceClass=09\\n\nH: descriptors=" +
                           descriptors(0x1D6B, 2, 0x0600, true, 0) + "\n"));
}

std::string UsbTestbed::add(const UsbfsDevice::Identity& identity, const std::string& node) {
  const std::lock_guard lock(mutex_);
  std::string path = "/devices/usb1";
  for (std::size_t dot = identity.port.find('.'); dot != std::string::npos;
       dot = identity.port.find('.', dot + 1)) {
    const std::string name = identity.port.substr(0, dot);
    path += "/" + name;
    add_hub(name, path);
  }
  path += "/" + identity.port;
  const int number = number_of(node);
  describe(description(path, number,
                       std::string("A: speed=") + (identity.high_speed ? "480" : "12") +
                           "\\n\nA: idVendor=" + four(identity.vendor) + "\\n\nA: idProduct=" +
                           four(identity.product) + "\\n\nA: serial=" + identity.serial_number +
                           "\\n\nA: product=" + identity.product_name + "\\n\nA: manufacturer=" +
                           identity.manufacturer + "\\n\nA: bDeviceClass=00\\n\nH: descriptors=" +
                           descriptors(identity.vendor, identity.product, identity.release, false,
                                       identity.high_speed ? 512 : 64) +
                           "\n"));
  return "/sys" + path;
}

void UsbTestbed::remove(const std::string& syspath, const std::string& node) {
  const std::lock_guard lock(mutex_);
  umockdev_testbed_uevent(testbed_, syspath.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, syspath.c_str());
  // Keep the handler for a while: umockdev ends a program that opens a file without a handler.
  retired_.push_back(node);
  if (retired_.size() <= kMaxRetired) return;
  umockdev_testbed_detach_ioctl(testbed_, retired_.front().c_str(), nullptr);
  numbers_.erase(number_of(retired_.front()));
  retired_.pop_front();
}

void UsbTestbed::permit(const std::string& node, bool others) {
  // All users must find the device, and libusb must create a socket, for open() to be refused.
  chmod(root_.c_str(), 0777);
  chmod((root_ + "/ioctl/" + node).c_str(), 0777);
  chmod((root_ + node).c_str(), others ? 0666 : 0600);
}

}  // namespace fpga_stereo::sim
