// Which instructions the pipeline computes with. The result does not depend on it.
#pragma once

#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

constexpr const char* kScalarTarget = "scalar";  // the reference, plain C++
constexpr const char* kTargetVariable = "FPGA_STEREO_TARGET";

/// What this machine and this build can do, best first, as google/highway names it (AVX3_DL, AVX3,
/// AVX2, SSE4, NEON; AVX3 is AVX-512); the last one is "scalar".
std::vector<std::string> targets();

/// What is computed with: the best, unless FPGA_STEREO_TARGET or choose_target() says otherwise.
std::string target();

/// From now on, in all threads; not while a frame is being computed. Fails with kInvalid where it
/// is none of targets().
Status choose_target(const std::string& name);

/// Whether FPGA_STEREO_TARGET, if it is set, names a target; if not, the best one is used.
Status check_target_variable();

}  // namespace fpga_stereo
