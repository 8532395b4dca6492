// The two threads of a device.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/thread_safety.hpp"
#include "fpga_stereo/link/device.hpp"
#include "link/delivery_queue.hpp"
#include "link/request.hpp"
#include "link/session.hpp"

namespace fpga_stereo::link {

/// The link thread opens the transport, moves bytes between it and the session, and performs the
/// watchdog's steps. The delivery thread calls the callbacks. No lock is held while a transport
/// blocks or a callback runs.
class DeviceThreads {
 public:
  DeviceThreads(Device::Options options, Device::Callbacks callbacks);
  DeviceThreads(const DeviceThreads&) = delete;
  DeviceThreads& operator=(const DeviceThreads&) = delete;

  /// Starts both threads.
  void start();
  /// See ~Device().
  void stop() FPGA_STEREO_EXCLUDES(mutex_);

  // See Device.
  void set_desired_state(const DesiredState& desired) FPGA_STEREO_EXCLUDES(mutex_);
  bool send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                 std::uint64_t timestamp) FPGA_STEREO_EXCLUDES(mutex_);
  Result<std::vector<RegisterWrite>> ask(const Request& request) FPGA_STEREO_EXCLUDES(mutex_);
  void reset() FPGA_STEREO_EXCLUDES(mutex_);
  Device::Snapshot snapshot() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  // Called from the link thread only.
  void run_link() FPGA_STEREO_EXCLUDES(mutex_);
  /// Opens the transport; if that fails, waits for a while and returns false.
  bool open() FPGA_STEREO_EXCLUDES(mutex_);
  void wait_to_retry() FPGA_STEREO_EXCLUDES(mutex_);
  void close(LinkTrouble trouble, const std::string& why) FPGA_STEREO_EXCLUDES(mutex_);
  /// Moves bytes both ways, once. An error closes the transport.
  /// Returns the steady clock's time and the time of day, s, at one moment.
  std::pair<Time, double> read_clocks() const;
  Status exchange() FPGA_STEREO_EXCLUDES(mutex_);
  Status write_some() FPGA_STEREO_EXCLUDES(mutex_);
  void perform(WatchdogStep step) FPGA_STEREO_EXCLUDES(mutex_);
  /// Moves what the session has ready to the delivery queue. Returns the step to perform, if any.
  std::optional<WatchdogStep> hand_over() FPGA_STEREO_EXCLUDES(mutex_);

  // Called from the delivery thread only.
  void run_delivery();
  void deliver(DeliveryEvent event);

  Device::Options options_;
  Device::Callbacks callbacks_;
  DeliveryQueue queue_;

  // Used by the link thread only.
  std::unique_ptr<Transport> transport_;
  std::vector<std::uint8_t> in_, out_;
  std::size_t written_ = 0;              // bytes of out_
  Transport::Counters closed_counters_;  // sums over the transports that are closed
  bool was_identified_ = false;
  std::string open_error_;  // of the last attempt, to report each error once

  mutable Mutex mutex_;
  ConditionVariable changed_;
  Session session_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::string description_ FPGA_STEREO_GUARDED_BY(mutex_);
  LinkTrouble closed_trouble_ FPGA_STEREO_GUARDED_BY(mutex_) = LinkTrouble::kNotOpened;
  std::string closed_text_ FPGA_STEREO_GUARDED_BY(mutex_) = "the device has not been opened yet";
  Transport::Counters transport_counters_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::uint64_t times_opened_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  bool is_stopping_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  bool is_reset_requested_ FPGA_STEREO_GUARDED_BY(mutex_) = false;

  std::thread link_thread_, delivery_thread_;
};

}  // namespace fpga_stereo::link
