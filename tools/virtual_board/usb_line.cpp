#include <csignal>
#include <thread>

#include "sim/virtual_usb/virtual_ft232h.hpp"
#include "support/child.hpp"
#include "support/interrupt.hpp"
#include "virtual_board/board_backend.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {
namespace {

/// Starts the host program in an environment in which it sees the virtual device.
class UsbLine : public Line {
 public:
  UsbLine(sim::FaultyBoard& board, const sim::VirtualFt232h::Options& options,
          const std::vector<std::string>& command)
      : board_(board),
        backend_(board),
        chip_(backend_, options),
        child_(command, sim::VirtualFt232h::environment(), command[0] + ": no such program") {}

  void serve(std::chrono::milliseconds timeout) override {
    // The board does not report when it has bytes or room.
    chip_.poke();
    std::this_thread::sleep_for(timeout);
  }
  void plug(bool is_plugged) override {
    if (is_plugged == chip_.is_plugged()) return;
    if (is_plugged) return chip_.plug();
    chip_.unplug();
    board_.cut();
  }
  std::optional<int> exit_code() override {
    if (interrupted()) {
      child_.send_signal(SIGTERM);
      return child_.wait();
    }
    return child_.exit_code();
  }
  void halt() override { chip_.stall_in(); }
  void send_empty(int transfers) override { chip_.send_empty(transfers); }
  void limit_packets(int payload) override {
    chip_.limit_packets(static_cast<std::size_t>(payload));
  }

 private:
  sim::FaultyBoard& board_;
  BoardBackend backend_;
  sim::VirtualFt232h chip_;
  Child child_;
};

}  // namespace

std::unique_ptr<Line> make_usb_line(sim::FaultyBoard& board, const std::string& serial_number,
                                    const std::vector<std::string>& command) {
  sim::VirtualFt232h::Options options;
  options.serial_number = serial_number;
  return std::make_unique<UsbLine>(board, options, command);
}

}  // namespace fpga_stereo::tools
