// Redirects the output of Verilator's library to model_print.cpp. Included into every file of a
// model.
#pragma once

int fs_print(const char* format, ...);
#define VL_PRINTF fs_print
