#include "ros/usb_board.hpp"

#include <chrono>

namespace fpga_stereo::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kFramePeriod{50};

sim::VirtualFt232h::Options chip_options(const std::string& serial_number,
                                         const std::string& port) {
  sim::VirtualFt232h::Options options;
  options.serial_number = serial_number;
  options.port = port;
  return options;
}

}  // namespace

UsbBoard::UsbBoard(const std::string& serial_number, const std::string& port,
                   const sim::GreyPair& pair)
    : pair_(pair), chip_(*this, chip_options(serial_number, port)), thread_([this] { run(); }) {}

UsbBoard::~UsbBoard() {
  stop_ = true;
  thread_.join();
  chip_.unplug();
  chip_.wait_until_closed(std::chrono::seconds(10));
}

void UsbBoard::replug(milliseconds unplugged) {
  chip_.unplug();
  std::this_thread::sleep_for(unplugged);
  chip_.plug();
}

std::size_t UsbBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return board_.receive(bytes, size);
}

std::size_t UsbBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return board_.transmit(bytes, size);
}

void UsbBoard::run() {
  auto last = Clock::now();
  auto next_frame = last;
  while (!stop_) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto now = Clock::now();
      board_.run(std::chrono::duration_cast<std::chrono::microseconds>(now - last));
      last = now;
      if (now >= next_frame) {
        next_frame = now + kFramePeriod;
        board_.feed(pair_);
      }
    }
    chip_.poke();
    std::this_thread::sleep_for(milliseconds(1));
  }
}

}  // namespace fpga_stereo::test
