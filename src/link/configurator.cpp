#include "link/configurator.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "link/register_values.hpp"

namespace fpga_stereo::link {
namespace {

using Values = Configurator::Values;

constexpr std::chrono::milliseconds kApplyTimeout{2000};  // longer than the slowest camera's frame
constexpr std::chrono::milliseconds kApplyPoll{10};

Status accept(const Values&, Time) { return {}; }

std::string register_name(std::uint32_t address) {
  for (const spec::Register& r : spec::register_table()) {
    if (r.address == address) return r.name;
  }
  return hex(address);
}

/// Returns what the mesh registers hold after nodes [first, first + count) were written.
Values after_mesh(std::uint32_t camera, const std::vector<std::uint32_t>& mesh, std::size_t first,
                  std::size_t count) {
  return {{spec::kRegMeshSignature, mesh_signature(mesh, first, count)},
          {spec::kRegMeshAddress,
           spec::kMeshAddressCamera.put(camera) |
               spec::kMeshAddressNode.put(static_cast<std::uint32_t>(first + count))}};
}

/// Returns what the shadow registers hold after the whole configuration was written, meshes last.
Values shadow_of(const GatewareConfiguration& configuration) {
  Values values = configuration.registers;
  const std::vector<std::uint32_t>& last = configuration.mesh[1];
  if (last.empty()) return values;
  const std::size_t first = (last.size() - 1) / kMaxNodes * kMaxNodes;
  const Values mesh = after_mesh(1, last, first, last.size() - first);
  values.insert(values.end(), mesh.begin(), mesh.end());
  return values;
}

/// Checks that the registers hold what was written.
Status check_read_back(const Values& written, const Values& read) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (read[i].value == written[i].value) continue;
    return Error{ErrorKind::kIo,
                 fmt::format("the board holds {} in register {} instead of {}", hex(read[i].value),
                             register_name(written[i].address), hex(written[i].value))};
  }
  return {};
}

bool is_same(const GatewareConfiguration& a, const GatewareConfiguration& b) {
  const auto equal = [](const RegisterWrite& x, const RegisterWrite& y) {
    return x.address == y.address && x.value == y.value;
  };
  return a.mesh == b.mesh && std::equal(a.registers.begin(), a.registers.end(), b.registers.begin(),
                                        b.registers.end(), equal);
}

}  // namespace

bool Configurator::set_desired_state(const DesiredState& desired) {
  const DesiredState& old = desired_;
  const bool is_new =
      desired.configuration && (!old.configuration || desired.tag != old.tag ||
                                (desired.configuration != old.configuration &&
                                 !is_same(*desired.configuration, *old.configuration)));
  is_configuration_stale_ |= is_new;
  are_streams_stale_ |=
      desired.streams != old.streams || desired.frame_interval != old.frame_interval ||
      desired.raw_interval != old.raw_interval || desired.host_input != old.host_input ||
      desired.mid_exposure != old.mid_exposure;
  desired_ = desired;
  return is_new;
}

void Configurator::restart() {
  identity_.reset();
  mesh_source_.reset();
  tags_.clear();
  polled_.reset();
  identify();
}

void Configurator::identify() {
  is_identified_ = false;
  requests_.push_back(read_request(Identity::registers()),
                      [this](const Values& values, Time) { return on_identity(values); });
}

Status Configurator::on_identity(const Values& values) {
  identity_ = Identity::from_values(values);
  if (Status status = identity_->check(); !status) return status;
  is_identified_ = true;
  // Frames are unwelcome until it is known what the board computes.
  write_and_read_back({{spec::kRegStreams, 0}});
  requests_.push_back(read_request({spec::kRegConfiguration}), [this](const Values& read, Time) {
    configuration_ = value_of(read, spec::kRegConfiguration);
    return Status{};
  });
  is_configuration_stale_ = are_streams_stale_ = true;
  return {};
}

void Configurator::write_and_read_back(const Values& writes) {
  requests_.push_back(write_request(writes), accept);
  requests_.push_back(read_request(addresses_of(writes)),
                      [writes](const Values& read, Time) { return check_read_back(writes, read); });
}

void Configurator::write_mesh(std::uint32_t camera, const std::vector<std::uint32_t>& mesh) {
  for (std::size_t first = 0; first < mesh.size(); first += kMaxNodes) {
    const std::size_t count = std::min(kMaxNodes, mesh.size() - first);
    requests_.push_back(mesh_request(camera != 0, mesh, first, count), accept);
    const Values expected = after_mesh(camera, mesh, first, count);
    requests_.push_back(read_request(addresses_of(expected)), [expected](const Values& read, Time) {
      return check_read_back(expected, read);
    });
  }
}

