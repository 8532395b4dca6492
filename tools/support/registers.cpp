#include "support/registers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/similar_names.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

/// Returns a text that suggests names similar to `given`.
template <class Items>
std::string suggestion(const std::string& given, const Items& items) {
  std::vector<std::string> all;
  for (const auto& item : items) all.emplace_back(item.name);
  const std::vector<std::string> near = similar_names(given, all);
  if (!near.empty()) return fmt::format("did you mean {}?", fmt::join(near, ", "));
  if (all.size() <= 8) return fmt::format("allowed are {}", fmt::join(all, ", "));
  return "see board get --all";
}

}  // namespace

const spec::Register& find_register(const std::string& name) {
  const auto& table = spec::register_table();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const spec::Register& r) { return r.name == name; });
  if (found != table.end()) return *found;
  throw UsageError(fmt::format("no register is called \"{}\": {}", name, suggestion(name, table)));
}

const spec::FieldInfo& find_field(const spec::Register& reg, const std::string& name) {
  const auto found = std::find_if(reg.fields.begin(), reg.fields.end(),
                                  [&](const spec::FieldInfo& f) { return f.name == name; });
  if (found != reg.fields.end()) return *found;
  if (reg.fields.empty()) {
    throw UsageError(
        fmt::format("register {} has no fields, so \"{}\" is not allowed", reg.name, name));
  }
  throw UsageError(fmt::format("register {} has no field \"{}\": {}", reg.name, name,
                               suggestion(name, reg.fields)));
}

std::uint32_t parse_value(const std::string& name, const std::string& text, std::uint32_t max) {
  const bool is_hex = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
  const std::string digits = is_hex ? text.substr(2) : text;
  const char* allowed = is_hex ? "0123456789abcdefABCDEF" : "0123456789";
  const bool number = !digits.empty() && digits.size() <= 10 &&
                      digits.find_first_not_of(allowed) == std::string::npos;
  const std::uint64_t value = number ? std::stoull(digits, nullptr, is_hex ? 16 : 10) : 0;
  if (number && value <= max) return static_cast<std::uint32_t>(value);
  throw UsageError(fmt::format("{} = \"{}\": allowed 0 to {} ({}), decimal or 0x...", name, text,
                               max, hex(max)));
}

}  // namespace fpga_stereo::tools
