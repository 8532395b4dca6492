// Finds the messages of four topics that belong together.
#pragma once

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>

#include <boost/bind/bind.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "ros/settings.hpp"

namespace fpga_stereo {

/// Calls back with four messages whose stamps are equal or, with approximate_sync, close.
template <class A, class B, class C, class D>
class MessageSync {
 public:
  using Callback = std::function<void(const typename A::ConstPtr&, const typename B::ConstPtr&,
                                      const typename C::ConstPtr&, const typename D::ConstPtr&)>;

  /// The filters must outlive the synchronizer, which calls back from their callbacks.
  template <class FilterA, class FilterB, class FilterC, class FilterD>
  MessageSync(const SyncSettings& settings, FilterA& a, FilterB& b, FilterC& c, FilterD& d,
              const Callback& callback) {
    using boost::placeholders::_1;
    using boost::placeholders::_2;
    using boost::placeholders::_3;
    using boost::placeholders::_4;
    const auto bound = boost::bind(callback, _1, _2, _3, _4);
    const auto queue = static_cast<std::uint32_t>(settings.queue_size);
    connect_ = [this, settings, queue, bound, &a, &b, &c, &d] {
      if (settings.approximate_sync) {
        approximate_ = std::make_unique<message_filters::Synchronizer<Approximate>>(
            Approximate(queue), a, b, c, d);
        approximate_->setMaxIntervalDuration(ros::Duration(settings.sync_tolerance));
        approximate_->registerCallback(bound);
      } else {
        exact_ = std::make_unique<message_filters::Synchronizer<Exact>>(Exact(queue), a, b, c, d);
        exact_->registerCallback(bound);
      }
    };
    connect_();
  }
  MessageSync(const MessageSync&) = delete;
  MessageSync& operator=(const MessageSync&) = delete;

  /// Forgets the messages that wait for others. Not from a callback of one of the four filters,
  /// which holds a lock that this needs.
  void restart() {
    // The queues of message_filters cannot be emptied otherwise.
    approximate_.reset();
    exact_.reset();
    connect_();
  }

 private:
  using Exact = message_filters::sync_policies::ExactTime<A, B, C, D>;
  using Approximate = message_filters::sync_policies::ApproximateTime<A, B, C, D>;

  std::function<void()> connect_;  // makes the synchronizer of the settings
  std::unique_ptr<message_filters::Synchronizer<Exact>> exact_;
  std::unique_ptr<message_filters::Synchronizer<Approximate>> approximate_;
};

}  // namespace fpga_stereo
