#include "fpga_stereo/core/target.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <utility>

#include "core/thread_safety.hpp"

#ifdef FPGA_STEREO_SIMD
#include <hwy/highway.h>
#endif

namespace fpga_stereo {
namespace {

struct Target {
  std::string name;
  std::int64_t bit;  // highway's number of the target; 0: scalar
};

/// Returns the targets of this machine and build, best first.
std::vector<Target> available_targets() {
  std::vector<Target> found;
#ifdef FPGA_STEREO_SIMD
  // Emulated targets are no faster than the reference.
  constexpr std::int64_t kEmulated = HWY_EMU128 | HWY_SCALAR;
  static const std::vector<std::int64_t> bits = hwy::SupportedAndGeneratedTargets();
  for (const std::int64_t bit : bits) {
    if ((bit & kEmulated) == 0) found.push_back({hwy::TargetName(bit), bit});
  }
#endif
  found.push_back({kScalarTarget, 0});
  return found;
}

void set_dispatch(const Target& target) {
#ifdef FPGA_STEREO_SIMD
  if (target.bit != 0) hwy::GetChosenTarget().Update(target.bit);
#else
  (void)target;
#endif
}

/// The target in use, for all threads.
class TargetChoice {
 public:
  TargetChoice() {
    const char* variable = std::getenv(kTargetVariable);
    if (variable != nullptr && *variable != '\0') {
      if (const Status status = set(variable); !status) {
        status_ = Error{status.error().kind,
                        fmt::format("{}: {}", kTargetVariable, status.error().message)};
      }
    }
    if (name_.empty()) (void)set(available_targets().front().name);
  }

  std::string name() const {
    const MutexLock lock(mutex_);
    return name_;
  }
  const Status& status_of_variable() const { return status_; }

  Status set(const std::string& name) {
    std::string allowed;
    for (const Target& target : available_targets()) {
      if (target.name == name) {
        const MutexLock lock(mutex_);
        set_dispatch(target);
        name_ = name;
        return {};
      }
      allowed += (allowed.empty() ? "" : ", ") + target.name;
    }
    return Error{
        ErrorKind::kInvalid,
        fmt::format("SIMD target '{}' is not available on this machine and build: allowed {}", name,
                    allowed)};
  }

 private:
  mutable Mutex mutex_;
  std::string name_ FPGA_STEREO_GUARDED_BY(mutex_);
  Status status_;  // of the environment variable; constant after construction
};

TargetChoice& choice() {
  static TargetChoice instance;
  return instance;
}

}  // namespace

std::vector<std::string> targets() {
  std::vector<std::string> names;
  for (const Target& target : available_targets()) names.push_back(target.name);
  return names;
}

std::string target() { return choice().name(); }

Status choose_target(const std::string& name) { return choice().set(name); }

Status check_target_variable() { return choice().status_of_variable(); }

}  // namespace fpga_stereo
