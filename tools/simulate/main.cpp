// simulate LEFT RIGHT OUT: computes the same as match, in the simulated gateware.
#include <fmt/format.h>

#include <chrono>
#include <iomanip>
#include <iostream>

#include "sim/gateware/gateware.hpp"
#include "support/files.hpp"
#include "support/models.hpp"
#include "support/parameter_options.hpp"
#include "support/program.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

CommandLine command_line() {
  CommandLine line =
      job_command_line("simulate",
                       "Computes the disparity of a stereo pair like match, but in the simulated "
                       "gateware, clock by\n"
                       "clock. The first use of a set of parameters builds a gateware for them: "
                       "this takes a minute\n"
                       "or two and needs verilator. The result is kept in the folder --models. "
                       "The gateware has window\n"
                       "matching only, so this is the default here, and sgm and dense are "
                       "refused.\n");
  line.options.add_options()(
      "vcd", po::value<std::string>()->value_name("FILE"),
      "write all signals of the gateware to a VCD file, for gtkwave; the file is large");
  line.options.add_options()(
      "cycles", po::bool_switch(),
      "send the pair three times; print latency, clocks per frame, simulation "
      "speed and the use of line buffer and mesh memory");
  line.options.add_options()("models", po::value<std::string>()->value_name("DIR"),
                             "folder of built gateware [default $XDG_CACHE_HOME/fpga_stereo or "
                             "~/.cache/fpga_stereo]");
  line.options.add_options()(
      "line-rows", po::value<int>()->value_name("N"),
      fmt::format("rows of the line buffer of rectify [4 to 254 in steps of 2; default {}, wider "
                  "than 640 px {}]",
                  default_line_rows(0), default_line_rows(kGatewareMaxWidth))
          .c_str());
  add_threads_option(line.options);
  line.options.add_options()("verbose", po::bool_switch(),
                             "print the quality and needs of rectification to stderr");
  line.options.add(parameter_options(window_parameters()));
  return line;
}

int line_rows(const po::variables_map& options) {
  if (options.count("line-rows") == 0) return 0;
  const int rows = options["line-rows"].as<int>();
  if (rows < 4 || rows > 254 || rows % 2 != 0) {
    throw UsageError(fmt::format("--line-rows = {}: allowed 4 to 254 in steps of 2", rows));
  }
  return rows;
}

struct Run {
  std::vector<sim::Frame> frames;
  double clocks_per_second = 0;
};

Run run(sim::Gateware& gateware, const StereoJob& job, int copies) {
  const std::vector<sim::GreyPair> frames(copies, {job.left, job.right});
  const std::int64_t clocks = gateware.clocks();
  const auto start = std::chrono::steady_clock::now();
  const auto results = gateware.process(frames);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  require(results);
  for (const sim::Frame& frame : *results) {
    if (frame.bad) {
      throw std::runtime_error(
          fmt::format("the gateware marks its result as invalid: register ERRORS is {}",
                      gateware.read(spec::kRegErrors)));
    }
  }
  return {*results, static_cast<double>(gateware.clocks() - clocks) / time.count()};
}

void print_cycles(const Run& run, const GatewareBuild& build, const StereoJob& job) {
  const cv::Size size = job.left.size();
  const sim::Frame& first = run.frames.front();
  const std::int64_t latency = first.first_out - first.first_in;
  const std::int64_t period = run.frames[2].first_out - run.frames[1].first_out;
  const std::int64_t start = read_start(job.rectification);
  const auto line = [](const char* name) -> std::ostream& {
    return std::cout << std::left << std::setw(18) << name << std::right;
  };
  std::cout << std::fixed << std::setprecision(2);
  line("latency") << latency << " clocks = " << static_cast<double>(latency) / size.width
                  << " lines, first pixel in to first disparity out; " << start
                  << " of them for rectify's read start\n";
  line("clocks per frame") << period << ", for " << size.area() << " pixels and "
                           << period - size.area() << " of gap between frames\n";
  line("simulated") << std::setprecision(0) << run.clocks_per_second << " clocks per second\n";
  line("build") << "width " << build.max_width << ", " << build.disparities << " disparities, "
                << to_text(build.census_pattern) << " census " << build.census_window
                << ", correlation " << build.correlation_window << "\n";
  const auto kbit = [](int bits) { return fmt::format("{} kbit", bits / 1024); };
  constexpr int kCameras = 2, kCoordinates = 2;
  line("line buffer") << fpga_stereo::line_rows(job.rectification) << " of " << build.line_rows
                      << " rows needed; "
                      << kbit(kCameras * build.line_rows * build.max_width * kPixelBits) << "\n";
  line("mesh") << Mesh::node_count(size).area() << " of " << build.mesh_nodes << " nodes needed; "
               << kbit(kCameras * build.mesh_nodes * kCoordinates * kMeshBits) << "\n";
}

void simulate(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const int num_threads = threads(options);
  const int rows = line_rows(options);
  const bool cycles = options["cycles"].as<bool>();
  const std::string vcd = options.count("vcd") != 0 ? options["vcd"].as<std::string>() : "";
  const std::string folder =
      options.count("models") != 0 ? options["models"].as<std::string>() : default_models_folder();
  const StereoJob job = read_job(*parsed, window_parameters());
  if (options["verbose"].as<bool>()) print_rectification(job.rectification);

  const GatewareBuild build = smallest_build(job, rows);
  require(check_build(build, job.parameters, job.rectification));
  create_folder(folder);
  auto opened = sim::Gateware::open(require_model(build, !vcd.empty(), folder, num_threads));
  require(opened);
  sim::Gateware gateware = std::move(*opened);
  if (!vcd.empty()) require(gateware.open_trace(vcd));
  require(gateware.apply(job.parameters, job.rectification));
  constexpr int kCopies = 3;  // until the interval between frames is steady
  const Run result = run(gateware, job, cycles ? kCopies : 1);
  write_result(job, result.frames.front().disparity);
  if (cycles) print_cycles(result, gateware.build(), job);
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("simulate", argc, argv, fpga_stereo::tools::simulate);
}
