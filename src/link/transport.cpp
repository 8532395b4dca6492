#include "fpga_stereo/link/transport.hpp"

#include <utility>

#include "link/hotplug_watch.hpp"
#include "link/recording.hpp"
#include "link/serial.hpp"
#include "link/transport_name.hpp"
#include "link/usb.hpp"

namespace fpga_stereo::link {

std::vector<FoundDevice> list_devices() {
  auto devices = list_usb();
  for (auto& line : list_serial()) devices.push_back(std::move(line));
  return devices;
}

Result<std::unique_ptr<Transport>> open_transport(const std::string& name) {
  const auto selection = parse_transport_name(name);
  if (!selection) return selection.error();
  switch (selection->kind) {
    case TransportName::Kind::kSerial:
      return open_serial(selection->path, static_cast<int>(selection->number));
    case TransportName::Kind::kReplay:
      return open_replay(selection->path, selection->number);
    case TransportName::Kind::kUsb:
      break;
  }
  return open_usb(selection->usb);
}

Status check_transport_name(const std::string& name) {
  if (const auto selection = parse_transport_name(name); !selection) return selection.error();
  return {};
}

std::shared_ptr<HotplugWatch> watch_for(const std::string& name) {
  return name.substr(0, name.find(':')) == "usb" ? std::make_shared<HotplugWatch>() : nullptr;
}

}  // namespace fpga_stereo::link
