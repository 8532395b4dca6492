# Functions that set up this project's targets.

# fpga_stereo_target(TARGET): sets language, warnings and sanitizers.
function(fpga_stereo_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor)
  if(FPGA_STEREO_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(FPGA_STEREO_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage -O0 -fprofile-update=atomic)
    target_link_options(${target} PUBLIC --coverage)
  endif()
  if(FPGA_STEREO_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${FPGA_STEREO_SANITIZE} -fno-omit-frame-pointer)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      # It gives false warnings about std::regex when sanitizers are on.
      target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${FPGA_STEREO_SANITIZE})
  endif()
endfunction()

# fpga_stereo_use_ros(TARGET): lets the target include the headers of ROS and those that this package
# generates. They are SYSTEM: the compiler does not warn about them.
function(fpga_stereo_use_ros target)
  target_include_directories(${target} SYSTEM PUBLIC
    ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_INCLUDE_DESTINATION} ${catkin_INCLUDE_DIRS})
  add_dependencies(${target} ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
endfunction()

# fpga_stereo_ros_target(TARGET): as fpga_stereo_target(), for targets that use ROS.
function(fpga_stereo_ros_target target)
  fpga_stereo_target(${target})
  fpga_stereo_use_ros(${target})
endfunction()

# fpga_stereo_layer(TARGET LAYER): gives the target an include path with only the headers of its
# layer, so that a file that includes a header of a higher layer does not compile. The folder has two
# symbolic links: fpga_stereo/LAYER to the public headers and LAYER to the internal ones.
function(fpga_stereo_layer target layer)
  set(folder ${PROJECT_BINARY_DIR}/layers/${layer})
  file(MAKE_DIRECTORY ${folder}/fpga_stereo)
  if(EXISTS ${PROJECT_SOURCE_DIR}/include/fpga_stereo/${layer})
    execute_process(COMMAND ${CMAKE_COMMAND} -E create_symlink
      ${PROJECT_SOURCE_DIR}/include/fpga_stereo/${layer} ${folder}/fpga_stereo/${layer})
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -E create_symlink
    ${PROJECT_SOURCE_DIR}/src/${layer} ${folder}/${layer})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${folder}> $<INSTALL_INTERFACE:include>)
endfunction()
