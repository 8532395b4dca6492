// Follows what a recorded host wrote and its board answered, to know what made the frames.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "fpga_stereo/link/recording_player.hpp"
#include "link/decoder.hpp"

namespace fpga_stereo::link {

class RecordedBoard {
 public:
  /// Takes a packet that the host sent.
  void add_from_host(const Packet& packet);
  /// Takes an answer of the board. The board's values replace those that the host wrote.
  void add_from_board(const Packet& packet);
  /// Packets of the host are missing: nothing is known any more about the configuration.
  void forget();

  const std::optional<Identity>& identity() const { return identity_; }
  /// The streams that the host switched on last; nullopt if that is not in the recording.
  std::optional<StreamSet> streams() const { return streams_; }
  /// Returns the configuration with this id, or null if it is not known.
  std::shared_ptr<const RecordedConfiguration> configuration(std::uint32_t id) const;

 private:
  using Meshes = std::array<std::vector<std::uint32_t>, 2>;  // left, right

  void write(std::uint32_t address, std::uint32_t value);
  void write_mesh(const std::vector<std::uint32_t>& words);
  bool has_written_mesh() const;
  /// Binds what was written to the ids from the next one on.
  void apply();
  /// Takes the register CONFIGURATION, which tells that the last apply took effect.
  void take_configuration_id(std::uint32_t id);

  std::optional<Identity> identity_;
  std::optional<StreamSet> streams_;
  std::map<std::uint32_t, std::uint32_t> registers_;  // the shadow: values by address
  Meshes written_;                                    // since the last apply
  Meshes active_;                                     // empty: not known
  std::uint32_t mesh_signature_ = 0;                  // of the words written last
  bool is_applying_ = false;
  std::optional<std::uint32_t> id_;     // register CONFIGURATION
  std::deque<std::uint16_t> requests_;  // ids of the last requests
  /// By the first id for which they hold.
  std::map<std::uint32_t, std::shared_ptr<const RecordedConfiguration>> configurations_;
};

}  // namespace fpga_stereo::link
