#include "fpga_stereo/link/device.hpp"

#include <algorithm>
#include <utility>

#include "link/device_threads.hpp"
#include "link/request.hpp"

namespace fpga_stereo::link {

struct Device::Impl : DeviceThreads {
  using DeviceThreads::DeviceThreads;
};

Device::Device(Options options, Callbacks callbacks)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(callbacks))) {
  impl_->start();  // not earlier: callbacks use impl_
}

Device::~Device() { impl_->stop(); }

void Device::set_desired_state(const DesiredState& desired) { impl_->set_desired_state(desired); }

bool Device::send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                       std::uint64_t timestamp) {
  return impl_->send_pair(left, right, frame_id, timestamp);
}

Result<std::vector<RegisterWrite>> Device::read_registers(
    const std::vector<std::uint32_t>& addresses) {
  std::vector<RegisterWrite> values;
  for (std::size_t first = 0; first < addresses.size(); first += kMaxReads) {
    const auto begin = addresses.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(kMaxReads, addresses.size() - first);
    const auto part = impl_->ask(read_request({begin, begin + static_cast<std::ptrdiff_t>(count)}));
    if (!part) return part.error();
    values.insert(values.end(), part->begin(), part->end());
  }
  return values;
}

Status Device::write_registers(const std::vector<RegisterWrite>& writes) {
  for (std::size_t first = 0; first < writes.size(); first += kMaxWrites) {
    const auto begin = writes.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(kMaxWrites, writes.size() - first);
    const auto part =
        impl_->ask(write_request({begin, begin + static_cast<std::ptrdiff_t>(count)}));
    if (!part) return part.error();
  }
  return {};
}

void Device::reset() { impl_->reset(); }

Device::Snapshot Device::snapshot() const { return impl_->snapshot(); }

}  // namespace fpga_stereo::link
