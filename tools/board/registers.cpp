// board get and board set.
#include "support/registers.hpp"

#include <fmt/format.h>

#include <iostream>

#include "board/connection.hpp"
#include "board/modes.hpp"

namespace fpga_stereo::tools {
namespace {

using spec::Access;
using spec::Register;

std::string name_of(Access access) {
  switch (access) {
    case Access::kReadOnly:
      return "read only";
    case Access::kReadWrite:
      return "read and write";
    case Access::kWriteOnly:
      return "write only";
    case Access::kWriteOneToClear:
      return "write 1 to clear";
  }
  return "";
}

void print(const Register& reg, std::uint32_t value) {
  std::cout << reg.name << " = " << hex(value);
  if (reg.fields.empty()) std::cout << " (" << value << ")";
  std::cout << "  " << reg.about << "\n";
  for (const spec::FieldInfo& field : reg.fields) {
    std::cout << "  " << reg.name << "." << field.name << " = " << field.field.get(value) << "  "
              << field.about;
    if (field.parameter[0] != '\0') std::cout << " (" << field.parameter << ")";
    std::cout << "\n";
  }
}

/// The change that one argument of set asks for.
struct Change {
  const Register* reg = nullptr;
  std::uint32_t mask = 0;  // the bits that change
  std::uint32_t bits = 0;
};

Change parse_change(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw UsageError("\"" + text + "\": allowed REGISTER=VALUE and REGISTER.FIELD=VALUE");
  }
  const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
  const std::size_t dot = name.find('.');
  Change change;
  change.reg = &find_register(name.substr(0, dot));
  if (change.reg->access == Access::kReadOnly) {
    throw UsageError(
        fmt::format("register {} is read only: {}", change.reg->name, change.reg->about));
  }
  if (dot != std::string::npos) {
    const spec::Field field = find_field(*change.reg, name.substr(dot + 1)).field;
    change.mask = field.mask();
    change.bits = field.put(parse_value(name, value, change.mask >> field.lsb));
    return change;
  }
  std::uint32_t fields = change.reg->fields.empty() ? ~std::uint32_t{0} : 0;
  for (const spec::FieldInfo& f : change.reg->fields) fields |= f.field.mask();
  change.bits = parse_value(name, value, ~std::uint32_t{0});
  change.mask = ~std::uint32_t{0};
  if ((change.bits & ~fields) != 0) {
    throw UsageError(
        fmt::format("{} = {}: sets bits outside the fields of {}: allowed are the bits of {}", name,
                    hex(change.bits), change.reg->name, hex(fields)));
  }
  return change;
}

void apply(Connection& board, const Change& change) {
  const Register& reg = *change.reg;
  const bool readable = reg.access != Access::kWriteOnly;
  // Do not write bits back that were only read, if writing 1 clears them.
  const bool keeps = readable && reg.access != Access::kWriteOneToClear;
  const std::uint32_t rest = keeps ? board.read({reg.address})[0] & ~change.mask : 0;
  const std::uint32_t value = rest | change.bits;
  board.write({{reg.address, value}});
  if (!readable) {
    std::cout << reg.name << ": " << hex(value) << " was written; it cannot be read back\n";
    return;
  }
  const std::uint32_t held = board.read({reg.address})[0];
  const bool good = keeps ? held == value : (held & value) == 0;
  if (!good) {
    throw std::runtime_error(
        fmt::format("register {} holds {} after {} was written", reg.name, hex(held), hex(value)));
  }
  std::cout << "written and read back: ";
  print(reg, held);
}

}  // namespace

void get_registers(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board get [DEVICE] REGISTER... [options]\n"
      "       board get [DEVICE] --all\n"
      "Prints the values and fields of registers (fpga_fw/spec/registers.md). Connecting turns "
      "all\n"
      "streams off: STREAMS reads 0.\n";
  line.rest = "REGISTER";
  line.options.add_options()("all", boost::program_options::bool_switch(),
                             "every register that can be read");
  add_patience(line);
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  std::vector<const Register*> wanted;
  for (const std::string& name : parsed->positional) {
    wanted.push_back(&find_register(name));
    if (wanted.back()->access != Access::kWriteOnly) continue;
    throw UsageError(fmt::format("register {} is write only", name));
  }
  if (parsed->options["all"].as<bool>()) {
    for (const Register& reg : spec::register_table()) {
      if (reg.access != Access::kWriteOnly) wanted.push_back(&reg);
    }
  }
  if (wanted.empty()) throw UsageError("REGISTER is missing: allowed are register names, or --all");
  Connection board(device_of(*parsed), patience(parsed->options));
  board.identify();
  std::vector<std::uint32_t> addresses;
  addresses.reserve(wanted.size());
  for (const Register* reg : wanted) addresses.push_back(reg->address);
  const auto values = board.read(addresses);
  for (std::size_t i = 0; i < wanted.size(); ++i) print(*wanted[i], values[i]);
}

void set_registers(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board set [DEVICE] REGISTER=VALUE... [options]\n"
      "       board set [DEVICE] REGISTER.FIELD=VALUE... [options]\n"
      "Writes registers in this order and reads them back. VALUE is decimal or 0x... Setting a "
      "field\n"
      "leaves the other fields unchanged. The configuration registers (WIDTH to SPECKLE_RANGE) "
      "take\n"
      "effect with CONTROL.apply=1, at the next frame.\n";
  line.rest = "REGISTER=VALUE";
  add_patience(line);
  line.notes = "Registers that can be written:\n";
  for (const Register& reg : spec::register_table()) {
    if (reg.access == Access::kReadOnly) continue;
    line.notes += fmt::format("  {}: {} ({})\n", reg.name, reg.about, name_of(reg.access));
  }
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  std::vector<Change> changes;
  for (const std::string& text : parsed->positional) changes.push_back(parse_change(text));
  if (changes.empty()) throw UsageError("REGISTER=VALUE is missing");
  Connection board(device_of(*parsed), patience(parsed->options));
  board.identify();
  for (const Change& change : changes) apply(board, change);
}

}  // namespace fpga_stereo::tools