void Configurator::write_configuration() {
  is_configuration_stale_ = false;
  const auto configuration = desired_.configuration;
  write_and_read_back(configuration->registers);
  if (!mesh_source_ || mesh_source_->mesh != configuration->mesh) {
    mesh_source_.reset();  // unknown until the new meshes have taken effect
    for (std::uint32_t camera = 0; camera < 2; ++camera) {
      write_mesh(camera, configuration->mesh[camera]);
    }
  }
  requests_.push_back(write_request({{spec::kRegErrors, spec::kErrorsConfig.mask()}}),
                      [this, tag = desired_.tag](const Values&, Time) {
                        // Before the apply: its first frame may arrive before its answer.
                        tags_.bind(configuration_ + 1, tag);
                        return Status{};
                      });
  requests_.push_back(write_request({{spec::kRegControl, spec::kControlApply.put(1)}}),
                      [this, configuration](const Values&, Time now) {
                        await_apply(configuration, now, now + kApplyTimeout);
                        return Status{};
                      });
}

void Configurator::await_apply(std::shared_ptr<const GatewareConfiguration> configuration, Time now,
                               Time deadline) {
  // The shadow is read once more: a board that was reset before the apply has activated other
  // values.
  std::vector<std::uint32_t> addresses = addresses_of(shadow_of(*configuration));
  addresses.insert(addresses.end(), {spec::kRegErrors, spec::kRegStatus, spec::kRegConfiguration});
  // At the front: other requests wait until the configuration has taken effect.
  requests_.push_front(
      read_request(addresses),
      [this, configuration = std::move(configuration), deadline](const Values& values, Time at) {
        return check_apply(configuration, values, at, deadline);
      },
      now + kApplyPoll);
}

Status Configurator::check_apply(const std::shared_ptr<const GatewareConfiguration>& configuration,
                                 const Values& values, Time now, Time deadline) {
  if (spec::kErrorsConfig.get(value_of(values, spec::kRegErrors)) != 0) {
    return Error{ErrorKind::kInvalid, "the board refuses its configuration: ERRORS.config"};
  }
  if (Status status = check_read_back(shadow_of(*configuration), values); !status) return status;
  const bool is_pending = spec::kStatusPending.get(value_of(values, spec::kRegStatus)) != 0;
  const std::uint32_t id = value_of(values, spec::kRegConfiguration);
  if (!is_pending && id != configuration_) {
    if (id - configuration_ > static_cast<std::uint32_t>(max_applies_)) {
      return Error{ErrorKind::kIo, kBoardWasReset};
    }
    configuration_ = id;
    mesh_source_ = configuration;
    ++applied_count_;
    return {};
  }
  if (now >= deadline) {
    return Error{ErrorKind::kTimeout,
                 "the board does not take its configuration: no frame has ended for 2 s"};
  }
  await_apply(configuration, now, deadline);
  return {};
}

void Configurator::write_streams() {
  are_streams_stale_ = false;
  const auto interval = [](int pairs) { return static_cast<std::uint32_t>(pairs); };
  write_and_read_back(
      {{spec::kRegInput, spec::kInputHost.put(desired_.host_input ? 1 : 0)},
       {spec::kRegFrameInterval, spec::kFrameIntervalPairs.put(interval(desired_.frame_interval)) |
                                     spec::kFrameIntervalRaw.put(interval(desired_.raw_interval))},
       {spec::kRegMidExposure,
        spec::kMidExposureUs.put(static_cast<std::uint32_t>(desired_.mid_exposure.count()))},
       {spec::kRegStreams, desired_.streams.bits()}});
}

Configurator::Progress Configurator::advance() {
  if (is_configuration_stale_ && desired_.keep_configuration) {
    is_configuration_stale_ = false;
    tags_.bind_any(desired_.tag);
  }
  if (is_configuration_stale_) {
    if (!desired_.configuration || !(desired_.configuration->build == identity_->build)) {
      return Progress::kBlocked;
    }
    write_configuration();
    return Progress::kWorking;
  }
  if (are_streams_stale_) {
    write_streams();
    return Progress::kStreams;
  }
  return Progress::kDone;
}

void Configurator::poll() {
  requests_.push_back(
      read_request({spec::kRegErrors, spec::kRegFramesIn, spec::kRegFramesOut, spec::kRegCutFrames,
                    spec::kRegLongFrames, spec::kRegBufferErrors, spec::kRegConfiguration,
                    spec::kRegFramesDropped, spec::kRegBadPackets, spec::kRegLostPackets,
                    spec::kRegInputErrors, spec::kRegStreams}),
      [this](const Values& values, Time) {
        polled_ = values;
        return Status{};
      });
}

bool Configurator::matches(const Values& polled) const {
  return value_of(polled, spec::kRegConfiguration) == configuration_ &&
         value_of(polled, spec::kRegStreams) == desired_.streams.bits();
}

std::optional<std::uint64_t> Configurator::active_tag() const {
  if (is_configuration_stale_ || tags_.has_later(configuration_)) return std::nullopt;
  return tags_.find(configuration_);
}

}  // namespace fpga_stereo::link
