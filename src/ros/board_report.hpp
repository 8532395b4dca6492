// Describes a board for ~status, for diagnostics and for the service ~device_info.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <fpga_stereo/StereoStatus.h>

#include <optional>
#include <string>

#include "fpga_stereo/link/board_plan.hpp"
#include "fpga_stereo/link/device.hpp"
#include "ros/node_state.hpp"
#include "ros/verifier.hpp"

namespace fpga_stereo {

/// Everything a report says about the board, read at one time.
struct BoardReport {
  link::Device::Snapshot device;
  link::BoardAbility ability = link::BoardAbility::kNoBoard;
  std::string limitation;    // for people: why it does not make the disparity
  bool is_expected = true;   // a missing board deserves a warning
  bool is_required = false;  // without a board there is no disparity
  bool is_recording = false;
  Verifier::Counters verified;
};

/// Says why the board sends no frames; nullopt if it does, or would if there were demand.
std::optional<StateReport> link_trouble(const link::Device::Snapshot& device);

/// Fills the fields of the status that describe the board.
void fill_status(const BoardReport& board, StereoStatus& status);

/// Fills the diagnostics of the board.
void fill_diagnostics(const BoardReport& board,
                      diagnostic_updater::DiagnosticStatusWrapper& diagnostics);

/// Returns lines of "name: value" with state, connection, gateware and streams.
std::string device_info(const link::Device::Snapshot& device);

}  // namespace fpga_stereo
