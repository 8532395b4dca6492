#include <stdexcept>

#include "virtual_board/read_bag.hpp"

namespace fpga_stereo::tools {

std::vector<sim::GreyPair> read_bag(const std::string&, const std::string&, std::size_t) {
  throw std::runtime_error(
      "--bag: this program was built without ROS, which reads bags: use --folder with the output "
      "of make_bag extract");
}

}  // namespace fpga_stereo::tools
