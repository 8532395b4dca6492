// Selects the instruction set that the pipeline computes with. Results do not depend on it.
#pragma once

#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

constexpr const char* kScalarTarget = "scalar";  // the reference pipeline, without SIMD
constexpr const char* kTargetVariable = "FPGA_STEREO_TARGET";

/// Returns the targets that this machine and build support, best first. Names are google/highway's
/// (AVX3_DL, AVX3, AVX2, SSE4, NEON; AVX3 is AVX-512); the last one is "scalar".
std::vector<std::string> targets();

/// Returns the target in use: the best one, unless FPGA_STEREO_TARGET or choose_target() selects
/// another. Thread-safe.
std::string target();

/// Selects a target for all threads. Must not be called while an image pair is being processed.
/// Fails with kInvalid if `name` is not one of targets().
Status choose_target(const std::string& name);

/// Returns an error if FPGA_STEREO_TARGET is set but does not name one of targets(); the best
/// target is then in use.
Status check_target_variable();

}  // namespace fpga_stereo
