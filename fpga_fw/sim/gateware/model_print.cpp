// Captures the output of a model. Compiled once for each model.
#include "model_print.hpp"

#include <cstdarg>
#include <cstdio>

#include "model_base.hpp"

int fs_print(const char* format, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  fpga_stereo::sim::printed += text;
  return length;
}

double sc_time_stamp() { return 0; }

/// Identifies the sources: build_model does not build an object with this text again.
extern "C" __attribute__((visibility("default"), used)) const char fs_sources[] = FS_SOURCES;
