// Which configuration tag belongs to which configuration id.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>

namespace fpga_stereo::link {

/// The board counts its configurations; the host gives each of its own a tag. An apply that was
/// sent twice may take effect twice, so a tag holds from its first configuration id up to the next
/// tag's.
class ConfigurationTags {
 public:
  void bind(std::uint32_t first_configuration, std::uint64_t tag) {
    tags_[first_configuration] = tag;
  }
  void clear() { tags_.clear(); }
  bool empty() const { return tags_.empty(); }

  /// Returns the tag of the configuration; nullopt if the host did not make it.
  std::optional<std::uint64_t> find(std::uint32_t configuration) const {
    const auto after = tags_.upper_bound(configuration);
    if (after == tags_.begin()) return std::nullopt;
    return std::prev(after)->second;
  }
  /// Returns true if a tag is bound to a later configuration.
  bool has_later(std::uint32_t configuration) const {
    return tags_.upper_bound(configuration) != tags_.end();
  }

 private:
  std::map<std::uint32_t, std::uint64_t> tags_;  // by first configuration id
};

}  // namespace fpga_stereo::link
