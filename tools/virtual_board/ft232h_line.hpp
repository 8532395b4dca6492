// A virtual board on the FPGA's side of a virtual FT232H.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <thread>

#include "sim/ft232h/fifo_backend.hpp"
#include "sim/virtual_board/faulty_board.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {

/// `Chip` is an FT232H on a USB connection: sim::VirtualFt232h or sim::GadgetFt232h.
template <class Chip>
class Ft232hLine : public Line, private sim::FifoBackend {
 public:
  Ft232hLine(sim::FaultyBoard& board, const std::string& serial_number)
      : board_(board), chip_(*this, options(serial_number)) {}

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
  void halt() override { chip_.stall_in(); }
  void send_empty(int transfers) override { chip_.send_empty(transfers); }
  void limit_packets(int payload) override {
    chip_.limit_packets(static_cast<std::size_t>(payload));
  }

 protected:
  const Chip& chip() const { return chip_; }

 private:
  static typename Chip::Options options(const std::string& serial_number) {
    typename Chip::Options options;
    options.serial_number = serial_number;
    return options;
  }
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override {
    return board_.receive(bytes, size);
  }
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override {
    return board_.transmit(bytes, size);
  }

  sim::FaultyBoard& board_;
  Chip chip_;
};

}  // namespace fpga_stereo::tools
