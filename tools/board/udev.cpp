// board udev.
#include <fmt/format.h>
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
  if (child.wait() != 0) throw std::runtime_error("udevadm " + arguments[0] + " failed");
}

}  // namespace

void udev_rule(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board udev [--install]\n"
      "Prints the udev rule that gives users access to boards on USB, or installs it (as root).\n"
      "If root has no ROS environment, run board udev | sudo tee " +
      std::string(kFolder) + "/" + kFile + ",\nthen sudo udevadm control --reload.\n";
  line.options.add_options()("install", boost::program_options::bool_switch(),
                             "install the rule and reload udev");
  line.options.add_options()(
      "folder",
      boost::program_options::value<std::string>()->value_name("DIR")->default_value(kFolder),
      "folder to install to; udev is reloaded only for the default");
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
    throw std::runtime_error(fmt::format(
        "{}: cannot be written: {}{}", path, std::strerror(errno),
        denied && geteuid() != 0 ? "; run 'board udev | sudo tee " + path + "' instead" : ""));
  }
  if (folder == kFolder) {
    run_udevadm({"control", "--reload"});
    run_udevadm({"trigger", "--subsystem-match=usb"});
  }
  std::cout << path << " is installed; if the board cannot be opened yet, plug it in again\n";
}

}  // namespace fpga_stereo::tools
