// A device with a virtual board: threads, lost transports, requests of users.
#include "fpga_stereo/link/device.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "link/session_rig.hpp"
#include "sim/virtual_board/board_line.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

using link::Device;
using link::Session;
using link::Stream;
using std::chrono::milliseconds;

/// A device and a virtual board whose cameras deliver one pair again and again.
class Rig {
 public:
  Rig() {
    Device::Options options;
    options.open = [this] { return line.open(); };
    options.retry = milliseconds(5);
    options.session.step = milliseconds(50);
    options.session.answer = milliseconds(100);
    Device::Callbacks callbacks;
    callbacks.received = [this](const link::ReceivedFrames& frames) {
      if (const auto act = on_frames.get()) act();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!same("disparity", expected_, frames.set.image(Stream::kDisparity))) ++wrong_;
      ++good_;
    };
    callbacks.identified = [this](const link::Identity&) {
      ++identified;
      add_event('i');
    };
    callbacks.closed = [this] { add_event('c'); };
    callbacks.note = [this](const std::string& note) {
      const std::lock_guard<std::mutex> lock(mutex_);
      notes_.push_back(note);
    };
    device = std::make_unique<Device>(options, callbacks);
    feeder_ = std::thread([this] {
      while (!stop_) {
        line.feed(pair_);
        std::this_thread::sleep_for(milliseconds(2));
      }
    });
  }
  ~Rig() {
    stop_ = true;
    feeder_.join();
    device.reset();
  }

  static link::DesiredState desired() {
    link::DesiredState wanted;
    const auto setting = SessionRig::setting(4);
    wanted.configuration =
        std::make_shared<const GatewareConfiguration>(*make_gateware_configuration(
            SessionRig::small_board().build, setting.parameters, setting.rectification));
    wanted.tag = 4;
    wanted.streams = Stream::kDisparity;
    return wanted;
  }
  void want() { device->set_desired_state(desired()); }
  int good() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return good_;
  }
  int wrong() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return wrong_;
  }
  std::vector<std::string> notes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return notes_;
  }
  /// Returns an i for each identified board and a c for each closed link, in order.
  std::string events() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return events_;
  }
  template <class Condition>
  static bool wait(const Condition& condition) {
    for (int i = 0; i < 10000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return condition();
  }
  bool wait_for_frames(int more) {
    const int before = good();
    return wait([&] { return good() >= before + more; });
  }

  sim::BoardLine line{std::make_unique<sim::SoftwareBoard>(SessionRig::small_board())};
  std::unique_ptr<Device> device;
  std::atomic<int> identified{0};

  /// A function that another thread may set; called for each frame set, before it counts.
  class Hook {
   public:
    Hook& operator=(std::function<void()> function) {
      const std::lock_guard<std::mutex> lock(mutex_);
      function_ = std::move(function);
      return *this;
    }
    std::function<void()> get() const {
      const std::lock_guard<std::mutex> lock(mutex_);
      return function_;
    }

   private:
    mutable std::mutex mutex_;
    std::function<void()> function_;
  };
  Hook on_frames;

 private:
  void add_event(char event) {
    const std::lock_guard<std::mutex> lock(mutex_);
    events_ += event;
  }

  sim::GreyPair pair_ = SessionRig::pair(1);
  cv::Mat1w expected_ = SessionRig::expected(pair_, SessionRig::setting(4));
  mutable std::mutex mutex_;
  int good_ = 0, wrong_ = 0;
  std::vector<std::string> notes_;
  std::string events_;
  std::atomic<bool> stop_{false};
  std::thread feeder_;
};

TEST(Device, DeliversTheDesiredStreams) {
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(10));
  EXPECT_EQ(rig.identified, 1);
  const Device::Snapshot s = rig.device->snapshot();
  EXPECT_EQ(s.state, link::LinkState::kStreaming);
  EXPECT_EQ(s.trouble_text, "");
  EXPECT_EQ(s.description, "virtual board in this process");
  EXPECT_EQ(s.times_opened, 1U);
  ASSERT_TRUE(s.identity);
  EXPECT_EQ(s.identity->build.disparities, 16);
  EXPECT_EQ(rig.wrong(), 0);
}

TEST(Device, SurvivesEveryUnplug) {
  Rig rig;
  rig.want();
  for (int i = 0; i < 100; ++i) {
    std::this_thread::sleep_for(milliseconds(i % 13));
    rig.line.plug(false);
    std::this_thread::sleep_for(milliseconds(i % 3));
    if (i % 2 == 0) rig.line.reset_board();
    rig.line.plug(true);
    if (i % 20 == 0) {
      ASSERT_TRUE(rig.wait_for_frames(2)) << i << rig.device->snapshot().trouble_text;
    }
  }
  ASSERT_TRUE(rig.wait_for_frames(10));
  EXPECT_EQ(rig.wrong(), 0);
  const Device::Snapshot s = rig.device->snapshot();
  EXPECT_GE(s.times_opened, 20U);
  EXPECT_EQ(s.transport.bytes_in, s.decoder.bytes) << "of all connections";
  EXPECT_GT(s.transport.bytes_out, 0U);
}

