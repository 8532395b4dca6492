#include "sim/usb_gadget/function_fs.hpp"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "sim/ft232h/ft232h.hpp"

namespace fpga_stereo::sim {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

// What ep0 takes; the layout is that of linux/usb/functionfs.h, little-endian.
struct Interface {
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio in, out;
} __attribute__((packed));

struct Descriptors {
  usb_functionfs_descs_head_v2 head;
  __le32 num_full_speed, num_high_speed;
  Interface full_speed, high_speed;
} __attribute__((packed));

usb_endpoint_descriptor_no_audio endpoint(std::uint8_t address, std::size_t packet) {
  usb_endpoint_descriptor_no_audio bulk{};
  bulk.bLength = sizeof(bulk);
  bulk.bDescriptorType = USB_DT_ENDPOINT;
  bulk.bEndpointAddress = address;
  bulk.bmAttributes = USB_ENDPOINT_XFER_BULK;
  bulk.wMaxPacketSize = htole16(static_cast<std::uint16_t>(packet));
  return bulk;
}

Interface interface(std::size_t packet) {
  Interface all{};
  all.interface.bLength = sizeof(all.interface);
  all.interface.bDescriptorType = USB_DT_INTERFACE;
  all.interface.bNumEndpoints = 2;
  all.interface.bInterfaceClass = USB_CLASS_VENDOR_SPEC;
  all.interface.bInterfaceSubClass = 0xFF;
  all.interface.bInterfaceProtocol = 0xFF;
  all.in = endpoint(Ft232h::kIn, packet);
  all.out = endpoint(Ft232h::kOut, packet);
  return all;
}

Descriptors descriptors() {
  Descriptors all{};
  all.head.magic = htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  all.head.length = htole32(sizeof(all));
  // The requests go to the device, not to its interface; without the last flag, the kernel would
  // stall them.
  all.head.flags =
      htole32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC | FUNCTIONFS_ALL_CTRL_RECIP);
  all.num_full_speed = all.num_high_speed = htole32(3);
  all.full_speed = interface(Ft232h::kFullSpeedPacket);
  all.high_speed = interface(Ft232h::kHighSpeedPacket);
  return all;
}

/// Returns that the function has no strings; those of the device are in configfs.
usb_functionfs_strings_head strings() {
  usb_functionfs_strings_head all{};
  all.magic = htole32(FUNCTIONFS_STRINGS_MAGIC);
  all.length = htole32(sizeof(all));
  return all;
}

template <class T>
void describe(const File& file, const T& description) {
  if (write(file.descriptor(), &description, sizeof(description)) != sizeof(description)) {
    fail("FunctionFS refuses the descriptors of an FT232H");
  }
}

}  // namespace

File::File(const std::string& path) : descriptor_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (descriptor_ < 0) fail(path + ": cannot be opened");
}

File::~File() {
  if (descriptor_ >= 0) close(descriptor_);
}

FunctionFs::FunctionFs(const std::string& name) {
  std::string folder = "/tmp/fpga_stereo_XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) fail(folder + ": cannot be created");
  const bool is_mounted = mount(name.c_str(), folder.c_str(), "functionfs", 0, nullptr) == 0;
  const int mount_error = errno;
  std::string error;
  try {
    if (is_mounted) open_files(folder);
  } catch (const std::runtime_error& refused) {
    error = refused.what();
  }
  if (is_mounted) umount2(folder.c_str(), MNT_DETACH);
  rmdir(folder.c_str());
  errno = mount_error;
  if (!is_mounted) fail("FunctionFS cannot be mounted on " + folder);
  if (!error.empty()) throw std::runtime_error(error);
}

void FunctionFs::open_files(const std::string& folder) {
  control_ = std::make_unique<File>(folder + "/ep0");
  describe(*control_, descriptors());
  describe(*control_, strings());
  in_ = std::make_unique<File>(folder + "/ep1");
  out_ = std::make_unique<File>(folder + "/ep2");
}

std::size_t FunctionFs::packet_bytes() const {
  usb_endpoint_descriptor described{};
  if (ioctl(in(), FUNCTIONFS_ENDPOINT_DESC, &described) != 0) return Ft232h::kHighSpeedPacket;
  return le16toh(described.wMaxPacketSize);
}

}  // namespace fpga_stereo::sim
