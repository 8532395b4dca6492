// Loads the models that build_model makes and runs them clock by clock.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "fpga_stereo/core/result.hpp"
#include "sim/gateware/model.hpp"

namespace fpga_stereo::sim {

/// A loaded shared object. It is unloaded with the last pointer to it.
class SharedObject {
 public:
  static Result<std::shared_ptr<SharedObject>> open(const std::string& path);
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;
  ~SharedObject();
  /// Returns the address of a symbol, or null.
  void* symbol(const char* name) const;

 private:
  explicit SharedObject(void* handle) : handle_(handle) {}
  void* handle_;
};

/// One instance of a model. `Of` is an Interface of model.hpp. Not thread-safe.
template <class Of>
class LoadedModel {
 public:
  /// Loads a model and creates an instance. `symbol` names the function that returns the interface.
  /// Registers and memories start with random values from `seed`. Refuses a file that is not such a
  /// model.
  static Result<LoadedModel> open(const std::string& path, const char* symbol, std::uint32_t seed) {
    const auto object = SharedObject::open(path);
    if (!object) return object.error();
    const auto function = reinterpret_cast<const Of* (*)()>((*object)->symbol(symbol));
    if (function == nullptr) return refusal(path, "is not a model of the gateware");
    LoadedModel loaded;
    loaded.object_ = *object;
    loaded.interface_ = function();
    if (const std::uint32_t version = loaded.interface_->version; version != kModelVersion) {
      return refusal(path, "is a model of version " + std::to_string(version) +
                               ": this program needs version " + std::to_string(kModelVersion));
    }
    loaded.model_ = {loaded.interface_->create(seed), loaded.interface_->destroy};
    if (!loaded.model_) {
      return refusal(path, std::string("the gateware refuses its build parameters: ") +
                               loaded.interface_->error());
    }
    return loaded;
  }

  LoadedModel(LoadedModel&&) = default;
  LoadedModel& operator=(LoadedModel&&) = delete;  // would unload a model that still exists

  const ModelParameters& parameters() const { return interface_->parameters; }
  /// Simulates one clock. Returns the outputs before its rising edge.
  typename Of::Outputs clock(const typename Of::Inputs& in) {
    typename Of::Outputs out;
    interface_->clock(model_.get(), &in, &out);
    return out;
  }
  /// Writes all signals from now on to a VCD file. Works only for models built with --trace.
  Status open_trace(const std::string& path) {
    if (interface_->open_trace(model_.get(), path.c_str()) != 0) return {};
    return refusal(path, parameters().trace != 0 ? "cannot be written"
                                                 : "this model was built without --trace");
  }
  void close_trace() { interface_->close_trace(model_.get()); }

 private:
  LoadedModel() = default;
  static Error refusal(const std::string& path, const std::string& what) {
    return {ErrorKind::kInvalid, path + ": " + what};
  }

  std::shared_ptr<SharedObject> object_;  // outlives model_, whose code it holds
  const Of* interface_ = nullptr;
  std::unique_ptr<void, void (*)(void*)> model_{nullptr, nullptr};
};

}  // namespace fpga_stereo::sim
