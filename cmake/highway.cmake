# Finds google/highway for the SIMD pipeline: the distribution's libhwy, or on request a pinned
# release from GitHub. Without either, switches FPGA_STEREO_SIMD off and warns.
option(FPGA_STEREO_FETCH_HIGHWAY
  "Download google/highway when libhwy is not installed or too old; configuring fails if that fails" OFF)

set(highway_version 1.0.3)  # at least
set(highway_commit 58746ca5b9f9444a2a3549704602ecc6239f8f41)  # 1.0.3
set(is_arm64 FALSE)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  set(is_arm64 TRUE)
endif()
if(is_arm64 AND FPGA_STEREO_FETCH_HIGHWAY)
  # Before 1.0.4, NEON is only for processors with AES, which the Raspberry Pi 4 does not have.
  set(highway_version 1.0.4)
  set(highway_commit 457c891775a7397bdb0376bb1031e6e027af1c48)  # 1.2.0
endif()

pkg_check_modules(HIGHWAY IMPORTED_TARGET libhwy>=${highway_version})
if(HIGHWAY_FOUND AND HIGHWAY_VERSION VERSION_LESS 1.0.4 AND is_arm64)
  message(STATUS "libhwy ${HIGHWAY_VERSION} supports only arm64 processors with AES: others, such as that "
    "of the Raspberry Pi 4, will run the scalar reference, 20 times more slowly. Configure with "
    "-DFPGA_STEREO_FETCH_HIGHWAY=ON for them.")
endif()
if(NOT HIGHWAY_FOUND AND FPGA_STEREO_FETCH_HIGHWAY)
  include(FetchContent)
  set(HWY_ENABLE_CONTRIB OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_EXAMPLES OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_INSTALL OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_TESTS OFF CACHE BOOL "" FORCE)
  set(HWY_FORCE_STATIC_LIBS ON CACHE BOOL "" FORCE)
  FetchContent_Declare(highway
    GIT_REPOSITORY https://github.com/google/highway.git
    GIT_TAG ${highway_commit})
  FetchContent_MakeAvailable(highway)
elseif(NOT HIGHWAY_FOUND)
  message(WARNING "libhwy 1.0.3 or newer is not installed: building without SIMD, which gives the "
    "same bits 20 times more slowly. Install libhwy-dev, or configure with "
    "-DFPGA_STEREO_FETCH_HIGHWAY=ON to download google/highway.")
  set(FPGA_STEREO_SIMD OFF)
endif()

# fpga_stereo_use_highway(TARGET): compiles and links the target with google/highway.
function(fpga_stereo_use_highway target)
  if(HIGHWAY_FOUND)
    target_link_libraries(${target} PRIVATE PkgConfig::HIGHWAY)
  else()
    # Takes in the objects, so that users of a static library need no further one.
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:hwy>)
    target_include_directories(${target} SYSTEM PRIVATE ${highway_SOURCE_DIR})
  endif()
endfunction()
