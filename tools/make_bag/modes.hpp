// The modes of make_bag. Each takes the arguments after its name and throws exceptions that
// run_program() reports.
#pragma once

#include "support/program.hpp"

namespace fpga_stereo::tools {

void create_bag(const Arguments& arguments);
void calibrate(const Arguments& arguments);
void extract_bag(const Arguments& arguments);
void print_frames(const Arguments& arguments);

/// Adds the option --camera, and returns its value without leading and trailing slashes. Throws
/// UsageError for an invalid ROS name.
void add_camera_option(boost::program_options::options_description& options);
std::string camera_name(const boost::program_options::variables_map& options);

}  // namespace fpga_stereo::tools
