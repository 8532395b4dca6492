# Directories that the build writes to and installs to, with and without catkin. Install directories
# are relative to the prefix.
if(FPGA_STEREO_ROS)
  set(FPGA_STEREO_LIB_DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(FPGA_STEREO_BUILD_BIN ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
  set(FPGA_STEREO_BUILD_CMAKE ${CATKIN_DEVEL_PREFIX}/share/fpga_stereo/cmake)
else()
  include(CTest)
  include(GNUInstallDirs)
  set(CATKIN_ENABLE_TESTING ${BUILD_TESTING})  # the one switch of a ROS build
  set(FPGA_STEREO_LIB_DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set(FPGA_STEREO_BUILD_BIN ${PROJECT_BINARY_DIR}/bin)
  set(FPGA_STEREO_BUILD_CMAKE ${PROJECT_BINARY_DIR}/cmake)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${FPGA_STEREO_BUILD_BIN})
  set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  if(BUILD_TESTING)
    add_custom_target(tests)  # builds every test program; catkin has the same
  endif()
endif()
# catkin uses the same three names. Program names such as `match` are too general for bin/.
set(FPGA_STEREO_INCLUDE_DESTINATION include)
set(FPGA_STEREO_BIN_DESTINATION lib/fpga_stereo)
set(FPGA_STEREO_SHARE_DESTINATION share/fpga_stereo)
