#include "link/usb_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <regex>
#include <utility>

#include "core/printable.hpp"
#include "link/ftdi.hpp"

namespace fpga_stereo::link {
namespace {

constexpr unsigned kRequestTimeout = 500;  // ms
constexpr int kInterface = 0;

/// A device that is plugged in.
struct Board {
  std::shared_ptr<libusb_device> device;
  std::string port;  // "1-2.3"
  std::string serial, product;
  int open_error = 0;            // of libusb; if not 0, serial and product are unknown
  std::string rejection_reason;  // why the device is not a board; empty if that is unknown

  std::string text() const {
    if (open_error != 0) return "port " + port + " (" + libusb_error_name(open_error) + ")";
    const std::string why = rejection_reason.empty() ? "" : " (" + rejection_reason + ")";
    return "serial number " + (serial.empty() ? "(none)" : serial) + " at port " + port + why;
  }
  std::string name() const {
    return "USB " + port + (serial.empty() ? "" : ", serial number " + serial);
  }
};

std::string port_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string text = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < depth; ++i) {
    text += (i == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return text;
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  if (index == 0) return "";
  const int size =
      libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
  if (size < 0) return "";
  // Anybody can write these texts into a device, and they end on terminals.
  return printable({reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(size)});
}

std::vector<Board> find_boards(const UsbContext& context) {
  std::vector<Board> boards;
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context.get(), &list);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    if (descriptor.idVendor != kUsbVendor || descriptor.idProduct != kUsbProduct) continue;
    Board board;
    // Keeps the context alive as long as the device.
    board.device = {libusb_ref_device(list[i]),
                    [context](libusb_device* device) { libusb_unref_device(device); }};
    board.port = port_of(list[i]);
    libusb_device_handle* handle = nullptr;
    board.open_error = libusb_open(list[i], &handle);
    if (board.open_error == 0) {
      board.serial = text_of(handle, descriptor.iSerialNumber);
      board.product = text_of(handle, descriptor.iProduct);
      libusb_close(handle);
    }
    boards.push_back(board);
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  std::sort(boards.begin(), boards.end(),
            [](const Board& a, const Board& b) { return a.port < b.port; });
  return boards;
}

bool is_selected(const Board& board, const UsbSelection& selection, const std::regex& regex) {
  switch (selection.by) {
    case UsbSelection::By::kFirst:
      return true;
    case UsbSelection::By::kSerial:
      return board.open_error == 0 && board.serial == selection.value;
    case UsbSelection::By::kPort:
      return board.port == selection.value;
    case UsbSelection::By::kMatch:
      return board.open_error == 0 &&
             (std::regex_search(board.serial, regex) || std::regex_search(board.product, regex));
  }
  return false;
}

Error not_found(const UsbSelection& selection, const std::vector<Board>& boards) {
  std::string message = "no USB board (FT232H, 0403:6014)";
  if (selection.by == UsbSelection::By::kSerial) message += " with serial number ";
  if (selection.by == UsbSelection::By::kPort) message += " at port ";
  if (selection.by == UsbSelection::By::kMatch) message += " whose serial number or name matches ";
  message += selection.value;
  if (boards.empty()) {
    return {ErrorKind::kNotFound, message + " found: is it plugged in and powered?"};
  }
  std::string there;
  int open_error = 0;  // of a device whose name is therefore unknown: it may be the board
  for (const auto& board : boards) {
    there += (there.empty() ? "" : "; ") + board.text();
    if (board.open_error != 0) open_error = board.open_error;
  }
  if (open_error == LIBUSB_ERROR_ACCESS) {
    return usb_error(open_error, message + " among those that may be opened (" + there + ")");
  }
  return {ErrorKind::kNotFound, message + "; found: " + there};
}

/// Finds the endpoints of interface 0.
Status find_endpoints(libusb_device* device, UsbDevice& opened) {
  libusb_config_descriptor* raw = nullptr;
  if (const int code = libusb_get_active_config_descriptor(device, &raw); code != 0) {
    return usb_error(code, opened.name + ": no configuration descriptor");
  }
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)>
      configuration(raw, &libusb_free_config_descriptor);
  if (configuration->bNumInterfaces > kInterface &&
      configuration->interface[kInterface].num_altsetting > 0) {
    const auto& interface = configuration->interface[kInterface].altsetting[0];
    for (int i = 0; i < interface.bNumEndpoints; ++i) {
      const auto& endpoint = interface.endpoint[i];
      if ((endpoint.bmAttributes & 3) != LIBUSB_TRANSFER_TYPE_BULK) continue;
      const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
      (in ? opened.in : opened.out) = endpoint.bEndpointAddress;
      if (in) opened.packet = endpoint.wMaxPacketSize;
    }
  }
  // Each packet begins with two status bytes, so it must be longer than that.
  if (opened.in == 0 || opened.out == 0 || opened.packet < 8 || opened.packet > 1024) {
    return Error{ErrorKind::kIo,
                 opened.name + " does not have the two bulk endpoints of an FT232H"};
  }
  return {};
}

/// Reads word 0 of the EEPROM. Asks the device, not its interface, which its present driver keeps.
Result<std::uint16_t> read_mode(const UsbDevice& device) {
  std::uint8_t word[2] = {};
  if (Status got = device.receive(kReadEeprom, 0, word, 2); !got) return got.error();
  return static_cast<std::uint16_t>(word[0] | word[1] << 8);
}

