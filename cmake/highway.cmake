# google/highway, for the SIMD kernels: the distribution's, else (Ubuntu 20.04 has none) a pinned
# release. Sets HIGHWAY_INCLUDE_DIRS and HIGHWAY_LIBRARIES, or switches FPGA_STEREO_SIMD off and says
# so: the scalar pipeline gives the same bits, more slowly.
pkg_check_modules(HIGHWAY libhwy>=1.0.3)
if(NOT HIGHWAY_FOUND AND NOT CMAKE_VERSION VERSION_LESS 3.14)
  message(STATUS "libhwy 1.0.3 or newer is not installed: fetching google/highway 1.0.3")
  include(FetchContent)
  set(HWY_ENABLE_CONTRIB OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_EXAMPLES OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_INSTALL OFF CACHE BOOL "" FORCE)
  set(HWY_ENABLE_TESTS OFF CACHE BOOL "" FORCE)
  set(HWY_FORCE_STATIC_LIBS ON CACHE BOOL "" FORCE)
  FetchContent_Declare(highway
    GIT_REPOSITORY https://github.com/google/highway.git GIT_TAG 1.0.3 GIT_SHALLOW ON)
  # A robot may be offline: that is no reason not to build.
  execute_process(COMMAND git ls-remote --exit-code https://github.com/google/highway.git 1.0.3
    RESULT_VARIABLE unreachable OUTPUT_QUIET ERROR_QUIET TIMEOUT 20)
  if(unreachable EQUAL 0)
    FetchContent_MakeAvailable(highway)
    set(HIGHWAY_FOUND TRUE)
    set(HIGHWAY_INCLUDE_DIRS ${highway_SOURCE_DIR})
    set(HIGHWAY_LIBRARIES hwy)
  endif()
else()
  set(HIGHWAY_LIBRARIES ${HIGHWAY_LDFLAGS})
  set(HIGHWAY_DEFINITIONS HWY_SHARED_DEFINE)
endif()
if(NOT HIGHWAY_FOUND)
  message(WARNING "google/highway is neither installed nor to be fetched: the pipeline is built "
    "without SIMD, and is slow. Install libhwy-dev, or build with access to github.com.")
  set(FPGA_STEREO_SIMD OFF)
endif()
