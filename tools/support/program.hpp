// What the command-line programs share: exit codes, messages, options, progress.
#pragma once

#include <boost/program_options.hpp>
#include <chrono>
#include <functional>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

enum ExitCode { kSuccess = 0, kFailure = 1, kWrongUsage = 2 };

/// What was asked for cannot be done: exit code 2. Every other exception gives exit code 1.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The parts as one text.
template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Throws what a core function refused, as a failure.
template <class Outcome>
void require(const Outcome& outcome, const std::string& prefix = "") {
  if (!outcome) throw std::runtime_error(prefix + outcome.error().message);
}

using Arguments = std::vector<std::string>;

/// The text as one word for a shell.
std::string shell_quoted(const std::string& text);

/// The body of main(): calls `body` with the arguments but for the program's name and turns
/// exceptions into "name: message" on stderr and an exit code.
int run_program(const std::string& name, int argc, char** argv,
                const std::function<void(const Arguments&)>& body);

/// What a program, or one of its modes, takes.
struct CommandLine {
  std::string usage;                    // first lines of --help
  std::vector<std::string> positional;  // names of the arguments without a name, all required
  std::string rest;                     // name of any number of further ones; empty: none
  boost::program_options::options_description options{"Options"};
  std::string notes;  // last lines of --help
};

struct Parsed {
  boost::program_options::variables_map options;
  std::vector<std::string> positional;
};

/// Nothing if --help was asked for, which is then printed. Throws UsageError.
std::optional<Parsed> parse(const CommandLine& line, const Arguments& arguments);

/// --threads: how many, by default as many as the machine has.
void add_threads_option(boost::program_options::options_description& options);
int threads(const boost::program_options::variables_map& options);

/// Throws UsageError with the option's name, its value and what is allowed if `value` is not
/// between `min` and `max`.
void require_range(const std::string& option, double value, double min, double max);

/// Says on stderr how far long work has come: a line for an item whenever a second has passed.
class Progress {
 public:
  Progress(std::string program, std::size_t total);
  void done(const std::string& item);

 private:
  std::string program_;
  std::size_t total_;
  std::size_t count_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace fpga_stereo::tools
