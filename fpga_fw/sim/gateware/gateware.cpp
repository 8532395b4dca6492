#include "sim/gateware/gateware.hpp"

#include <sstream>
#include <utility>

#include "sim/gateware/chance.hpp"

namespace fpga_stereo::sim {
namespace {

Error error(const std::string& message) { return {ErrorKind::kInvalid, message}; }

template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

}  // namespace

std::vector<Pixel> pixels(const std::vector<GreyPair>& frames) {
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
    return error(concat(path, ": register IDENTITY is ", hex(identity), " instead of ",
                        hex(spec::kRegIdentityReset)));
  }
  const std::uint32_t hash = read(spec::kRegSpecHash);
  if (hash != kSpecHash) {
    return error(concat(path, ": was made from specification ", hex(hash),
                        ": this program is of specification ", hex(kSpecHash)));
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
  waiting_.reset();
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
  const ModelOutputs out = clock({});  // two clocks behind, as fs_top says
  if (out.read_valid == 0) fail(concat("no answer to a read of register ", address));
  return out.data;
}

void Gateware::idle(int num_clocks) {
  ModelInputs in;
  in.ready = 1;
  for (int i = 0; i < num_clocks; ++i) clock(in);
}

Status Gateware::apply(const Parameters& parameters, const StereoRectification& rectification) {
  const auto made = make_gateware_configuration(build_, parameters, rectification);
  if (!made) return made.error();
  const std::vector<RegisterWrite> writes = made->writes();
  write(spec::kRegErrors, spec::kErrorsConfig.mask());
  for (const RegisterWrite& w : writes) write(w.address, w.value);
  for (const RegisterWrite& w : writes) {
    for (const spec::Register& r : spec::register_table()) {
      if (r.address != w.address || r.access != spec::Access::kReadWrite) continue;
      // It counts the nodes that are written.
      if (r.address == spec::kRegMeshAddress) continue;
      if (const std::uint32_t value = read(w.address); value != w.value) {
        return error(concat("register ", r.name, " is ", hex(value), " instead of ", hex(w.value)));
      }
    }
  }
  if (spec::kErrorsConfig.get(read(spec::kRegErrors)) != 0) {
    return error("the gateware refuses its configuration: ERRORS.config");
  }
  return {};
}

Counters Gateware::counters() {
  return {read(spec::kRegFramesIn),   read(spec::kRegFramesOut),    read(spec::kRegCutFrames),
          read(spec::kRegLongFrames), read(spec::kRegBufferErrors), read(spec::kRegLabelExhaustion),
          read(spec::kRegMeshSwaps)};
}

std::array<std::uint32_t, kNumStages> Gateware::signatures() {
  constexpr int kSettled = 4;  // clocks; fs_signature.sv says 2
  for (std::int64_t end = clocks_ + patience(); clocks_ < end; idle(kSettled)) {
    if (spec::kStatusBusy.get(read(spec::kRegStatus)) == 0) break;
  }
  idle(kSettled);
  std::array<std::uint32_t, kNumStages> values{};
  for (std::uint32_t stage = 0; stage < values.size(); ++stage) {
    values[stage] = read(spec::kRegSignatureRectify + stage);
  }
  return values;
}

// The streams.

std::int64_t Gateware::patience() const {
  constexpr int kMostRows =
      512;  // the stages together keep a frame for fewer, each in a clock per pixel
  return std::int64_t{kMostRows} * build_.max_width;
}

void Gateware::fail(const std::string& what) {
  if (failure_.empty()) failure_ = concat("clock ", clocks_, ": ", what);
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
  if (waiting_ && (out.valid == 0 || as_tuple(word(out)) != as_tuple(word(*waiting_)))) {
    fail("a disparity was withdrawn before it was taken");
  }
  waiting_.reset();
  if (out.valid == 0) return;
  if (ready) {
    collect(word(out));
  } else {
    waiting_ = out;
  }
}

void Gateware::collect(const Word& word) {
  if (in_flight_.empty()) return fail("a disparity of no frame");
  Frame& frame = in_flight_.front();
  if (word.sof != values_.empty()) fail("sof is not with the first pixel of a frame");
  if (values_.empty()) frame.first_out = clocks_ - 1;
  values_.push_back(word.disparity);
  const auto count = static_cast<int>(values_.size());
  if (word.eol && row_length_ == 0) row_length_ = count;
  if (row_length_ != 0 && word.eol != (count % row_length_ == 0)) fail("rows differ in length");
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
  bool offered = false;  // and not yet taken: it must stay
  std::int64_t waited = 0;
  while (sent < words.size() || done_.size() < num_frames || written < flow.writes.size()) {
    ModelInputs in;
    offered = offered || (sent < words.size() && offers());
    if (offered) {
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
    const bool taken = offered && out.ready != 0;
    if (taken) {
      count_in(words[sent++]);
      offered = false;
    }
    const bool waits = !taken && in.ready != 0 && out.valid == 0;
    waited = taken || (out.valid != 0 && in.ready != 0) ? 0 : waited + (waits ? 1 : 0);
    if (waited > patience()) {
      fail(concat("nothing has moved for ", waited, " clocks; ", sent, " of ", words.size(),
                  " pixels are taken, ", done_.size(), " of ", num_frames, " frames are out"));
    }
    if (!failure_.empty()) return error(failure_);
  }
  return std::exchange(done_, {});
}

Result<std::vector<Frame>> Gateware::process(const std::vector<GreyPair>& frames,
                                             const Flow& flow) {
  return stream(pixels(frames), frames.size(), flow);
}

}  // namespace fpga_stereo::sim
