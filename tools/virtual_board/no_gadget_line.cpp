#include <stdexcept>

#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {

std::unique_ptr<Line> make_gadget_line(sim::FaultyBoard&, const std::string&) {
  throw std::runtime_error(
      "--gadget: this program was built without linux/usb/functionfs.h: install linux-libc-dev, "
      "then configure and build again");
}

}  // namespace fpga_stereo::tools
