// Creates the virtual board that --engine selects.
#pragma once

#include <boost/program_options.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::tools {

struct Engine {
  std::unique_ptr<sim::Board> board;
  /// Returns the value of a register without a request over the link. Empty if the engine cannot.
  std::function<std::uint32_t(std::uint32_t)> peek;
};

/// Returns the options for engine, build parameters and wrong registers.
boost::program_options::options_description engine_options();
/// Creates the board. Throws UsageError.
Engine make_engine(const boost::program_options::variables_map& options);

}  // namespace fpga_stereo::tools
