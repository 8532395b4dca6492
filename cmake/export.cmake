# What other projects use: the CMake targets fpga_stereo::core and fpga_stereo::link, found by
# find_package(fpga_stereo), and their headers. catkin_package() writes the package configuration of
# a ROS build, which includes fpga_stereo-extras.cmake; without ROS that file is the configuration.
set(cmake_destination ${FPGA_STEREO_SHARE_DESTINATION}/cmake)

add_library(fpga_stereo::core ALIAS fpga_stereo_core)
add_library(fpga_stereo::link ALIAS fpga_stereo_link)
# Minor versions may change the binary interface.
set(versioned fpga_stereo_core fpga_stereo_link)
if(FPGA_STEREO_ROS)
  list(APPEND versioned fpga_stereo_conversions)
endif()
set_target_properties(${versioned} PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set_target_properties(fpga_stereo_core PROPERTIES EXPORT_NAME core)
set_target_properties(fpga_stereo_link PROPERTIES EXPORT_NAME link)
install(TARGETS fpga_stereo_core fpga_stereo_link EXPORT fpga_stereo
  ARCHIVE DESTINATION ${FPGA_STEREO_LIB_DESTINATION}
  LIBRARY DESTINATION ${FPGA_STEREO_LIB_DESTINATION}
  RUNTIME DESTINATION bin
)
install(EXPORT fpga_stereo NAMESPACE fpga_stereo:: FILE fpga_stereoTargets.cmake
  DESTINATION ${cmake_destination})
export(EXPORT fpga_stereo NAMESPACE fpga_stereo::
  FILE ${FPGA_STEREO_BUILD_CMAKE}/fpga_stereoTargets.cmake)

set(version_header ${PROJECT_BINARY_DIR}/layers/core/fpga_stereo/version.hpp)
configure_file(include/fpga_stereo/version.hpp.in ${version_header} @ONLY)
install(DIRECTORY include/fpga_stereo
  DESTINATION ${FPGA_STEREO_INCLUDE_DESTINATION} FILES_MATCHING PATTERN *.hpp)
install(FILES ${version_header}
  DESTINATION ${FPGA_STEREO_INCLUDE_DESTINATION}/fpga_stereo)

if(NOT FPGA_STEREO_ROS)
  include(CMakePackageConfigHelpers)
  configure_file(cmake/fpga_stereo-extras.cmake.in
    ${FPGA_STEREO_BUILD_CMAKE}/fpga_stereoConfig.cmake @ONLY)
  write_basic_package_version_file(${FPGA_STEREO_BUILD_CMAKE}/fpga_stereoConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  #catkin_lint: ignore_once missing_file
  install(FILES
    ${FPGA_STEREO_BUILD_CMAKE}/fpga_stereoConfig.cmake
    ${FPGA_STEREO_BUILD_CMAKE}/fpga_stereoConfigVersion.cmake
    DESTINATION ${cmake_destination})
endif()
