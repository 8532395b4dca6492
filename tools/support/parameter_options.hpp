// The parameters of the pipeline as options of the command line, made from the parameter table.
#pragma once

#include <boost/program_options.hpp>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::tools {

/// One option per row of parameter_table(): unit, range and default in the help.
boost::program_options::options_description parameter_options();

/// `defaults` with what was given on the command line. Throws UsageError with name, value and
/// range.
Parameters parameters_from(const boost::program_options::variables_map& options,
                           Parameters defaults = {});

}  // namespace fpga_stereo::tools
