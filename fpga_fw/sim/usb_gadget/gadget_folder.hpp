// The folder of a USB gadget in configfs. It describes the gadget, and binds it to a USB device
// controller (UDC) of this machine: that plugs it in.
#pragma once

#include <string>

#include "sim/ft232h/usb_types.hpp"

namespace fpga_stereo::sim {

/// Throws std::runtime_error with the path and the cause if the kernel refuses something.
class GadgetFolder {
 public:
  struct Options {
    UsbIdentity identity;
    bool high_speed = true;
    int max_power = 100;  // mA
  };

  /// Creates the gadget `name` with one configuration, whose only function is the FunctionFS of the
  /// same name. Removes what a program that was killed left of an earlier one.
  GadgetFolder(const std::string& name, const Options& options);
  ~GadgetFolder();
  GadgetFolder(const GadgetFolder&) = delete;
  GadgetFolder& operator=(const GadgetFolder&) = delete;

  /// Binds the gadget to the first controller that is free, later always to the same one.
  void bind();
  void unbind();
  /// Returns the name of the controller; empty before the first bind().
  const std::string& controller() const { return controller_; }

 private:
  void remove() const;

  const std::string name_, path_;
  std::string controller_;
};

}  // namespace fpga_stereo::sim
