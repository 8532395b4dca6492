#include <csignal>

#include "sim/virtual_usb/virtual_ft232h.hpp"
#include "support/child.hpp"
#include "support/interrupt.hpp"
#include "virtual_board/ft232h_line.hpp"

namespace fpga_stereo::tools {
namespace {

/// Starts the host program in an environment in which it sees the virtual device.
class UsbLine : public Ft232hLine<sim::VirtualFt232h> {
 public:
  UsbLine(sim::FaultyBoard& board, const std::string& serial_number,
          const std::vector<std::string>& command)
      : Ft232hLine(board, serial_number),
        child_(command, sim::VirtualFt232h::environment(), command[0] + ": no such program") {}

  std::optional<int> exit_code() override {
    if (interrupted()) {
      child_.send_signal(SIGTERM);
      return child_.wait();
    }
    return child_.exit_code();
  }

 private:
  Child child_;
};

}  // namespace

std::unique_ptr<Line> make_usb_line(sim::FaultyBoard& board, const std::string& serial_number,
                                    const std::vector<std::string>& command) {
  return std::make_unique<UsbLine>(board, serial_number, command);
}

}  // namespace fpga_stereo::tools
