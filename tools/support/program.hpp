// Shared by the command-line programs: exit codes, command lines, progress messages.
#pragma once

#include <boost/program_options.hpp>
#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

enum ExitCode { kSuccess = 0, kFailure = 1, kWrongUsage = 2 };

/// A wrong command line: exit code 2. Every other exception gives exit code 1.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws std::runtime_error with `prefix` and the message of a failed Result or Status.
template <class Outcome>
void require(const Outcome& outcome, const std::string& prefix = "") {
  if (!outcome) throw std::runtime_error(prefix + outcome.error().message);
}

using Arguments = std::vector<std::string>;

/// Returns the text quoted as one word for a shell.
std::string shell_quoted(const std::string& text);

/// The body of main(). Calls `body` with the arguments after the program name. Turns exceptions
/// into "name: message" on stderr and returns the exit code.
int run_program(const std::string& name, int argc, char** argv,
                const std::function<void(const Arguments&)>& body);

/// The command line of a program or of one of its modes.
struct CommandLine {
  std::string usage;                    // first lines of --help
  std::vector<std::string> positional;  // names of the positional arguments, all required
  std::string rest;                     // name of the optional ones after them; empty: none
  bool takes_files = false;             // positional arguments may be paths
  /// Recognises an optional argument before the positional ones, which may also be given as
  /// --device. Null: there is none.
  bool (*is_device)(const std::string&) = nullptr;
  boost::program_options::options_description options{"Options"};
  std::string notes;  // last lines of --help
};

/// Returns how options spell the name of a parameter: "disparity-range" for disparity_range,
/// "disp12-max-diff" for disp12MaxDiff.
std::string option_name(const std::string& name);

/// True if the argument asks for help: -h or --help.
bool is_help(const std::string& argument);

struct Parsed {
  boost::program_options::variables_map options;
  std::string device;  // empty: not given
  std::vector<std::string> positional;
};

/// Parses the arguments. Accepts options in the spelling of parameters, --disparity_range, too.
/// Returns nullopt after printing what -h, --help or --version asks for. Throws UsageError.
std::optional<Parsed> parse(const CommandLine& line, const Arguments& arguments);

/// Prints the versions of package, link protocol and gateware.
void print_version();

/// Option --threads; the default is the number of processors.
void add_threads_option(boost::program_options::options_description& options);
int threads(const boost::program_options::variables_map& options);

/// Throws UsageError with option, value and range unless `value` is between `min` and `max`.
void require_range(const std::string& option, double value, double min, double max);

/// Reports the progress of long work on stderr: at most one line per second.
class Progress {
 public:
  Progress(std::string program, std::size_t total);
  /// Counts an item as done.
  void done(const std::string& item);

 private:
  std::string program_;
  std::size_t total_;
  std::size_t count_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace fpga_stereo::tools
