# Tests of the gateware's end of the link: its modules, and the whole gateware (fs_system).
fpga_stereo_models(rtl_system_models)
fpga_stereo_verilate(Crc8 fs_crc32c Bits=8 LIBRARY=rtl_system_models)
fpga_stereo_verilate(Crc32 fs_crc32c Bits=32 LIBRARY=rtl_system_models)
fpga_stereo_verilate(PacketFinder fs_packet_finder LIBRARY=rtl_system_models)
fpga_stereo_verilate(InputSelect fs_input_select SilenceMs=3 LIBRARY=rtl_system_models)
fpga_stereo_verilate(Heartbeat fs_heartbeat LIBRARY=rtl_system_models)
fpga_stereo_verilate(Time fs_time ClockHz=3333333 LIBRARY=rtl_system_models)

# The clock is 0.1 MHz, so that HeartbeatMs and HostTimeoutMs take few clocks.
fpga_stereo_model(rtl_model_system 64 16 11 15 0 10 80 100000 126 4)

fpga_stereo_gtest(rtl_system_test
  link_modules_test.cpp
  packet_finder_test.cpp
  system_frames_test.cpp
  system_input_test.cpp
  system_test.cpp
  ../link/faults.cpp
)
target_compile_definitions(rtl_system_test PRIVATE FPGA_STEREO_MODELS="${models}")
target_include_directories(rtl_system_test SYSTEM PRIVATE
  $<TARGET_PROPERTY:rtl_system_models,INTERFACE_INCLUDE_DIRECTORIES>)
target_link_libraries(rtl_system_test
  rtl_system_models fpga_stereo_link fpga_stereo_simulated_gateware fpga_stereo_test_support)
add_dependencies(rtl_system_test rtl_model_system)
