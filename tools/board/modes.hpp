// The modes of board. Each takes the name of the device and the arguments after it, and throws
// exceptions that run_program() reports.
#pragma once

#include <string>

#include "support/program.hpp"

namespace fpga_stereo::tools {

void list_boards(const std::string& device, const Arguments& arguments);
void probe(const std::string& device, const Arguments& arguments);
void get_registers(const std::string& device, const Arguments& arguments);
void set_registers(const std::string& device, const Arguments& arguments);
void upload(const std::string& device, const Arguments& arguments);
void capture(const std::string& device, const Arguments& arguments);
void measure(const std::string& device, const Arguments& arguments);
void record(const std::string& device, const Arguments& arguments);
void self_test(const std::string& device, const Arguments& arguments);
void flash(const std::string& device, const Arguments& arguments);
void udev_rule(const std::string& device, const Arguments& arguments);

}  // namespace fpga_stereo::tools
