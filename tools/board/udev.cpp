// board udev.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "board/modes.hpp"
#include "board/udev_rule.hpp"
#include "support/child.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr const char* kFolder = "/etc/udev/rules.d";
constexpr const char* kFile = "70-fpga-stereo.rules";

void run_udevadm(const Arguments& arguments) {
  Arguments command{"udevadm"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  Child child(command, {}, "udevadm is missing: install the package udev");
  if (child.wait() != 0) throw std::runtime_error("udevadm " + arguments[0] + " has failed");
}

}  // namespace

void udev_rule(const std::string&, const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board udev [--install]\n"
      "Prints the udev rule that lets users open the board on USB, or installs it, as root.\n"
      "Where ROS is not in root's environment: board udev | sudo tee " +
      std::string(kFolder) + "/" + kFile + ",\nthen sudo udevadm control --reload.\n";
  line.options.add_options()("install", boost::program_options::bool_switch(),
                             "write it, and have udev read it");
  line.options.add_options()(
      "folder",
      boost::program_options::value<std::string>()->value_name("DIR")->default_value(kFolder),
      "where to; udev is told only if it is its own");
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  if (!parsed->options["install"].as<bool>()) {
    std::cout << kUdevRule;
    return;
  }
  const std::string folder = parsed->options["folder"].as<std::string>();
  const std::string path = folder + "/" + kFile;
  std::ofstream file(path);
  file << kUdevRule;
  file.close();
  if (!file) {
    const bool denied = errno == EACCES || errno == EPERM;
    throw std::runtime_error(
        concat(path, ": cannot be written: ", std::strerror(errno),
               denied && geteuid() != 0 ? "; 'board udev | sudo tee " + path + "' can" : ""));
  }
  if (folder == kFolder) {
    run_udevadm({"control", "--reload"});
    run_udevadm({"trigger", "--subsystem-match=usb"});
  }
  std::cout << path << " is installed; plug the board in again if it cannot be opened yet\n";
}

}  // namespace fpga_stereo::tools
