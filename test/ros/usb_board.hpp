// A virtual board on virtual USB, for tests of nodes in other processes.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "sim/virtual_board/software_board.hpp"
#include "sim/virtual_usb/virtual_ft232h.hpp"

namespace fpga_stereo::test {

class UsbBoard : private sim::FifoBackend {
 public:
  /// Plugs a board in at this port, for example "1-1". Its cameras see `pair` 20 times a second.
  UsbBoard(const std::string& serial_number, const std::string& port, const sim::GreyPair& pair);
  ~UsbBoard() override;
  UsbBoard(const UsbBoard&) = delete;
  UsbBoard& operator=(const UsbBoard&) = delete;

  /// Unplugs the cable for a while. The board keeps its power.
  void replug(std::chrono::milliseconds unplugged);

 private:
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void run();

  const sim::GreyPair pair_;
  std::mutex mutex_;
  sim::SoftwareBoard board_;
  sim::VirtualFt232h chip_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fpga_stereo::test
