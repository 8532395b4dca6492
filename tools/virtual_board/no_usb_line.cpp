#include <stdexcept>

#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {

std::unique_ptr<Line> make_usb_line(sim::FaultyBoard&, const std::string&,
                                    const std::vector<std::string>&) {
  throw std::runtime_error(
      "--usb: this program was built without umockdev: install libumockdev-dev (0.16 or newer), "
      "then "
      "configure and build again");
}

}  // namespace fpga_stereo::tools
