# Finds google/highway for the SIMD pipeline: the distribution's libhwy, or on request a pinned
# release from GitHub. Without either, switches FPGA_STEREO_SIMD off and warns.
option(FPGA_STEREO_FETCH_HIGHWAY
  "Download google/highway when libhwy is not installed; configuring fails if that fails" OFF)

pkg_check_modules(HIGHWAY IMPORTED_TARGET libhwy>=1.0.3)
if(NOT HIGHWAY_FOUND AND FPGA_STEREO_FETCH_HIGHWAY)
  include(FetchContent)
  set(HWY_ENABLE_CONTRIB OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_EXAMPLES OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_INSTALL OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_TESTS OFF CACHE BOOL "" FORCE)
  set(HWY_FORCE_STATIC_LIBS ON CACHE BOOL "" FORCE)
  FetchContent_Declare(highway
    GIT_REPOSITORY https://github.com/google/highway.git
    GIT_TAG 58746ca5b9f9444a2a3549704602ecc6239f8f41)  # 1.0.3
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
