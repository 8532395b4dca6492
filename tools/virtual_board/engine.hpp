// What computes in a virtual board.
#pragma once

#include <boost/program_options.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::tools {

struct Engine {
  std::unique_ptr<sim::Board> board;
  /// What a register holds, by its address, without asking over the line; empty: cannot be told.
  std::function<std::uint32_t(std::uint32_t)> peek;
};

/// --engine, build parameters, and what a board can claim wrongly.
boost::program_options::options_description engine_options();
/// Throws UsageError.
Engine make_engine(const boost::program_options::variables_map& options);

}  // namespace fpga_stereo::tools
