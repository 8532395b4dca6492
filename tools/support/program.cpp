#include "support/program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "fpga_stereo/core/target.hpp"
#include "fpga_stereo/version.hpp"

namespace fpga_stereo::tools {

namespace po = boost::program_options;

std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

int run_program(const std::string& name, int argc, char** argv,
                const std::function<void(const Arguments&)>& body) {
  try {
    if (const Status known = check_target_variable(); !known) {
      throw UsageError(known.error().message);
    }
    body(Arguments(argv + 1, argv + argc));
    std::cout.flush();
    if (!std::cout) throw std::runtime_error("cannot write to standard output");
    return kSuccess;
  } catch (const UsageError& e) {
    std::cerr << name << ": " << e.what() << "; see --help\n";
    return kWrongUsage;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << "\n";
    return kFailure;
  }
}

namespace {

/// Spells options as option_name() does, up to the argument "--".
Arguments with_option_names(Arguments arguments) {
  for (std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.rfind("--", 0) != 0) continue;
    const std::size_t end = std::min(argument.find('='), argument.size());
    argument = "--" + option_name(argument.substr(2, end - 2)) + argument.substr(end);
  }
  return arguments;
}

/// Moves the device from the positional arguments or --device to its place.
void take_device(const CommandLine& line, Parsed& parsed) {
  if (line.is_device == nullptr) return;
  auto& positional = parsed.positional;
  if (parsed.options.count("device") != 0)
    parsed.device = parsed.options["device"].as<std::string>();
  if (positional.empty() || !line.is_device(positional[0])) return;
  if (!parsed.device.empty()) {
    throw UsageError(fmt::format("two devices are given: \"{}\" and --device \"{}\"", positional[0],
                                 parsed.device));
  }
  parsed.device = positional[0];
  positional.erase(positional.begin());
}

}  // namespace

std::string option_name(const std::string& name) {
  std::string option;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0) {
      option += '-';
      option += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else {
      option += c == '_' ? '-' : c;
    }
  }
  return option;
}

bool is_help(const std::string& argument) { return argument == "-h" || argument == "--help"; }

std::optional<Parsed> parse(const CommandLine& line, const Arguments& arguments) {
  constexpr const char* kPositional = "positional-arguments";
  po::options_description visible = line.options;
  visible.add_options()("help,h", "print this help and exit")("version", "print versions and exit");
  po::options_description all;
  all.add(visible).add_options()(kPositional, po::value<std::vector<std::string>>());
  po::positional_options_description positions;
  positions.add(kPositional, -1);

  Parsed parsed;
  // No abbreviations: their meaning would change when an option is added.
  const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
  try {
    po::store(po::command_line_parser(with_option_names(arguments))
                  .options(all)
                  .positional(positions)
                  .style(style)
                  .run(),
              parsed.options);
    if (parsed.options.count("help") != 0) {
      std::cout << line.usage << "\n" << visible << line.notes;
      return std::nullopt;
    }
    if (parsed.options.count("version") != 0) {
      print_version();
      return std::nullopt;
    }
    po::notify(parsed.options);
  } catch (const po::error& e) {
    throw UsageError(e.what());
  }
  if (parsed.options.count(kPositional) != 0) {
    parsed.positional = parsed.options[kPositional].as<std::vector<std::string>>();
  }
  take_device(line, parsed);
  if (parsed.positional.size() < line.positional.size()) {
    throw UsageError(fmt::format("{} is missing", line.positional[parsed.positional.size()]));
  }
  if (line.rest.empty() && parsed.positional.size() > line.positional.size()) {
    throw UsageError(fmt::format("argument \"{}\" is one too many: {} are allowed",
                                 parsed.positional[line.positional.size()],
                                 line.positional.size()));
  }
  return parsed;
}

void print_version() {
  std::cout << fmt::format("fpga_stereo {}, link protocol {}, gateware {}.{}\n", kPackageVersion,
                           kProtocolVersion, kGatewareVersionMajor, kGatewareVersionMinor);
}

void add_threads_option(po::options_description& options) {
  options.add_options()("threads",
                        po::value<int>()->value_name("N")->default_value(cv::getNumberOfCPUs()),
                        "number of threads [1 to 256]; the result does not depend on it");
}

int threads(const po::variables_map& options) {
  const int count = options["threads"].as<int>();
  require_range("--threads", count, 1, 256);
  return count;
}

void require_range(const std::string& option, double value, double min, double max) {
  if (value >= min && value <= max) return;  // false for NaN
  throw UsageError(fmt::format("{} = {:g}: allowed {:g} to {:g}", option, value, min, max));
}

Progress::Progress(std::string program, std::size_t total)
    : program_(std::move(program)), total_(total) {}

void Progress::done(const std::string& item) {
  ++count_;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::seconds(1)) return;
  last_ = now;
  std::cerr << fmt::format("{}: {} of {}: {}", program_, count_, total_, item) << std::endl;
}

}  // namespace fpga_stereo::tools
