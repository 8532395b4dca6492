// The modes of board. Each takes the arguments after its name, and throws exceptions that
// run_program() reports.
#pragma once

#include "support/program.hpp"

namespace fpga_stereo::tools {

void list_boards(const Arguments& arguments);
void probe(const Arguments& arguments);
void get_registers(const Arguments& arguments);
void set_registers(const Arguments& arguments);
void upload(const Arguments& arguments);
void capture(const Arguments& arguments);
void measure(const Arguments& arguments);
void record(const Arguments& arguments);
void self_test(const Arguments& arguments);
void compare(const Arguments& arguments);
void flash(const Arguments& arguments);
void udev_rule(const Arguments& arguments);

}  // namespace fpga_stereo::tools
