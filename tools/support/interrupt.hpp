// On Ctrl-C or SIGTERM, a program ends its work and still prints its results.
#pragma once

namespace fpga_stereo::tools {

/// From now on, the first SIGINT or SIGTERM makes interrupted() true; the second ends the program.
void catch_interrupts();
bool interrupted();

}  // namespace fpga_stereo::tools
