#include "link/session_rig.hpp"

#include "support/images.hpp"

namespace fpga_stereo::test {

SessionRig::SessionRig(const sim::SoftwareBoard::Options& options) : board(options) {
  session.opened(now);
}

sim::SoftwareBoard::Options SessionRig::small_board() {
  sim::SoftwareBoard::Options options;
  options.build.max_width = 64;
  options.build.disparities = 16;
  options.build.census_window = 5;
  options.build.correlation_window = 5;
  options.build.line_rows = 20;
  options.build.mesh_nodes = 600;
  return options;
}

SessionRig::Setting SessionRig::setting(unsigned seed, cv::Size size) {
  Setting made;
  made.parameters.disparity_range = 16;
  made.parameters.census_window_size = 5;
  made.parameters.correlation_window_size = 5;
  made.parameters.speckle_size = static_cast<int>(seed % 30);
  made.parameters.uniqueness_ratio = seed % 50;
  made.parameters.subpixel = seed % 3 != 0;
  StereoGeometry geometry;
  geometry.image_size = size;
  made.rectification = identity_rectification(geometry, static_cast<int>(seed % 3));
  return made;
}

sim::GreyPair SessionRig::pair(unsigned seed, cv::Size size) {
  const cv::Mat1b left = random_image(size, seed);
  cv::Mat1b right(size);
  for (int x = 0; x < size.width; ++x) {
    left.col(std::min(x + 5, size.width - 1)).copyTo(right.col(x));
  }
  return {left, right};
}

cv::Mat1w SessionRig::expected(const sim::GreyPair& pair, const Setting& setting) {
  ReferencePipeline pipeline;
  return pipeline.process(pair.left, pair.right, setting.rectification, setting.parameters, 1)
      .disparity.clone();
}

link::DesiredState SessionRig::wanted(const Setting& setting, std::uint64_t tag,
                                      link::StreamSet streams) const {
  link::DesiredState wanted;
  auto made =
      make_gateware_configuration(small_board().build, setting.parameters, setting.rectification);
  if (!made) throw std::runtime_error(made.error().message);
  wanted.configuration = std::make_shared<const GatewareConfiguration>(std::move(*made));
  wanted.tag = tag;
  wanted.streams = streams;
  return wanted;
}

void SessionRig::run(int ms) {
  for (int i = 0; i < ms; ++i) {
    ++ms_;
    now += Milliseconds(1);
    host += 0.001;
    board.run(Milliseconds(1));
    if (!pairs.empty() && ms_ % frame_ms == 0) board.feed(pairs[next_pair_++ % pairs.size()]);

    const Bytes more = std::exchange(session.outgoing(), {});
    waiting_.insert(waiting_.end(), more.begin(), more.end());
    const auto end =
        waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(waiting_.size(), bytes_per_ms));
    Bytes out(waiting_.begin(), end);
    waiting_.erase(waiting_.begin(), end);
    session.sent(out.size(), now, now);
    if (to_board) to_board(out);
    if (line_open && !out.empty()) board.receive(out.data(), out.size());
    Bytes in;
    for (std::size_t n = 1; n > 0;) {  // a ms has room for anything
      constexpr std::size_t kPortion = 16384;
      in.resize(in.size() + kPortion);
      n = board.transmit(&in[in.size() - kPortion], kPortion);
      in.resize(in.size() - kPortion + n);
    }
    if (to_host) to_host(in);
    if (line_open && !in.empty()) session.receive(in.data(), in.size(), now, host);
    session.tick(now, host);

    for (auto& r : session.take_received()) received.push_back(std::move(r));
    for (auto& note : session.take_notes()) notes.push_back(std::move(note));
    if (const auto step = session.take_step()) steps.push_back(*step);
  }
}

bool SessionRig::run_until(const std::function<bool()>& done, int ms) {
  for (int i = 0; i < ms; ++i) {
    if (done()) return true;
    run(1);
  }
  return done();
}

}  // namespace fpga_stereo::test
