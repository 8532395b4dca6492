#include "fpga_stereo/core/target.hpp"

#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <utility>

#ifdef FPGA_STEREO_SIMD
#include <hwy/highway.h>
#endif

namespace fpga_stereo {
namespace {

struct Target {
  std::string name;
  std::int64_t bit;  // of highway; 0: scalar
};

std::vector<Target> available() {
  std::vector<Target> found;
#ifdef FPGA_STEREO_SIMD
  // What is emulated is no faster than the reference.
  constexpr std::int64_t kEmulated = HWY_EMU128 | HWY_SCALAR;
  static const std::vector<std::int64_t> bits = hwy::SupportedAndGeneratedTargets();
  for (const std::int64_t bit : bits) {
    if ((bit & kEmulated) == 0) found.push_back({hwy::TargetName(bit), bit});
  }
#endif
  found.push_back({kScalarTarget, 0});
  return found;
}

void use(const Target& target) {
#ifdef FPGA_STEREO_SIMD
  if (target.bit != 0) hwy::GetChosenTarget().Update(target.bit);
#else
  (void)target;
#endif
}

/// The target in use.
class Choice {
 public:
  Choice() {
    const char* variable = std::getenv(kTargetVariable);
    if (variable != nullptr && *variable != '\0') status_ = set(variable);
    if (name_.empty()) (void)set(available().front().name);
  }

  std::string name() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return name_;
  }
  const Status& status_of_variable() const { return status_; }

  Status set(const std::string& name) {
    std::string allowed;
    for (const Target& target : available()) {
      if (target.name == name) {
        const std::lock_guard<std::mutex> lock(mutex_);
        use(target);
        name_ = name;
        return {};
      }
      allowed += (allowed.empty() ? "" : ", ") + target.name;
    }
    return Error{ErrorKind::kInvalid, "'" + name + "' is no target of this machine and build (" +
                                          kTargetVariable + "): allowed " + allowed};
  }

 private:
  mutable std::mutex mutex_;
  std::string name_;
  Status status_;
};

Choice& choice() {
  static Choice made;
  return made;
}

}  // namespace

std::vector<std::string> targets() {
  std::vector<std::string> names;
  for (const Target& target : available()) names.push_back(target.name);
  return names;
}

std::string target() { return choice().name(); }

Status choose_target(const std::string& name) { return choice().set(name); }

Status check_target_variable() { return choice().status_of_variable(); }

}  // namespace fpga_stereo
