#include "support/parameter_options.hpp"

#include <fmt/format.h>

#include "support/program.hpp"

namespace fpga_stereo::tools {

namespace po = boost::program_options;

po::options_description parameter_options(const Parameters& defaults) {
  po::options_description options("Parameters of the pipeline");
  for (const ParameterInfo& info : parameter_table()) {
    const std::string unit = info.unit.empty() ? "" : " " + info.unit;
    const std::string about = fmt::format("{} [{}{}; default {}]", info.about, allowed_values(info),
                                          unit, to_text(defaults, info));
    options.add_options()(option_name(info.name).c_str(),
                          po::value<std::string>()->value_name("value"), about.c_str());
  }
  return options;
}

Parameters parameters_from(const po::variables_map& options, Parameters defaults) {
  for (const ParameterInfo& info : parameter_table()) {
    const std::string option = option_name(info.name);
    if (options.count(option) == 0) continue;
    const Status status = set_parameter(defaults, info.name, options[option].as<std::string>());
    if (status) continue;
    throw UsageError("--" + option + status.error().message.substr(info.name.size()));
  }
  return defaults;
}

}  // namespace fpga_stereo::tools
