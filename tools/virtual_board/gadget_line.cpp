#include "sim/usb_gadget/gadget_ft232h.hpp"
#include "virtual_board/ft232h_line.hpp"

namespace fpga_stereo::tools {
namespace {

/// Any host that the USB device controller is connected to sees the board.
class GadgetLine : public Ft232hLine<sim::GadgetFt232h> {
 public:
  using Ft232hLine::Ft232hLine;

  std::string path() const override { return chip().controller(); }
};

}  // namespace

std::unique_ptr<Line> make_gadget_line(sim::FaultyBoard& board, const std::string& serial_number) {
  return std::make_unique<GadgetLine>(board, serial_number);
}

}  // namespace fpga_stereo::tools
