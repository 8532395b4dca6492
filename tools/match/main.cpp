// match LEFT RIGHT OUT: computes the disparity of a pair of image files.
#include <iomanip>
#include <iostream>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/target.hpp"
#include "support/parameter_options.hpp"
#include "support/program.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

CommandLine command_line() {
  CommandLine line = job_command_line("match", "Computes the disparity of a stereo pair.\n");
  add_threads_option(line.options);
  line.options.add_options()("verbose", po::bool_switch(),
                             "print times, and the quality and needs of rectification, to stderr");
  line.options.add(parameter_options());
  return line;
}

/// Prints the times of the stages that ran.
void print_times(const StageTimes& ms) {
  double total = 0;
  std::cerr << std::fixed << std::setprecision(2);
  for (std::size_t stage = 0; stage < ms.size(); ++stage) {
    const bool ran = ms[stage] > 0;
    if (!ran) continue;
    std::cerr << std::left << std::setw(10) << kStageNames[stage] << std::right << std::setw(10)
              << ms[stage] << " ms\n";
    total += ms[stage];
  }
  std::cerr << std::left << std::setw(10) << "total" << std::right << std::setw(10) << total
            << " ms\n";
}

void match(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const int num_threads = threads(parsed->options);
  const StereoJob job = read_job(*parsed);

  Pipeline pipeline;
  const DisparityFrame& frame =
      pipeline.process(job.left, job.right, job.rectification, job.parameters, num_threads);
  write_result(job, frame.disparity);
  if (parsed->options["verbose"].as<bool>()) {
    print_rectification(job.rectification);
    std::cerr << "computed with " << target() << "\n";
    print_times(frame.ms);
  }
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("match", argc, argv, fpga_stereo::tools::match);
}
