// Included into every file of a model: what Verilator's library would print goes to
// model_print.cpp.
#pragma once

int fs_print(const char* format, ...);
#define VL_PRINTF fs_print
