// The modes of make_bag. Each takes the arguments after its name and throws as run_program wants.
#pragma once

#include "support/program.hpp"

namespace fpga_stereo::tools {

void create_bag(const Arguments& arguments);
void calibrate(const Arguments& arguments);
void extract_bag(const Arguments& arguments);

/// --camera: the name in front of the topics, and it checked, without slashes around it.
void add_camera_option(boost::program_options::options_description& options);
std::string camera_name(const boost::program_options::variables_map& options);

}  // namespace fpga_stereo::tools
