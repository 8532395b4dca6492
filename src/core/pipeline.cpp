#include "fpga_stereo/core/pipeline.hpp"

#include <fmt/format.h>

#include "core/bands.hpp"
#include "core/reference_pipeline.hpp"
#include "core/stages.hpp"
#include "fpga_stereo/core/target.hpp"
#ifdef FPGA_STEREO_SIMD
#include "core/simd/pipeline.hpp"
#endif

namespace fpga_stereo {

Status validate_image(const cv::Mat& raw, const StereoRectification& rectification,
                      const std::string& camera) {
  const cv::Size expected = rectification.geometry.image_size;
  if (raw.size() != expected) {
    return Error{ErrorKind::kImageSize,
                 fmt::format("{} image is {}x{}: its camera_info says {}x{}", camera, raw.cols,
                             raw.rows, expected.width, expected.height)};
  }
  if (raw.empty() || raw.cols > kMaxWidth || raw.rows > kMaxHeight) {
    return Error{ErrorKind::kImageSize,
                 fmt::format("{} image is {}x{}: allowed 1x1 to {}x{}", camera, raw.cols, raw.rows,
                             kMaxWidth, kMaxHeight)};
  }
  return {};
}

void rectify_image(const cv::Mat& raw, const Mesh& mesh, int num_threads, cv::Mat& rectified) {
  CV_Assert(raw.type() == CV_8UC1 || raw.type() == CV_8UC3);
  rectified.create(mesh.size, raw.type());
  const bool scalar = target() == kScalarTarget;
  for_each_band(mesh.size.height, num_threads, [&](int, cv::Range rows) {
    if (scalar) return rectify(raw, mesh, rows, rectified);
#ifdef FPGA_STEREO_SIMD
    simd::rectify(raw, mesh, rows, rectified);
#endif
  });
}

struct Pipeline::Implementation {
  ReferencePipeline reference;
#ifdef FPGA_STEREO_SIMD
  simd::Pipeline simd;
#endif
};

Pipeline::Pipeline() : implementation_(std::make_unique<Implementation>()) {}
Pipeline::~Pipeline() = default;

const DisparityFrame& Pipeline::process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                                        const StereoRectification& rectification,
                                        const Parameters& parameters, int num_threads) {
#ifdef FPGA_STEREO_SIMD
  if (target() != kScalarTarget) {
    implementation_->simd.process(left_raw, right_raw, rectification, parameters, num_threads,
                                  frame_);
    return frame_;
  }
#endif
  const Taps& taps = implementation_->reference.process(left_raw, right_raw, rectification,
                                                        parameters, num_threads);
  frame_ = {taps.left, taps.right, taps.disparity, taps.ms};
  return frame_;
}

}  // namespace fpga_stereo
