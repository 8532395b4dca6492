// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::spec {

const std::vector<Register>& register_table() {
  // clang-format off
  static const std::vector<Register> table{
      {"IDENTITY", kRegIdentity, Access::kReadOnly, kRegIdentityReset,
       "\"FST1\", with F in the top byte", {
       }},
      {"SPEC_HASH", kRegSpecHash, Access::kReadOnly, kRegSpecHashReset,
       "hash of the specification that the gateware was built from", {
       }},
      {"VERSION", kRegVersion, Access::kReadOnly, kRegVersionReset,
       "version of protocol and gateware", {
           {"major", kVersionMajor, "", "incompatible changes"},
           {"minor", kVersionMinor, "", "compatible changes"},
       }},
      {"BUILD", kRegBuild, Access::kReadOnly, {},
       "build parameters", {
           {"max_width", kBuildMaxWidth, "", "largest WIDTH, px"},
           {"disparities", kBuildDisparities, "disparity_range", "0 means 256"},
           {"census_window", kBuildCensusWindow, "census_window_size", "side, px"},
           {"correlation_window", kBuildCorrelationWindow, "correlation_window_size", "side, px"},
           {"census_full", kBuildCensusFull, "census_pattern", "1 full, 0 sparse"},
       }},
      {"BUILD_LINE_ROWS", kRegBuildLineRows, Access::kReadOnly, {},
       "rows of each line buffer of rectify", {
       }},
      {"BUILD_MESH_NODES", kRegBuildMeshNodes, Access::kReadOnly, {},
       "nodes that one mesh may have", {
       }},
      {"CONTROL", kRegControl, Access::kWriteOnly, kRegControlReset,
       "commands", {
           {"apply", kControlApply, "", "1 makes the shadow take effect at the next frame"},
           {"clear", kControlClear, "", "1 sets counters and errors to 0"},
       }},
      {"STATUS", kRegStatus, Access::kReadOnly, kRegStatusReset,
       "present state", {
           {"pending", kStatusPending, "", "an apply waits for the next frame to start"},
           {"busy", kStatusBusy, "", "a frame is in flight"},
           {"uploading", kStatusUploading, "", "a mesh was written, and no apply has taken effect since"},
       }},
      {"ERRORS", kRegErrors, Access::kWriteOneToClear, kRegErrorsReset,
       "errors since they were last cleared", {
           {"cut_frame", kErrorsCutFrame, "", "a frame started before the previous one had all its pixels"},
           {"long_frame", kErrorsLongFrame, "", "pixels arrived after the last one of a frame"},
           {"buffer_left", kErrorsBufferLeft, "", "rectify read a pixel that is not in the left line buffer, or a mesh was being written"},
           {"buffer_right", kErrorsBufferRight, "", "rectify read a pixel that is not in the right line buffer, or a mesh was being written"},
           {"config", kErrorsConfig, "", "the board refused an apply: WIDTH, HEIGHT or READ_START is out of range"},
           {"labels", kErrorsLabels, "", "speckle ran out of labels; always 0 in this design"},
       }},
      {"WIDTH", kRegWidth, Access::kReadWrite, kRegWidthReset,
       "image width, GatewareMinWidth to BUILD.max_width", {
           {"pixels", kWidthPixels, "", "px"},
       }},
      {"HEIGHT", kRegHeight, Access::kReadWrite, kRegHeightReset,
       "image height, 1 to GatewareMaxHeight", {
           {"rows", kHeightRows, "", "px"},
       }},
      {"READ_START", kRegReadStart, Access::kReadWrite, kRegReadStartReset,
       "delay T_s of rectify = rows x WIDTH + pixels", {
           {"pixels", kReadStartPixels, "", "below WIDTH"},
           {"rows", kReadStartRows, "", "whole rows, below BUILD_LINE_ROWS"},
       }},
      {"FLAGS", kRegFlags, Access::kReadWrite, kRegFlagsReset,
       "switches of the stages", {
           {"left_right_check", kFlagsLeftRightCheck, "left_right_check", "check"},
           {"uniqueness_check", kFlagsUniquenessCheck, "uniqueness_check", "check"},
           {"subpixel", kFlagsSubpixel, "subpixel", "subpixel"},
       }},
      {"DISP12_MAX_DIFF", kRegDisp12MaxDiff, Access::kReadWrite, kRegDisp12MaxDiffReset,
       "largest difference that the left-right check allows", {
           {"pixels", kDisp12MaxDiffPixels, "disp12MaxDiff", "px"},
       }},
      {"UNIQUENESS", kRegUniqueness, Access::kReadWrite, kRegUniquenessReset,
       "factor N of the uniqueness check = 256 (1 + uniqueness_ratio / 100), rounded", {
           {"factor", kUniquenessFactor, "uniqueness_ratio", "in 1/UniquenessScale"},
       }},
      {"SPECKLE_SIZE", kRegSpeckleSize, Access::kReadWrite, kRegSpeckleSizeReset,
       "speckle drops regions of fewer pixels; 0 turns it off; up to SpeckleMax", {
           {"pixels", kSpeckleSizePixels, "speckle_size", "px"},
       }},
      {"SPECKLE_RANGE", kRegSpeckleRange, Access::kReadWrite, kRegSpeckleRangeReset,
       "largest disparity step between neighbours of one region", {
           {"units", kSpeckleRangeUnits, "speckle_range", "in 1/DisparityScale px"},
       }},
      {"MESH_ADDRESS", kRegMeshAddress, Access::kReadWrite, kRegMeshAddressReset,
       "node that the next write to MESH_DATA sets", {
           {"node", kMeshAddressNode, "", "number; each write to MESH_DATA increments it"},
           {"camera", kMeshAddressCamera, "", "0 left, 1 right"},
       }},
      {"MESH_DATA", kRegMeshData, Access::kWriteOnly, kRegMeshDataReset,
       "displacement of one node, source minus destination, in 1/MeshScale px, signed", {
           {"dx", kMeshDataDx, "", "to the right"},
           {"dy", kMeshDataDy, "", "down"},
       }},
      {"MESH_SIGNATURE", kRegMeshSignature, Access::kReadOnly, kRegMeshSignatureReset,
       "signature (see Signatures) of the words written to MESH_DATA since the last write to MESH_ADDRESS; the host verifies a mesh with it", {
       }},
      {"FRAMES_IN", kRegFramesIn, Access::kReadOnly, kRegFramesInReset,
       "frames that started at the input", {
       }},
      {"FRAMES_OUT", kRegFramesOut, Access::kReadOnly, kRegFramesOutReset,
       "frames whose last pixel left speckle", {
       }},
      {"CUT_FRAMES", kRegCutFrames, Access::kReadOnly, kRegCutFramesReset,
       "frames with ERRORS.cut_frame", {
       }},
      {"LONG_FRAMES", kRegLongFrames, Access::kReadOnly, kRegLongFramesReset,
       "frames with ERRORS.long_frame", {
       }},
      {"BUFFER_ERRORS", kRegBufferErrors, Access::kReadOnly, kRegBufferErrorsReset,
       "frames with ERRORS.buffer_left or buffer_right", {
       }},
      {"LABEL_EXHAUSTION", kRegLabelExhaustion, Access::kReadOnly, kRegLabelExhaustionReset,
       "frames with ERRORS.labels; always 0 in this design", {
       }},
      {"MESH_UPLOADS", kRegMeshUploads, Access::kReadOnly, kRegMeshUploadsReset,
       "applies that took effect after a mesh was written", {
       }},
      {"SIGNATURE_RECTIFY", kRegSignatureRectify, Access::kReadOnly, kRegSignatureRectifyReset,
       "left << 8 ^ right", {
       }},
      {"SIGNATURE_CENSUS", kRegSignatureCensus, Access::kReadOnly, kRegSignatureCensusReset,
       "fold(left bits) ^ rol(fold(right bits), 16)", {
       }},
      {"SIGNATURE_MATCH", kRegSignatureMatch, Access::kReadOnly, kRegSignatureMatchReset,
       "XOR over d of rol(S(x, y, d), d mod 32)", {
       }},
      {"SIGNATURE_SELECT", kRegSignatureSelect, Access::kReadOnly, kRegSignatureSelectReset,
       "dL ^ dR << 8 ^ v1 << 16 ^ rol(v2, 8) ^ XOR over k = 0..4 of rol(C(k - 2), 5 k)", {
       }},
      {"SIGNATURE_CHECK", kRegSignatureCheck, Access::kReadOnly, kRegSignatureCheckReset,
       "1 if the pixel is kept, else 0", {
       }},
      {"SIGNATURE_SUBPIXEL", kRegSignatureSubpixel, Access::kReadOnly, kRegSignatureSubpixelReset,
       "the disparity", {
       }},
      {"SIGNATURE_SPECKLE", kRegSignatureSpeckle, Access::kReadOnly, kRegSignatureSpeckleReset,
       "the disparity", {
       }},
      {"BUILD_STREAMS", kRegBuildStreams, Access::kReadOnly, {},
       "streams that this build supports", {
           {"streams", kBuildStreamsStreams, "", "bit s stands for stream s"},
       }},
      {"BUILD_CLOCK", kRegBuildClock, Access::kReadOnly, {},
       "pixel clock, Hz", {
       }},
      {"STREAMS", kRegStreams, Access::kReadWrite, kRegStreamsReset,
       "streams that the board sends: bit s stands for stream s", {
           {"disparity", kStreamsDisparity, "", "1 sends it"},
           {"rectified_left", kStreamsRectifiedLeft, "", "1 sends it"},
           {"rectified_right", kStreamsRectifiedRight, "", "1 sends it"},
           {"raw_left", kStreamsRawLeft, "", "1 sends it"},
           {"raw_right", kStreamsRawRight, "", "1 sends it"},
       }},
      {"FRAME_INTERVAL", kRegFrameInterval, Access::kReadWrite, kRegFrameIntervalReset,
       "how often frames are sent", {
           {"pairs", kFrameIntervalPairs, "", "one pair in this many is sent; 0 acts as 1"},
           {"raw", kFrameIntervalRaw, "", "one in this many of the sent pairs includes raw images; 0 acts as 1"},
       }},
      {"INPUT", kRegInput, Access::kReadWrite, kRegInputReset,
       "source of raw pixels", {
           {"host", kInputHost, "", "1 takes stream input of the link, 0 the cameras"},
       }},
      {"MID_EXPOSURE", kRegMidExposure, Access::kReadWrite, kRegMidExposureReset,
       "time from the middle of the exposure to the first pixel; the board subtracts it from timestamps", {
           {"us", kMidExposureUs, "", "us"},
       }},
      {"CONFIGURATION", kRegConfiguration, Access::kReadOnly, kRegConfigurationReset,
       "configuration id: applies that took effect since the reset, modulo 2^32", {
       }},
      {"FRAMES_DROPPED", kRegFramesDropped, Access::kReadOnly, kRegFramesDroppedReset,
       "frames of any stream that the board dropped because the link was too slow, since CONTROL.clear", {
       }},
      {"BAD_PACKETS", kRegBadPackets, Access::kReadOnly, kRegBadPacketsReset,
       "sync words from the host without an intact packet, since CONTROL.clear", {
       }},
      {"LOST_PACKETS", kRegLostPackets, Access::kReadOnly, kRegLostPacketsReset,
       "packets missing in the host's sequence, since CONTROL.clear", {
       }},
      {"INPUT_ERRORS", kRegInputErrors, Access::kReadOnly, kRegInputErrorsReset,
       "pairs from the host without all rows or without a trailer, since CONTROL.clear", {
       }},
  };
  // clang-format on
  return table;
}

}  // namespace fpga_stereo::spec
