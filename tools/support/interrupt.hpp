// Ctrl-C, and what a service manager sends, end the work, not the program: it still says what it
// has done.
#pragma once

namespace fpga_stereo::tools {

/// From now on SIGINT and SIGTERM only make interrupted() true; a second one ends the program.
void catch_interrupts();
bool interrupted();

}  // namespace fpga_stereo::tools
