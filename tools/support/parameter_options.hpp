// Command-line options for the parameters of the pipeline, generated from the parameter table.
#pragma once

#include <boost/program_options.hpp>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::tools {

/// Returns one option per row of parameter_table(), with unit, range and default in the help.
boost::program_options::options_description parameter_options(const Parameters& defaults = {});

/// Returns `defaults` with the values given on the command line. Throws UsageError with name, value
/// and range.
Parameters parameters_from(const boost::program_options::variables_map& options,
                           Parameters defaults = {});

}  // namespace fpga_stereo::tools
