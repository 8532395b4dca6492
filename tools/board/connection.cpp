#include "board/connection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <thread>

#include "fpga_stereo/link/transport.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using link::Transport;
using Clock = std::chrono::steady_clock;
using State = link::LinkState;
using std::chrono::milliseconds;

constexpr milliseconds kPollPeriod{5};
constexpr std::size_t kMaxArrived = 256;  // frame sets; newer ones are dropped

double system_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// True for the names of transports and the paths of serial lines, not for other files.
bool is_device_not_file(const std::string& text) {
  std::error_code failed;
  return text == "usb" || text.find(':') != std::string::npos || text.rfind("/dev/", 0) == 0 ||
         std::filesystem::is_character_file(text, failed);
}

/// True for the names of transports and for paths.
bool is_device(const std::string& text) {
  return is_device_not_file(text) || text.find('/') != std::string::npos;
}

}  // namespace

void add_patience(CommandLine& line) {
  line.is_device = line.takes_files ? is_device_not_file : is_device;
  auto& options = line.options;
  options.add_options()("device", po::value<std::string>()->value_name("DEVICE"),
                        "the device, as board --help lists them, in place of the argument DEVICE");
  options.add_options()("wait", po::value<double>()->value_name("S")->default_value(3),
                        "seconds to wait for an answer of the board [0.1 to 3600]");
  options.add_options()("verbose", po::bool_switch(), "report events of the link on stderr");
}

std::string device_of(const Parsed& parsed) {
  if (parsed.device.empty()) return "usb";
  const bool is_name = parsed.device == "usb" || parsed.device.find(':') != std::string::npos;
  const bool is_path = parsed.device[0] == '/' || !is_name;
  return is_path ? "serial:" + parsed.device : parsed.device;
}

Patience patience(const po::variables_map& options) {
  const Patience given{options["wait"].as<double>(), options["verbose"].as<bool>()};
  require_range("--wait", given.seconds, 0.1, 3600);
  return given;
}

std::unique_ptr<Transport> open_line(const std::string& device) {
  auto opened = link::open_transport(device);
  if (!opened && opened.error().kind == ErrorKind::kInvalid) {
    throw UsageError(opened.error().message);
  }
  require(opened);
  return std::move(*opened);
}

Connection::Connection(const std::string& device, const Patience& patience, const Wrap& wrap)
    : name_(device), patience_(patience) {
  if (device.rfind("replay:", 0) == 0) {
    throw UsageError(device + ": a recording answers no requests: allowed for capture and measure");
  }
  // Open the line now to report errors at once. Later the device reopens it whenever it is lost.
  auto first = std::make_shared<std::unique_ptr<Transport>>(open_line(device));
  link::Device::Options options;
  options.retry = milliseconds(100);
  options.hotplug = link::watch_for(device);
  options.open = [device, first, wrap]() -> Result<std::unique_ptr<Transport>> {
    auto opened = *first != nullptr ? Result<std::unique_ptr<Transport>>(std::move(*first))
                                    : link::open_transport(device);
    *first = nullptr;
    if (opened && wrap) return wrap(std::move(*opened));
    return opened;
  };
  link::Device::Callbacks callbacks;
  callbacks.received = [this](link::ReceivedFrames frames) {
    const double now = system_time();
    const std::lock_guard lock(mutex_);
    if (arrived_.size() < kMaxArrived) arrived_.push_back({std::move(frames), now});
    came_.notify_all();
  };
  callbacks.identified = [](const link::Identity&) {};
  callbacks.note = [verbose = patience.verbose](const std::string& note) {
    if (verbose) std::cerr << "board: " + note + "\n";
  };
  device_ = std::make_unique<link::Device>(std::move(options), std::move(callbacks));
}

void Connection::fail(const std::string& why) const { throw std::runtime_error(why); }

bool Connection::wait_until(double seconds, const std::function<bool(const Snapshot&)>& done) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    const Snapshot now = snapshot();
    if (now.state == State::kRefused) fail(now.trouble_text);
    if (done(now)) return true;
    if (interrupted()) fail("interrupted");
    if (Clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kPollPeriod);
  }
}

link::Identity Connection::identify() {
  std::optional<link::Identity> identity;
  const bool is_identified = wait_until(patience_.seconds, [&](const Snapshot& now) {
    identity = now.identity;
    return identity && now.state != State::kIdentifying && now.state != State::kClosed;
  });
  if (!is_identified) {
    fail(fmt::format(
        "{}: no board answered within {:g} s ({}): is it powered, and has it been flashed?", name_,
        patience_.seconds, snapshot().trouble_text));
  }
  return *identity;
}

std::vector<Connection::Arrived> Connection::take(milliseconds timeout) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, timeout, [this] { return !arrived_.empty(); });
  return std::exchange(arrived_, {});
}

template <class Ask>
auto Connection::retry(const Ask& ask) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(patience_.seconds);
  while (true) {
    auto answer = ask();
    if (answer) return answer;
    if (Clock::now() >= deadline) fail(answer.error().message);
    identify();
  }
}

std::vector<std::uint32_t> Connection::read(const std::vector<std::uint32_t>& addresses) {
  const auto answer = retry([&] { return device_->read_registers(addresses); });
  std::vector<std::uint32_t> values;
  for (const RegisterWrite& value : *answer) values.push_back(value.value);
  return values;
}

void Connection::write(const std::vector<RegisterWrite>& writes) {
  require(retry([&] { return device_->write_registers(writes); }));
}

}  // namespace fpga_stereo::tools
