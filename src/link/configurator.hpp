// Brings a board into its desired state: what is asked and written, in which order. Everything that
// is written is read back.
//
//   identify -> streams off -> registers, meshes, apply, wait until it took effect -> streams on
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "link/configuration_tags.hpp"
#include "link/request_queue.hpp"

namespace fpga_stereo::link {

/// The error text of a board that has lost its state.
constexpr const char* kBoardWasReset = "the board was reset";

class Configurator {
 public:
  using Values = RequestQueue::Values;

  /// `max_applies`: how often an apply may be sent, each of which may take effect.
  Configurator(RequestQueue& requests, int max_applies)
      : requests_(requests), max_applies_(max_applies), tags_(max_applies) {}
  Configurator(const Configurator&) = delete;
  Configurator& operator=(const Configurator&) = delete;

  /// Returns true if the configuration or its tag differs from the one before.
  bool set_desired_state(const DesiredState& desired);
  const DesiredState& desired() const { return desired_; }

  /// Forgets everything about the board and asks it what it is.
  void restart();
  /// Asks the board what it is.
  void identify();

  enum class Progress {
    kWorking,  // more requests were queued
    kBlocked,  // no configuration for this build has been given
    kDone,     // the board is in the desired state
    kStreams,  // as kWorking: the streams are being switched
  };
  /// Queues the next requests. Call on an identified board while no request is pending.
  Progress advance();

  /// Queues a read of the board's counters, its configuration id and its streams.
  void poll();
  /// Returns the values of the last poll, once.
  std::optional<Values> take_polled() { return std::exchange(polled_, std::nullopt); }

  /// Returns true once the board is known to be compatible.
  bool is_identified() const { return is_identified_; }
  /// The board that answered, compatible or not.
  const std::optional<Identity>& identity() const { return identity_; }
  void forget_identity() { identity_.reset(); }
  /// Returns true while the board does not hold the desired configuration or streams.
  bool is_stale() const { return is_configuration_stale_ || are_streams_stale_; }
  /// Returns true if the polled registers CONFIGURATION and STREAMS hold what was written.
  bool matches(const Values& polled) const;

  /// The tags of the configurations that the board may use from now on.
  ConfigurationTags& tags() { return tags_; }
  const ConfigurationTags& tags() const { return tags_; }
  /// The tag of the board's configuration; nullopt while another one is being applied.
  std::optional<std::uint64_t> active_tag() const;
  /// Configurations that took effect.
  std::uint64_t applied_count() const { return applied_count_; }

 private:
  using Meshes = std::array<std::vector<std::uint32_t>, 2>;  // left, right

  Status on_identity(const Values& values);
  void write_configuration();
  void write_and_read_back(const Values& writes);
  void write_mesh(std::uint32_t camera, const std::vector<std::uint32_t>& mesh);
  void await_apply(std::shared_ptr<const GatewareConfiguration> configuration, Time now,
                   Time deadline);
  Status check_apply(const std::shared_ptr<const GatewareConfiguration>& configuration,
                     const Values& values, Time now, Time deadline);
  void write_streams();

  RequestQueue& requests_;
  const int max_applies_;
  DesiredState desired_;
  std::optional<Identity> identity_;
  bool is_identified_ = false;
  bool is_configuration_stale_ = false;
  bool are_streams_stale_ = false;
  /// Whose meshes the board holds; null if unknown.
  std::shared_ptr<const GatewareConfiguration> mesh_source_;
  ConfigurationTags tags_;
  std::uint32_t configuration_ = 0;  // the board's configuration id, as last read
  std::uint64_t applied_count_ = 0;
  std::optional<Values> polled_;
};

}  // namespace fpga_stereo::link
