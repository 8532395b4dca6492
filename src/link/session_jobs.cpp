// What a session asks of a board, and in which order. Everything that is written is read back.
#include <algorithm>
#include <memory>
#include <utility>

#include "link/session.hpp"

namespace fpga_stereo::link {
namespace {

using Values = std::vector<RegisterWrite>;

constexpr std::chrono::milliseconds kApplyTime{2000};  // a frame of the slowest camera, and more
constexpr std::chrono::milliseconds kApplyPoll{10};

std::string register_name(std::uint32_t address) {
  for (const spec::Register& r : spec::register_table()) {
    if (r.address == address) return r.name;
  }
  return hex(address);
}

std::uint32_t value_of(const Values& values, std::uint32_t address) {
  for (const RegisterWrite& v : values) {
    if (v.address == address) return v.value;
  }
  return 0;
}

std::vector<std::uint32_t> addresses(const Values& values) {
  std::vector<std::uint32_t> all;
  for (const RegisterWrite& v : values) all.push_back(v.address);
  return all;
}

/// What the registers of a mesh show when nodes [first, first + count) have been written.
Values behind_mesh(std::uint32_t right, const std::vector<std::uint32_t>& mesh, std::size_t first,
                   std::size_t count) {
  return {{spec::kRegMeshSignature, mesh_signature(mesh, first, count)},
          {spec::kRegMeshAddress,
           spec::kMeshAddressCamera.put(right) |
               spec::kMeshAddressNode.put(static_cast<std::uint32_t>(first + count))}};
}

/// What the shadow shows when all of a configuration has been written, meshes last.
Values shadow(const GatewareConfiguration& configuration) {
  Values values = configuration.registers;
  const std::vector<std::uint32_t>& last = configuration.mesh[1];
  if (last.empty()) return values;
  const std::size_t first = (last.size() - 1) / kMaxNodes * kMaxNodes;
  const Values mesh = behind_mesh(1, last, first, last.size() - first);
  values.insert(values.end(), mesh.begin(), mesh.end());
  return values;
}

/// What was read is what was written.
Status same(const Values& written, const Values& read) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (read[i].value == written[i].value) continue;
    return Error{ErrorKind::kIo, "the board holds " + hex(read[i].value) + " in register " +
                                     register_name(written[i].address) + " instead of " +
                                     hex(written[i].value)};
  }
  return {};
}

}  // namespace

void Session::begin(Request request, std::function<Status(const Values&)> done) {
  jobs_.push_back({std::move(request), std::move(done), {}, {}});
}

void Session::identify() {
  state_ = LinkState::kIdentifying;
  begin(read_request(Identity::registers()), [this](const Values& v) { return identified(v); });
}

Status Session::identified(const Values& values) {
  identity_ = Identity::from_values(values);
  if (Status status = identity_->check(); !status) return status;
  state_ = LinkState::kConfiguring;
  // Nothing comes that nobody has asked for, until it is known what the board computes.
  write_back({{spec::kRegStreams, 0}});
  begin(read_request({spec::kRegConfiguration}), [this](const Values& v) {
    configuration_ = value_of(v, spec::kRegConfiguration);
    return Status{};
  });
  configuration_stale_ = streams_stale_ = true;
  return {};
}

void Session::write_back(const Values& writes) {
  begin(write_request(writes), [](const Values&) { return Status{}; });
  begin(read_request(addresses(writes)),
        [writes](const Values& read) { return same(writes, read); });
}

void Session::write_mesh(std::uint32_t right, const std::vector<std::uint32_t>& mesh) {
  for (std::size_t first = 0; first < mesh.size(); first += kMaxNodes) {
    const std::size_t count = std::min(kMaxNodes, mesh.size() - first);
    begin(mesh_request(right != 0, mesh, first, count), [](const Values&) { return Status{}; });
    const Values expected = behind_mesh(right, mesh, first, count);
    begin(read_request(addresses(expected)),
          [expected](const Values& read) { return same(expected, read); });
  }
}

void Session::configure() {
  configuration_stale_ = false;
  const GatewareConfiguration& configuration = *desired_.configuration;
  write_back(configuration.registers);
  if (configuration.mesh != meshes_) {
    meshes_ = {};  // until they have taken effect it is not known which the board has
    for (std::uint32_t right = 0; right < 2; ++right) write_mesh(right, configuration.mesh[right]);
  }
  begin(write_request({{spec::kRegErrors, spec::kErrorsConfig.mask()}}),
        [this, tag = desired_.tag](const Values&) {
          // Before the apply: its first frame may come before its answer.
          tags_[configuration_ + 1] = tag;
          return Status{};
        });
  begin(write_request({{spec::kRegControl, spec::kControlApply.put(1)}}),
        [this, shared = desired_.configuration](const Values&) {
          apply_deadline_ = now_ + kApplyTime;
          await_apply(shared);
          return Status{};
        });
}

