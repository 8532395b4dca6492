#include "board/tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "board/streams.hpp"

namespace fpga_stereo::tools {
namespace {

using Verdict = link::FrameVerdict;

constexpr std::array<std::pair<Verdict, const char*>, 5> kCauses{
    {{Verdict::kRowsMissing, "rows missing"},
     {Verdict::kNoTrailer, "trailer missing"},
     {Verdict::kFlagged, "flagged by the board"},
     {Verdict::kBadSignature, "wrong signature"},
     {Verdict::kBadStamp, "impossible time stamp"}}};

class Table {
 public:
  Table() { text_ << std::fixed; }
  template <class... Parts>
  void line(const std::string& name, const Parts&... parts) {
    text_ << std::left << std::setw(11) << name;
    (text_ << ... << parts) << "\n";
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

}  // namespace

Tally::Tally(const FrameSource& source, link::StreamSet streams)
    : streams_(streams), start_(source.snapshot()) {}

void Tally::add(const ArrivedFrames& frames) {
  for (std::size_t i = 0; i < frames_.size(); ++i) frames_[i] += !frames.set.images[i].empty();
  for (const Verdict verdict : frames.set.verdicts) ++dropped_[verdict];
  if (frames.stamp && frames.set.verdicts.empty()) {
    latencies_.push_back((frames.at - *frames.stamp) * 1e3);
  }
}

double Tally::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

std::string Tally::text(const FrameSource& source) const {
  const link::Device::Snapshot end = source.snapshot();
  const double time = seconds();
  const auto rate = [&](std::uint64_t count, double unit) {
    return rounded(static_cast<double>(count) / unit / time, 2);
  };
  using Counters = link::BoardCounters;
  const auto counted = [&](std::uint32_t Counters::*counter) {
    return end.board.*counter - start_.board.*counter;
  };
  Table table;
  table.line("line", end.description.empty() ? end.trouble_text : end.description);
  table.line("time", rounded(time, 2), " s");
  const std::uint64_t bytes = end.decoder.bytes - start_.decoder.bytes;
  table.line("bytes", bytes, " from the board, ", rate(bytes, 1e6), " MB/s; ",
             end.transport.bytes_out - start_.transport.bytes_out, " to it; ",
             end.transport.stalls - start_.transport.stalls, " stalls of the link");
  for (const StreamName& each : kStreamNames) {
    if (!streams_.contains(each.stream)) continue;
    const std::uint64_t count = frames_[static_cast<std::size_t>(each.stream)];
    table.line(each.name, count, " frames, ", rate(count, 1), " f/s");
  }
  std::string causes;
  for (const auto& [verdict, name] : kCauses) {
    const auto found = dropped_.find(verdict);
    causes += fmt::format(", {} {}", found == dropped_.end() ? 0 : found->second, name);
  }
  table.line("dropped", counted(&Counters::frames_dropped), " by the board (link too slow)", causes,
             ", ", end.session.unknown_configurations - start_.session.unknown_configurations,
             " of an unknown configuration");
  table.line("packets", end.decoder.packets - start_.decoder.packets, " good, ",
             end.decoder.lost_packets - start_.decoder.lost_packets, " lost, ",
             end.decoder.bad_headers - start_.decoder.bad_headers, " bad headers, ",
             end.decoder.bad_payloads - start_.decoder.bad_payloads, " bad payloads, ",
             end.decoder.skipped_bytes - start_.decoder.skipped_bytes, " bytes skipped");
  if (end.times_opened == 0) return table.text();  // a recording

  if (!latencies_.empty()) {
    std::vector<double> sorted = latencies_;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double part) {
      const double index = part * static_cast<double>(sorted.size() - 1);
      return rounded(sorted[static_cast<std::size_t>(std::lround(index))], 2);
    };
    table.line("latency", "median ", at(0.5), " ms, 95 % ", at(0.95), " ms, 99 % ", at(0.99),
               " ms, largest ", at(1), " ms, from mid-exposure to the last byte here");
  }
  table.line("clock", "drift ", rounded(end.clock_drift * 1e6, 1), " ppm, stamps within ",
             rounded(end.clock_uncertainty * 1e3, 2), " ms");
  std::string steps;
  for (int i = 0; i < link::kNumWatchdogSteps; ++i) {
    const auto step = static_cast<link::WatchdogStep>(i);
    const auto index = static_cast<std::size_t>(i);
    steps += fmt::format("{} {}, ", link::name(step),
                         end.session.steps[index] - start_.session.steps[index]);
  }
  const auto requests = end.session.requests - start_.session.requests;
  const auto retries = end.session.retries - start_.session.retries;
  table.line("watchdog", steps, "opened ", end.times_opened, " times; ", requests, " requests, ",
             retries, " retries");
  table.line("board", counted(&Counters::bad_packets), " bad and ",
             counted(&Counters::lost_packets), " lost packets from the host; ",
             counted(&Counters::cut_frames), " cut and ", counted(&Counters::long_frames),
             " long frames from the cameras, ", counted(&Counters::buffer_errors),
             " rectification errors");
  return table.text();
}

}  // namespace fpga_stereo::tools
