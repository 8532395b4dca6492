#include "sim/gateware/library.hpp"

#include <dlfcn.h>

namespace fpga_stereo::sim {

Result<std::shared_ptr<SharedObject>> SharedObject::open(const std::string& path) {
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const text = dlerror();
    return Error{ErrorKind::kInvalid, text != nullptr ? text : path + ": cannot be loaded"};
  }
  return std::shared_ptr<SharedObject>(new SharedObject(handle));
}

SharedObject::~SharedObject() { dlclose(handle_); }

void* SharedObject::symbol(const char* name) const { return dlsym(handle_, name); }

}  // namespace fpga_stereo::sim