void Session::await_apply(std::shared_ptr<const GatewareConfiguration> configuration) {
  // The shadow once more: a board that is reset before it applies has other values there, and what
  // it has made active is worth nothing.
  const Values expected = shadow(*configuration);
  std::vector<std::uint32_t> read = addresses(expected);
  read.insert(read.end(), {spec::kRegErrors, spec::kRegStatus, spec::kRegConfiguration});
  // At the front: what else waits is for the configuration to come.
  Job job{read_request(read), {}, {}, now_ + kApplyPoll};
  job.done = [this, configuration, expected](const Values& v) -> Status {
    if (spec::kErrorsConfig.get(value_of(v, spec::kRegErrors)) != 0) {
      return Error{ErrorKind::kInvalid, "the board refuses its configuration: ERRORS.config"};
    }
    if (Status status = same(expected, v); !status) return status;
    const bool pending = spec::kStatusPending.get(value_of(v, spec::kRegStatus)) != 0;
    const std::uint32_t now = value_of(v, spec::kRegConfiguration);
    if (!pending && now != configuration_) {
      // An apply that was sent again may have taken effect each time.
      if (now - configuration_ > static_cast<std::uint32_t>(options_.tries)) {
        return Error{ErrorKind::kIo, kWasReset};
      }
      configuration_ = now;
      meshes_ = configuration->mesh;
      ++counters_.configurations;
      return {};
    }
    if (now_ >= apply_deadline_) {
      return Error{ErrorKind::kTimeout,
                   "the board does not take its configuration: no frame has ended for 2 s"};
    }
    await_apply(configuration);
    return {};
  };
  jobs_.push_front(std::move(job));
}

void Session::set_streams() {
  streams_stale_ = false;
  // From here on frames are due: pairs that went in before are no sign of a stall.
  last_frame_ = now_;
  frame_came_ = true;
  input_at_frame_ = board_.frames_in;
  const auto interval = [](int pairs) { return static_cast<std::uint32_t>(pairs); };
  write_back(
      {{spec::kRegInput, spec::kInputHost.put(desired_.host_input ? 1 : 0)},
       {spec::kRegFrameInterval, spec::kFrameIntervalPairs.put(interval(desired_.frame_interval)) |
                                     spec::kFrameIntervalRaw.put(interval(desired_.raw_interval))},
       {spec::kRegMidExposure,
        spec::kMidExposureUs.put(static_cast<std::uint32_t>(desired_.mid_exposure.count()))},
       {spec::kRegStreams, desired_.streams.bits()}});
}

void Session::settle() {
  if (state_ == LinkState::kIdentifying || state_ == LinkState::kRefused || !jobs_.empty()) return;
  if (configuration_stale_ && desired_.keep_configuration) {
    configuration_stale_ = false;
    tags_[0] = desired_.tag;
  }
  if (configuration_stale_) {
    // Not before there is one that was made for this board.
    if (desired_.configuration && desired_.configuration->build == identity_->build) configure();
    return;
  }
  if (streams_stale_) return set_streams();
  attempts_ = 0;
  refusal_.clear();
  state_ = desired_.streams.empty() ? LinkState::kReady : LinkState::kStreaming;
}

void Session::poll() {
  next_poll_ = now_ + options_.poll;
  if (state_ == LinkState::kRefused) {
    // It may be flashed while its line stays open. What else it has refused may pass: a frame that
    // did not end, resets by a weak supply.
    if (refused_as_ == ErrorKind::kIncompatible) return identify();
    if (now_ >= next_retry_) return begin_anew();
  }
  begin(read_request({spec::kRegErrors, spec::kRegFramesIn, spec::kRegFramesOut,
                      spec::kRegCutFrames, spec::kRegLongFrames, spec::kRegBufferErrors,
                      spec::kRegConfiguration, spec::kRegFramesDropped, spec::kRegBadPackets,
                      spec::kRegLostPackets, spec::kRegInputErrors, spec::kRegStreams}),
        [this](const Values& v) { return polled(v); });
}

Status Session::polled(const Values& v) {
  const bool as_set = value_of(v, spec::kRegConfiguration) == configuration_ &&
                      value_of(v, spec::kRegStreams) == desired_.streams.bits();
  const bool set = state_ == LinkState::kReady || state_ == LinkState::kStreaming;
  if (set && !as_set) {
    if (configuration_stale_ || streams_stale_) return {};
    return Error{ErrorKind::kIo, kWasReset};
  }
  board_.errors = value_of(v, spec::kRegErrors);
  board_.frames_in = value_of(v, spec::kRegFramesIn);
  board_.frames_out = value_of(v, spec::kRegFramesOut);
  board_.cut_frames = value_of(v, spec::kRegCutFrames);
  board_.long_frames = value_of(v, spec::kRegLongFrames);
  board_.buffer_errors = value_of(v, spec::kRegBufferErrors);
  board_.frames_dropped = value_of(v, spec::kRegFramesDropped);
  board_.bad_packets = value_of(v, spec::kRegBadPackets);
  board_.lost_packets = value_of(v, spec::kRegLostPackets);
  board_.input_errors = value_of(v, spec::kRegInputErrors);
  if (frame_came_ || state_ != LinkState::kStreaming) input_at_frame_ = board_.frames_in;
  frame_came_ = false;
  if (state_ != LinkState::kStreaming) {  // nothing else will tell that the line works again
    watchdog_trouble_ = LinkTrouble::kNone;
    ladder_ = 0;
  }
  return {};
}

}  // namespace fpga_stereo::link
