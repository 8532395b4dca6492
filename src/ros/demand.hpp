// What subscribers want of the next frame.
#pragma once

namespace fpga_stereo {

enum class Side { kLeft, kRight };

/// The images of one camera that have subscribers.
struct CameraDemand {
  bool mono = false, color = false;       // as the camera sees
  bool rect = false, rect_color = false;  // rectified

  bool any() const { return mono || color || rect || rect_color; }
  bool any_raw() const { return mono || color; }
  bool any_rectified() const { return rect || rect_color; }
};

/// A source makes these outputs and no others.
struct Demand {
  CameraDemand left, right;
  bool disparity = false;

  bool any() const { return left.any() || right.any() || disparity; }
  /// True if an output is made of pairs. Others are images of one camera, passed on.
  bool needs_pairs() const { return left.any_rectified() || right.any_rectified() || disparity; }
  const CameraDemand& of(Side side) const { return side == Side::kLeft ? left : right; }
};

}  // namespace fpga_stereo
