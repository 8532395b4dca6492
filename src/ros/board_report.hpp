// How a board does, for people: in ~status, in diagnostics, for ~device_info.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <fpga_stereo/StereoStatus.h>

#include <string>

#include "fpga_stereo/link/device.hpp"
#include "ros/verifier.hpp"

namespace fpga_stereo {

/// The fields of the status that are about the board.
void fill(const link::Device::Snapshot& board, const Verifier::Counters& verified,
          StereoStatus& status);

/// `unable`: why the board does not make the disparity, though it is there. `expected`: that there
/// is none is something to warn of.
void report_board(const link::Device::Snapshot& board, const Verifier::Counters& verified,
                  const std::string& unable, bool expected,
                  diagnostic_updater::DiagnosticStatusWrapper& report);

/// Lines of "name: value".
std::string device_info(const link::Device::Snapshot& board);

}  // namespace fpga_stereo
