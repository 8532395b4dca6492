#include "link/transport_name.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <utility>

#include "link/serial.hpp"

namespace fpga_stereo::link {
namespace {

constexpr int kMaxBaud = 100'000'000;

Error bad_name(const std::string& name, const std::string& why) {
  return {ErrorKind::kInvalid,
          fmt::format("'{}' is not a transport: {}; allowed are usb, usb:serial=NUMBER, "
                      "usb:port=BUS-PORT, usb:match=REGEX, serial:PATH[:BAUD], replay:FILE[:SPEED]",
                      name, why)};
}

/// Parses a whole number or a decimal fraction; nullopt if anything else follows.
std::optional<double> number(const std::string& text) {
  if (text.empty() || text.find_first_not_of("0123456789.") != std::string::npos) {
    return std::nullopt;
  }
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Splits "PATH:NUMBER". A text that exists as a path is not split: some names in
/// /dev/serial/by-path end in ":1.0".
std::pair<std::string, std::optional<double>> split_number(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::error_code failed;
  if (colon != std::string::npos && !std::filesystem::exists(text, failed)) {
    if (const auto value = number(text.substr(colon + 1))) return {text.substr(0, colon), value};
  }
  return {text, std::nullopt};
}

bool is_port(const std::string& text) {
  const std::size_t dash = text.find('-');
  return dash != std::string::npos && dash > 0 && dash + 1 < text.size() &&
         text.find_first_not_of("0123456789-.") == std::string::npos;
}

Result<UsbSelection> parse_usb(const std::string& name, const std::string& rest) {
  UsbSelection selection;
  if (name == "usb") return selection;
  const std::size_t equals = rest.find('=');
  const std::string key = rest.substr(0, equals);
  selection.value = equals == std::string::npos ? "" : rest.substr(equals + 1);
  if (key == "serial") {
    selection.by = UsbSelection::By::kSerial;
  } else if (key == "port") {
    selection.by = UsbSelection::By::kPort;
  } else if (key == "match") {
    selection.by = UsbSelection::By::kMatch;
  } else {
    return bad_name(name, "'" + key + "' does not select a board");
  }
  if (selection.value.empty()) return bad_name(name, key + " needs a value");
  if (key == "port" && !is_port(selection.value)) {
    return bad_name(name, "'" + selection.value + "' is not a port such as 1-2.3");
  }
  if (const auto regex = match_of(selection); !regex) return regex.error();
  return selection;
}

}  // namespace

Result<TransportName> parse_transport_name(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string scheme = name.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : name.substr(colon + 1);
  TransportName selection;
  if (scheme == "usb") {
    const auto usb = parse_usb(name, rest);
    if (!usb) return usb.error();
    selection.usb = *usb;
    return selection;
  }
  const auto [path, number] = split_number(rest);
  selection.path = path;
  if (scheme == "serial") {
    selection.kind = TransportName::Kind::kSerial;
    selection.number = number.value_or(kDefaultBaud);
    if (path.empty()) return bad_name(name, "the path is missing");
    const double rate = selection.number;
    if (rate < 1 || rate > kMaxBaud || rate != std::floor(rate)) {
      return bad_name(name, "the baud rate must be a whole number from 1 to 100000000");
    }
    return selection;
  }
  if (scheme == "replay") {
    selection.kind = TransportName::Kind::kReplay;
    selection.number = number.value_or(1);
    if (path.empty()) return bad_name(name, "the file is missing");
    return selection;
  }
  return bad_name(name, "'" + scheme + "' is not a kind of transport");
}

}  // namespace fpga_stereo::link
