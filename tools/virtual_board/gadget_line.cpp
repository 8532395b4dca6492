#include <thread>

#include "sim/usb_gadget/gadget_ft232h.hpp"
#include "virtual_board/board_backend.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {
namespace {

/// Any host that the USB device controller is connected to sees the board.
class GadgetLine : public Line {
 public:
  GadgetLine(sim::FaultyBoard& board, const sim::GadgetFt232h::Options& options)
      : board_(board), backend_(board), chip_(backend_, options) {}

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
  std::string path() const override { return chip_.controller(); }
  void halt() override { chip_.stall_in(); }
  void send_empty(int transfers) override { chip_.send_empty(transfers); }
  void limit_packets(int payload) override {
    chip_.limit_packets(static_cast<std::size_t>(payload));
  }

 private:
  sim::FaultyBoard& board_;
  BoardBackend backend_;
  sim::GadgetFt232h chip_;
};

}  // namespace

std::unique_ptr<Line> make_gadget_line(sim::FaultyBoard& board, const std::string& serial_number) {
  sim::GadgetFt232h::Options options;
  options.serial_number = serial_number;
  return std::make_unique<GadgetLine>(board, options);
}

}  // namespace fpga_stereo::tools
