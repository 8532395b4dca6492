#include "support/registers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

/// Returns the edit distance of two texts (V. I. Levenshtein, 1966).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// Returns a text that suggests names similar to `given`: few letters differ, or one contains the
/// other.
template <class Items>
std::string suggestion(const std::string& given, const Items& items) {
  std::vector<std::string> near, all;
  const std::string wanted = upper(given);
  for (const auto& item : items) {
    const std::string name = upper(item.name);
    all.emplace_back(item.name);
    const bool contains = wanted.size() > 2 && (name.find(wanted) != std::string::npos ||
                                                wanted.find(name) != std::string::npos);
    if (contains || distance(wanted, name) <= 3) near.emplace_back(item.name);
  }
  const bool few = near.empty() && all.size() <= 8;
  std::string text;
  for (const std::string& name : few ? all : near) text += (text.empty() ? "" : ", ") + name;
  if (text.empty()) return "see board get --all";
  return (few ? "allowed are " : "did you mean ") + text + (few ? "" : "?");
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