TEST(Device, ReportsWhyThereIsNoBoard) {
  Rig rig;
  rig.line.plug(false);
  ASSERT_TRUE(
      Rig::wait([&] { return rig.device->snapshot().trouble_text == "no board is plugged in"; }));
  const auto answer = rig.device->read_registers({0});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message, "no board is plugged in");
  std::this_thread::sleep_for(milliseconds(50));
  const auto notes = rig.notes();
  EXPECT_EQ(std::count(notes.begin(), notes.end(), "no board is plugged in"), 1) << "reported once";
}

TEST(Device, PerformsTheStepsOfTheWatchdog) {
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(3));
  rig.line.hold(true);
  ASSERT_TRUE(Rig::wait([&] { return rig.line.recovered(link::Recovery::kReset) >= 1; }));
  EXPECT_GE(rig.line.recovered(link::Recovery::kPurge), 1);
  EXPECT_GE(rig.line.recovered(link::Recovery::kRestart), 1);
  EXPECT_GE(rig.device->snapshot().times_opened, 2U);
  rig.line.hold(false);
  ASSERT_TRUE(rig.wait_for_frames(3));
  EXPECT_EQ(rig.wrong(), 0);
}

TEST(Device, ResetReopensTheTransport) {
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(3));
  rig.device->reset();
  ASSERT_TRUE(Rig::wait([&] { return rig.device->snapshot().times_opened == 2; }));
  EXPECT_EQ(rig.line.recovered(link::Recovery::kReset), 1);
  ASSERT_TRUE(rig.wait_for_frames(3));
}

TEST(Device, AnswersUsersWhileItStreams) {
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(3));
  std::vector<std::thread> threads;
  std::atomic<int> right{0};
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        const auto values = rig.device->read_registers({spec::kRegSpecHash});
        if (values && (*values)[0].value == kSpecHash) ++right;
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(right, 60);
}

/// Blocks the delivery thread in a callback until it is opened.
class Gate {
 public:
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    is_reached_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return is_open_; });
  }
  void wait_until_reached() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return is_reached_; });
  }
  void open() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_open_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_reached_ = false, is_open_ = false;
};

TEST(Device, ABlockedCallbackDoesNotStopTheLink) {
  Gate gate;
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(3));
  rig.on_frames = [&] { gate.wait(); };
  gate.wait_until_reached();
  const auto before = rig.device->snapshot();
  ASSERT_TRUE(Rig::wait([&] { return rig.device->snapshot().undelivered > 5; })) << "counted";
  const auto values = rig.device->read_registers({spec::kRegSpecHash});
  ASSERT_TRUE(values);
  EXPECT_EQ((*values)[0].value, kSpecHash);
  const auto after = rig.device->snapshot();
  EXPECT_EQ(after.state, link::LinkState::kStreaming);
  EXPECT_EQ(after.times_opened, 1U);
  EXPECT_GT(after.frames.good, before.frames.good + 5);
  rig.on_frames = nullptr;
  gate.open();
  ASSERT_TRUE(rig.wait_for_frames(10));
  EXPECT_EQ(rig.wrong(), 0);
}

TEST(Device, CallbacksMayUseTheDevice) {
  std::atomic<bool> is_read{false};
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(1));
  rig.on_frames = [&is_read, device = rig.device.get()] {
    const auto values = device->read_registers({spec::kRegSpecHash});
    device->set_desired_state(Rig::desired());
    if (values && (*values)[0].value == kSpecHash && device->snapshot().identity) is_read = true;
  };
  EXPECT_TRUE(Rig::wait([&] { return is_read.load(); }));
}

TEST(Device, DestructorWaitsForTheCallbackThatRuns) {
  auto rig = std::make_unique<Rig>();
  Gate gate;
  std::atomic<bool> is_over{false};
  rig->want();
  ASSERT_TRUE(rig->wait_for_frames(1));
  rig->on_frames = [&] {
    gate.wait();
    is_over = true;
  };
  gate.wait_until_reached();
  std::thread opener([&] {
    std::this_thread::sleep_for(milliseconds(50));
    gate.open();
  });
  rig->device.reset();
  EXPECT_TRUE(is_over);
  opener.join();
}

TEST(Device, IdentifiedAndClosedAlternate) {
  Rig rig;
  rig.want();
  for (int i = 0; i < 30; ++i) {
    rig.line.plug(true);
    ASSERT_TRUE(Rig::wait([&] { return rig.device->snapshot().identity.has_value(); }));
    rig.line.plug(false);
    ASSERT_TRUE(Rig::wait([&] { return !rig.device->snapshot().identity; }));
  }
  ASSERT_TRUE(Rig::wait([&] { return rig.events().size() >= 2; }));
  const std::string events = rig.events();
  EXPECT_EQ(events.find("ii"), std::string::npos) << events;
  EXPECT_EQ(events.find("ic"), 0U) << events;
}

TEST(Device, LeavesTheBoardSilent) {
  Rig rig;
  rig.want();
  ASSERT_TRUE(rig.wait_for_frames(3));
  rig.device.reset();
  auto line = rig.line.open();
  ASSERT_TRUE(line);
  std::vector<std::uint8_t> bytes(1 << 20);
  std::size_t came = 0;
  for (int i = 0; i < 20; ++i) {
    const auto n = (*line)->read(bytes.data(), bytes.size(), milliseconds(5));
    ASSERT_TRUE(n);
    came += i < 2 ? 0 : *n;  // bytes in flight
  }
  EXPECT_LT(came, 200U);
}

}  // namespace
}  // namespace fpga_stereo::test