/// Opens a board without claiming its interface.
Result<UsbDevice> open_board(const UsbContext& context, const Board& board) {
  UsbDevice opened;
  opened.context = context;
  opened.name = board.name();
  libusb_device_handle* raw = nullptr;
  if (const int code = libusb_open(board.device.get(), &raw); code != 0) {
    return usb_error(code, opened.name + " cannot be opened");
  }
  opened.handle = {raw, [context](libusb_device_handle* handle) {
                     libusb_release_interface(handle, kInterface);
                     libusb_close(handle);
                   }};
  if (const Status found = find_endpoints(board.device.get(), opened); !found) return found.error();
  return opened;
}

Result<UsbDevice> claim(const UsbDevice& opened) {
  // Detaches ftdi_sio, which would drive the chip as a serial line.
  libusb_set_auto_detach_kernel_driver(opened.handle.get(), 1);
  if (const int code = libusb_claim_interface(opened.handle.get(), kInterface); code != 0) {
    return usb_error(code, opened.name + " cannot be claimed");
  }
  return opened;
}

}  // namespace

Result<UsbContext> make_usb_context() {
  libusb_context* context = nullptr;
  if (const int code = libusb_init(&context); code != 0) {
    return usb_error(code, "libusb does not start");
  }
  return UsbContext(context, [](libusb_context* made) { libusb_exit(made); });
}

Error usb_error(int code, const std::string& what) {
  const std::string message = what + ": " + libusb_strerror(static_cast<libusb_error>(code));
  switch (code) {
    case LIBUSB_ERROR_NO_DEVICE:
      return {ErrorKind::kUnplugged, message + "; it was unplugged or lost its power"};
    case LIBUSB_ERROR_BUSY:
      return {ErrorKind::kBusy, message + "; another program uses it: stop that program first"};
    case LIBUSB_ERROR_ACCESS:
      return {
          ErrorKind::kPermission,
          message +
              "; copy config/70-fpga-stereo.rules of this package to /etc/udev/rules.d, run "
              "'udevadm control --reload', and plug the board in again; the file says what to do "
              "for a board whose EEPROM names another manufacturer than fpga_stereo"};
    case LIBUSB_ERROR_TIMEOUT:
      return {ErrorKind::kIo, message + "; unplug it and plug it in again"};
    default:
      return {ErrorKind::kIo, message};
  }
}

Status UsbDevice::send(std::uint8_t request, std::uint16_t value, std::uint16_t index) const {
  const int code = libusb_control_transfer(
      handle.get(), static_cast<std::uint8_t>(LIBUSB_REQUEST_TYPE_VENDOR) | LIBUSB_RECIPIENT_DEVICE,
      request, value, index, nullptr, 0, kRequestTimeout);
  if (code >= 0) return {};
  return usb_error(code,
                   fmt::format("{} does not accept request {} (value {})", name, request, value));
}

Status UsbDevice::receive(std::uint8_t request, std::uint16_t index, std::uint8_t* bytes,
                          std::uint16_t size) const {
  const int code = libusb_control_transfer(handle.get(),
                                           static_cast<std::uint8_t>(LIBUSB_REQUEST_TYPE_VENDOR) |
                                               LIBUSB_RECIPIENT_DEVICE | LIBUSB_ENDPOINT_IN,
                                           request, 0, index, bytes, size, kRequestTimeout);
  if (code == size) return {};
  return usb_error(code < 0 ? code : LIBUSB_ERROR_IO,
                   fmt::format("{} does not answer request {}", name, request));
}

Result<std::regex> match_of(const UsbSelection& selection) {
  if (selection.by != UsbSelection::By::kMatch) return std::regex();
  try {
    return std::regex(selection.value);
  } catch (const std::regex_error& error) {
    return Error{ErrorKind::kInvalid, fmt::format("'{}' is not a regular expression: {}",
                                                  selection.value, error.what())};
  }
}

Result<UsbDevice> open_usb_device(const UsbSelection& selection) {
  const auto regex = match_of(selection);
  if (!regex) return regex.error();
  const auto context = make_usb_context();
  if (!context) return context.error();
  auto boards = find_boards(*context);
  for (auto& board : boards) {
    if (!is_selected(board, selection, *regex)) continue;
    const auto opened = open_board(*context, board);
    if (!opened) return opened.error();
    // Checked before claiming, so that serial adapters with the same chip keep their drivers.
    const auto mode = read_mode(*opened);
    if (!mode) return mode.error();
    const bool first = selection.by == UsbSelection::By::kFirst;
    const Status fifo = check_fifo_mode(*mode, first ? "it" : opened->name);
    if (fifo) return claim(*opened);
    if (!first) return fifo.error();
    board.rejection_reason = fifo.error().message;
  }
  return not_found(selection, boards);
}

std::vector<FoundDevice> list_usb() {
  std::vector<FoundDevice> found;
  const auto context = make_usb_context();
  if (!context) return found;
  for (const auto& board : find_boards(*context)) {
    const std::string product = board.product.empty() ? "FT232H" : board.product;
    found.push_back({"usb:port=" + board.port, product + ", " + board.text()});
  }
  return found;
}

}  // namespace fpga_stereo::link
