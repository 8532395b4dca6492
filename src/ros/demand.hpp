// What subscribers want of the next frame.
#pragma once

namespace fpga_stereo {

/// The images of one camera that have subscribers.
struct CameraDemand {
  bool mono = false, color = false;       // as the camera sees
  bool rect = false, rect_color = false;  // rectified

  bool any() const { return mono || color || rect || rect_color; }
  bool any_raw() const { return mono || color; }
  bool any_rectified() const { return rect || rect_color; }
  bool any_color() const { return color || rect_color; }
};

/// A source makes these outputs and no others.
struct Demand {
  CameraDemand left, right;
  bool disparity = false;

  bool any() const { return left.any() || right.any() || disparity; }
};

}  // namespace fpga_stereo
