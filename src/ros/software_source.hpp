// Frames made by the software pipeline.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "fpga_stereo/core/pipeline.hpp"
#include "ros/frame.hpp"
#include "ros/health.hpp"
#include "ros/rectifier.hpp"
#include "ros/topic_input.hpp"

namespace fpga_stereo {

/// One thread of its own makes frames of pairs and hands them on. A pair that waits for that thread
/// is replaced by a newer one: work never queues up.
class SoftwareSource {
 public:
  static constexpr const char* kName = "software";
  using Callback = std::function<void(const StereoFrame&)>;

  /// `callback` is called from the source's own thread.
  SoftwareSource(Health& health, Callback callback);
  ~SoftwareSource();
  SoftwareSource(const SoftwareSource&) = delete;
  SoftwareSource& operator=(const SoftwareSource&) = delete;

  /// Takes a pair; from any thread.
  void receive(const InputPair& pair);
  /// Nobody wants the pair that waits any more.
  void forget();
  /// What the next frame shall contain.
  void set_demand(const Demand& demand);
  void set_settings(const Settings& settings);

 private:
  void run();
  /// The frame, or the reason why there is none.
  Result<StereoFrame> make(const InputPair& pair, const Demand& demand, const Settings& settings);
  void refuse(DropCause cause, const std::string& why);

  Health& health_;
  Callback callback_;

  // Owned by the thread.
  Pipeline pipeline_;
  Rectifier rectifier_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<InputPair> waiting_;
  Demand demand_;
  Settings settings_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace fpga_stereo
