#include "sim/gateware/gateware.hpp"

#include <fmt/format.h>

#include <tuple>
#include <utility>

#include "sim/gateware/chance.hpp"

namespace fpga_stereo::sim {
namespace {

Error error(const std::string& message) { return {ErrorKind::kInvalid, message}; }

}  // namespace

std::vector<Pixel> to_pixels(const std::vector<GreyPair>& frames) {
  std::vector<Pixel> words;
  for (const GreyPair& frame : frames) {
    CV_Assert(frame.left.size() == frame.right.size());
    for (int y = 0; y < frame.left.rows; ++y) {
      for (int x = 0; x < frame.left.cols; ++x) {
        words.push_back(
            {frame.left(y, x), frame.right(y, x), x == 0 && y == 0, x == frame.left.cols - 1});
      }
    }
  }
  return words;
}

Result<Gateware> Gateware::open(const std::string& path, std::uint32_t seed) {
  auto loaded = LoadedModel<ModelInterface>::open(path, kModelSymbol, seed);
  if (!loaded) return loaded.error();
  Gateware gateware(std::move(*loaded));
  gateware.reset();
  if (const Status status = gateware.check_identity(path); !status) return status.error();
  gateware.read_build();
  return gateware;
}

Status Gateware::check_identity(const std::string& path) {
  const std::uint32_t identity = read(spec::kRegIdentity);
  if (identity != spec::kRegIdentityReset) {
    return error(fmt::format("{}: register IDENTITY is {}, expected {}", path, hex(identity),
                             hex(spec::kRegIdentityReset)));
  }
  const std::uint32_t hash = read(spec::kRegSpecHash);
  if (hash != kSpecHash) {
    return error(fmt::format("{}: was made from specification {}, but this program from {}", path,
                             hex(hash), hex(kSpecHash)));
  }
  return {};
}

void Gateware::read_build() {
  build_ = GatewareBuild::from_registers(read(spec::kRegBuild), read(spec::kRegBuildLineRows),
                                         read(spec::kRegBuildMeshNodes));
}

// Clocks and registers.

ModelOutputs Gateware::clock(const ModelInputs& in) {
  const ModelOutputs out = model_.clock(in);
  ++clocks_;
  if (in.rst_n != 0) count_out(out, in.ready != 0);
  return out;
}

void Gateware::reset(int num_clocks) {
  ModelInputs in;
  in.rst_n = 0;
  for (int i = 0; i < num_clocks; ++i) clock(in);
  in_flight_.clear();
  values_.clear();
  row_length_ = 0;
  done_.clear();
  stalled_.reset();
  failure_.clear();
}

void Gateware::write(std::uint32_t address, std::uint32_t value) {
  ModelInputs in;
  in.write = 1;
  in.address = static_cast<std::uint8_t>(address);
  in.data = value;
  clock(in);
}

std::uint32_t Gateware::read(std::uint32_t address) {
  ModelInputs in;
  in.read = 1;
  in.address = static_cast<std::uint8_t>(address);
  clock(in);
  clock({});
  const ModelOutputs out = clock({});  // two clocks after the read, see fs_top
  if (out.read_valid == 0) fail(fmt::format("no answer to a read of register {}", address));
  return out.data;
}

void Gateware::idle(int num_clocks) {
  ModelInputs in;
  in.ready = 1;
  for (int i = 0; i < num_clocks; ++i) clock(in);
}

Status Gateware::apply(const Parameters& parameters, const StereoRectification& rectification) {
  const auto configuration = make_gateware_configuration(build_, parameters, rectification);
  if (!configuration) return configuration.error();
  const std::vector<RegisterWrite> writes = configuration->writes();
  write(spec::kRegErrors, spec::kErrorsConfig.mask());
  for (const RegisterWrite& w : writes) write(w.address, w.value);
  for (const RegisterWrite& w : writes) {
    for (const spec::Register& r : spec::register_table()) {
      if (r.address != w.address || r.access != spec::Access::kReadWrite) continue;
      // MESH_ADDRESS changes with each written node.
      if (r.address == spec::kRegMeshAddress) continue;
      if (const std::uint32_t value = read(w.address); value != w.value) {
        return error(
            fmt::format("register {} is {}, but {} was written", r.name, hex(value), hex(w.value)));
      }
    }
  }
  if (spec::kErrorsConfig.get(read(spec::kRegErrors)) != 0) {
    return error("the gateware refuses its configuration: ERRORS.config is set");
  }
  return {};
}

Counters Gateware::counters() {
  return {read(spec::kRegFramesIn),   read(spec::kRegFramesOut),    read(spec::kRegCutFrames),
          read(spec::kRegLongFrames), read(spec::kRegBufferErrors), read(spec::kRegLabelExhaustion),
          read(spec::kRegMeshUploads)};
}

std::array<std::uint32_t, kNumGatewareStages> Gateware::signatures() {
  constexpr int kSettleClocks = 4;  // fs_signature.sv needs 2
  for (std::int64_t end = clocks_ + timeout_clocks(); clocks_ < end; idle(kSettleClocks)) {
    if (spec::kStatusBusy.get(read(spec::kRegStatus)) == 0) break;
  }
  idle(kSettleClocks);
  std::array<std::uint32_t, kNumGatewareStages> values{};
  for (std::uint32_t stage = 0; stage < values.size(); ++stage) {
    values[stage] = read(spec::kRegSignatureRectify + stage);
  }
  return values;
}

// The streams.

std::int64_t Gateware::timeout_clocks() const {
  // An upper bound of the rows that the stages hold together, at one clock per pixel.
  constexpr int kMaxRows = 512;
  return std::int64_t{kMaxRows} * build_.max_width;
}

void Gateware::fail(const std::string& what) {
  if (failure_.empty()) failure_ = fmt::format("clock {}: {}", clocks_, what);
}

void Gateware::count_in(const Pixel& pixel) {
  if (pixel.sof) {
    in_flight_.emplace_back();
    in_flight_.back().first_in = clocks_ - 1;
  }
  if (!in_flight_.empty()) in_flight_.back().last_in = clocks_ - 1;
}

void Gateware::count_out(const ModelOutputs& out, bool ready) {
  const auto word = [](const ModelOutputs& o) {
    return Word{o.disparity, o.sof != 0, o.eol != 0, o.eof != 0, o.bad != 0};
  };
  const auto as_tuple = [](const Word& w) {
    return std::make_tuple(w.disparity, w.sof, w.eol, w.eof, w.bad);
  };
  if (stalled_ && (out.valid == 0 || as_tuple(word(out)) != as_tuple(word(*stalled_)))) {
    fail("a disparity was withdrawn before it was taken");
  }
  stalled_.reset();
  if (out.valid == 0) return;
  if (ready) {
    collect(word(out));
  } else {
    stalled_ = out;
  }
}

void Gateware::collect(const Word& word) {
  if (in_flight_.empty()) return fail("a disparity came without a frame in flight");
  Frame& frame = in_flight_.front();
  if (word.sof != values_.empty()) fail("sof does not mark the first pixel of a frame");
  if (values_.empty()) frame.first_out = clocks_ - 1;
  values_.push_back(word.disparity);
  const auto count = static_cast<int>(values_.size());
  if (word.eol && row_length_ == 0) row_length_ = count;
  if (row_length_ != 0 && word.eol != (count % row_length_ == 0))
    fail("the rows of a frame differ in length");
  if (word.bad && !word.eof) fail("bad without eof");
  if (!word.eof) return;
  if (!word.eol) return fail("eof without eol");
  frame.disparity = cv::Mat1w(values_, true).reshape(1, count / row_length_);
  frame.bad = word.bad;
  frame.last_out = clocks_ - 1;
  done_.push_back(std::move(frame));
  in_flight_.pop_front();
  values_.clear();
  row_length_ = 0;
}

Result<std::vector<Frame>> Gateware::stream(const std::vector<Pixel>& words, std::size_t num_frames,
                                            const Flow& flow) {
  Chance offers(flow.valid, flow.seed), takes(flow.ready, flow.seed + 1);
  std::size_t sent = 0, written = 0;
  bool is_offered = false;  // stays set until the pixel is taken
  std::int64_t idle_clocks = 0;
  while (sent < words.size() || done_.size() < num_frames || written < flow.writes.size()) {
    ModelInputs in;
    is_offered = is_offered || (sent < words.size() && offers());
    if (is_offered) {
      in.valid = 1;
      in.sof = words[sent].sof ? 1 : 0;
      in.eol = words[sent].eol ? 1 : 0;
      in.left = words[sent].left;
      in.right = words[sent].right;
    }
    in.ready = takes() ? 1 : 0;
    if (written < flow.writes.size()) {
      in.write = 1;
      in.address = static_cast<std::uint8_t>(flow.writes[written].address);
      in.data = flow.writes[written].value;
      ++written;
    }
    const ModelOutputs out = clock(in);
    const bool taken = is_offered && out.ready != 0;
    if (taken) {
      count_in(words[sent++]);
      is_offered = false;
    }
    const bool waits = !taken && in.ready != 0 && out.valid == 0;
    idle_clocks = taken || (out.valid != 0 && in.ready != 0) ? 0 : idle_clocks + (waits ? 1 : 0);
    if (idle_clocks > timeout_clocks()) {
      fail(fmt::format(
          "nothing has moved for {} clocks; {} of {} pixels are taken, {} of {} frames are out",
          idle_clocks, sent, words.size(), done_.size(), num_frames));
    }
    if (!failure_.empty()) return error(failure_);
  }
  return std::exchange(done_, {});
}

Result<std::vector<Frame>> Gateware::process(const std::vector<GreyPair>& frames,
                                             const Flow& flow) {
  return stream(to_pixels(frames), frames.size(), flow);
}

}  // namespace fpga_stereo::sim
