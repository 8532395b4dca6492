// A line to a virtual FT232H.
#pragma once

#include <atomic>

#include "link/lines.hpp"
#include "sim/virtual_usb/virtual_ft232h.hpp"

namespace fpga_stereo::test {

class UsbLine : public Line, private sim::FifoBackend {
 public:
  UsbLine() : UsbLine(sim::VirtualFt232h::Options{}) {}
  explicit UsbLine(const sim::VirtualFt232h::Options& options);

  Result<std::unique_ptr<link::Transport>> open() override { return link::open_transport("usb"); }
  void send(const Bytes& bytes) override {
    to_host_.push(bytes.data(), bytes.size());
    chip.poke();
  }
  Bytes take(std::size_t size) override { return from_host_.wait(size); }
  void listen(bool on) override {
    listening_ = on;
    chip.poke();
  }
  void unplug() override {
    chip.unplug();
    to_host_.clear();
  }
  void plug() override { chip.plug(); }
  /// Returns the bytes that the chip has not taken yet.
  std::size_t waiting() const { return to_host_.size(); }

 private:
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override {
    if (!listening_) return 0;
    from_host_.push(bytes, size);
    return size;
  }
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override {
    return to_host_.pop(bytes, size);
  }

  Wire to_host_, from_host_;
  std::atomic<bool> listening_{true};

 public:
  sim::VirtualFt232h chip;  // last: it calls the others
};

/// Opens the board; on failure fails the test and returns null.
std::unique_ptr<link::Transport> open_usb(const std::string& name = "usb");

/// Sends `size` bytes each way and checks that they arrive.
void expect_bytes(UsbLine& line, link::Transport& transport, std::size_t size, unsigned seed);

}  // namespace fpga_stereo::test
