// Which configuration tag belongs to which configuration id.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>

namespace fpga_stereo::link {

/// The board counts its configurations, modulo 2^32; the host gives each of its own a tag. An apply
/// that was sent several times may take effect as often, so a tag holds for that many ids, up to
/// the next tag's first.
class ConfigurationTags {
 public:
  explicit ConfigurationTags(int max_applies)
      : max_applies_(static_cast<std::uint32_t>(max_applies)) {}

  void bind(std::uint32_t first_configuration, std::uint64_t tag) {
    any_.reset();
    bound_.push_front({first_configuration, tag});
    if (bound_.size() > kMaxBound) bound_.pop_back();
  }
  /// Binds a tag to every configuration, whoever made it.
  void bind_any(std::uint64_t tag) {
    clear();
    any_ = tag;
  }
  void clear() {
    bound_.clear();
    any_.reset();
  }
  bool empty() const { return bound_.empty() && !any_; }

  /// Returns the tag of the configuration; nullopt if the host did not make it.
  std::optional<std::uint64_t> find(std::uint32_t configuration) const {
    const auto found = std::find_if(bound_.begin(), bound_.end(), [&](const Bound& each) {
      return configuration - each.first < max_applies_;
    });
    return found == bound_.end() ? any_ : found->tag;
  }
  /// Returns true if the last tag is bound to a later configuration.
  bool has_later(std::uint32_t configuration) const {
    return !bound_.empty() && static_cast<std::int32_t>(bound_.front().first - configuration) > 0;
  }

 private:
  static constexpr std::size_t kMaxBound = 16;  // no older frame is still on its way
  struct Bound {
    std::uint32_t first;
    std::uint64_t tag;
  };
  std::uint32_t max_applies_;
  std::deque<Bound> bound_;  // the last one first
  std::optional<std::uint64_t> any_;
};

}  // namespace fpga_stereo::link
