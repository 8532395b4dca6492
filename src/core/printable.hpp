// Makes text from outside the program safe to show.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fpga_stereo {

/// Returns `text` for a terminal, a log or an error message: printable characters of UTF-8 as they
/// are; control characters, marks that change the direction of writing, and bytes that are not
/// UTF-8 as \xNN. A result longer than `max_bytes` is cut off and ends with "...".
std::string printable(std::string_view text, std::size_t max_bytes = 80);

}  // namespace fpga_stereo
