# Tests of the whole pipeline (fs_top). build_model builds its models as shared objects, together
# with the tests.
set(sim ${PROJECT_SOURCE_DIR}/fpga_fw/sim/gateware)
set(models ${PROJECT_BINARY_DIR}/models)
file(GLOB model_sources ${rtl}/*.sv ${sim}/model* ${sim}/build_model)
file(GLOB link_sources ${rtl}/link/*.sv)

# fpga_stereo_model(TARGET MAX_WIDTH ... [--trace])
# Builds a model with the arguments of build_model: seven numbers for fs_top, ten for fs_system.
function(fpga_stereo_model target)
  set(top fs_top)
  set(sources ${model_sources})
  if(ARGC GREATER 10)
    set(top fs_system)
    list(APPEND sources ${link_sources})
  endif()
  string(REPLACE ";" "_" name "${top}_${ARGN}")
  string(REPLACE "--" "" name ${name})
  add_custom_command(
    OUTPUT ${models}/${name}.so
    COMMAND ${sim}/build_model ${ARGN} ${models}
    DEPENDS ${sources}
    COMMENT "Building the simulated gateware ${name}"
  )
  add_custom_target(${target} DEPENDS ${models}/${name}.so)
endfunction()

fpga_stereo_model(rtl_model_sparse 640 16 11 15 0 102 5120)
fpga_stereo_model(rtl_model_trace 640 16 5 5 0 102 5120 --trace)
fpga_stereo_model(rtl_model_full 640 20 11 15 1 102 5120)
fpga_stereo_model(rtl_model_other 752 32 11 5 0 104 6144)

# fpga_stereo_top_test(TARGET TIMEOUT SOURCE MODELS...), TIMEOUT in seconds
function(fpga_stereo_top_test target timeout source)
  fpga_stereo_gtest(${target} ${source})
  target_compile_definitions(${target} PRIVATE FPGA_STEREO_MODELS="${models}")
  target_link_libraries(${target} fpga_stereo_simulated_gateware fpga_stereo_test_support)
  if(ARGN)
    add_dependencies(${target} ${ARGN})
  endif()
  set_tests_properties(${gtest_prefix}${target} PROPERTIES TIMEOUT ${timeout})
endfunction()

fpga_stereo_top_test(rtl_top_test 300 top_test.cpp
  rtl_model_sparse rtl_model_full rtl_model_other)

# VGA with 64 disparities: a long test. A test fixture builds its model when ctest runs it.
fpga_stereo_top_test(rtl_vga 600 top_vga_test.cpp)
add_test(NAME rtl_vga_model COMMAND ${sim}/build_model 640 64 11 15 0 102 5120 ${models})
set_tests_properties(rtl_vga_model PROPERTIES
  LABELS long TIMEOUT 1200 FIXTURES_SETUP rtl_vga_model)
set_tests_properties(${gtest_prefix}rtl_vga PROPERTIES
  LABELS long FIXTURES_REQUIRED rtl_vga_model)
