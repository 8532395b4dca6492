// Included into every file of a model: what Verilator's library would print goes to model.cpp.
#pragma once

int fs_top_print(const char* format, ...);
#define VL_PRINTF fs_top_print
