// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::spec {

const std::vector<Register>& register_table() {
  // clang-format off
  static const std::vector<Register> table{
      {"IDENTITY", kRegIdentity, Access::kReadOnly, kRegIdentityReset,
       "\"FST1\", F in the top byte", {
       }},
      {"SPEC_HASH", kRegSpecHash, Access::kReadOnly, kRegSpecHashReset,
       "of the specification that the gateware was made from", {
       }},
      {"VERSION", kRegVersion, Access::kReadOnly, kRegVersionReset,
       "of protocol and gateware", {
           {"major", kVersionMajor, "", "counts changes that break"},
           {"minor", kVersionMinor, "", "counts the others"},
       }},
      {"BUILD", kRegBuild, Access::kReadOnly, {},
       "build parameters", {
           {"max_width", kBuildMaxWidth, "", "px, largest WIDTH"},
           {"disparities", kBuildDisparities, "disparity_range", "0 means 256"},
           {"census_window", kBuildCensusWindow, "census_window_size", "px"},
           {"correlation_window", kBuildCorrelationWindow, "correlation_window_size", "px"},
           {"census_full", kBuildCensusFull, "census_pattern", "1 full, 0 sparse"},
       }},
      {"BUILD_LINE_ROWS", kRegBuildLineRows, Access::kReadOnly, {},
       "rows of the line buffer of rectify", {
       }},
      {"BUILD_MESH_NODES", kRegBuildMeshNodes, Access::kReadOnly, {},
       "nodes that one mesh may have", {
       }},
      {"CONTROL", kRegControl, Access::kWriteOnly, kRegControlReset,
       "commands", {
           {"apply", kControlApply, "", "1: the shadow takes effect at the next frame"},
           {"clear", kControlClear, "", "1: counters and errors become 0"},
       }},
      {"STATUS", kRegStatus, Access::kReadOnly, kRegStatusReset,
       "now", {
           {"pending", kStatusPending, "", "an apply waits for a frame to start"},
           {"busy", kStatusBusy, "", "a frame is under way"},
           {"bank", kStatusBank, "", "bank of meshes in use; the other is the shadow"},
       }},
      {"ERRORS", kRegErrors, Access::kWriteOneToClear, kRegErrorsReset,
       "what has gone wrong", {
           {"cut_frame", kErrorsCutFrame, "", "a frame started before another had all its pixels"},
           {"long_frame", kErrorsLongFrame, "", "pixels came after the last one of a frame"},
           {"buffer_left", kErrorsBufferLeft, "", "rectify read what is not in the left buffer"},
           {"buffer_right", kErrorsBufferRight, "", "rectify read what is not in the right buffer"},
           {"config", kErrorsConfig, "", "apply refused: WIDTH, HEIGHT or READ_START out of range"},
           {"labels", kErrorsLabels, "", "speckle ran out of labels; always 0 in this design"},
       }},
      {"WIDTH", kRegWidth, Access::kReadWrite, kRegWidthReset,
       "of the image, GatewareMinWidth to BUILD.max_width", {
           {"pixels", kWidthPixels, "", "px"},
       }},
      {"HEIGHT", kRegHeight, Access::kReadWrite, kRegHeightReset,
       "of the image, 1 to GatewareMaxHeight", {
           {"rows", kHeightRows, "", "px"},
       }},
      {"READ_START", kRegReadStart, Access::kReadWrite, kRegReadStartReset,
       "T_s of rectify = rows x WIDTH + pixels", {
           {"pixels", kReadStartPixels, "", "fewer than WIDTH"},
           {"rows", kReadStartRows, "", "whole rows, fewer than BUILD_LINE_ROWS"},
       }},
      {"FLAGS", kRegFlags, Access::kReadWrite, kRegFlagsReset,
       "switches", {
           {"left_right_check", kFlagsLeftRightCheck, "left_right_check", "of check"},
           {"uniqueness_check", kFlagsUniquenessCheck, "uniqueness_check", "of check"},
           {"subpixel", kFlagsSubpixel, "subpixel", "refine"},
       }},
      {"DISP12_MAX_DIFF", kRegDisp12MaxDiff, Access::kReadWrite, kRegDisp12MaxDiffReset,
       "largest difference that the left-right check allows", {
           {"pixels", kDisp12MaxDiffPixels, "disp12MaxDiff", "px"},
       }},
      {"UNIQUENESS", kRegUniqueness, Access::kReadWrite, kRegUniquenessReset,
       "N of the uniqueness check = 256 (1 + uniqueness_ratio / 100), rounded", {
           {"factor", kUniquenessFactor, "uniqueness_ratio", "in 1/UniquenessScale"},
       }},
      {"SPECKLE_SIZE", kRegSpeckleSize, Access::kReadWrite, kRegSpeckleSizeReset,
       "regions of fewer pixels are dropped; 0 switches speckle off; up to SpeckleMax", {
           {"pixels", kSpeckleSizePixels, "speckle_size", "px"},
       }},
      {"SPECKLE_RANGE", kRegSpeckleRange, Access::kReadWrite, kRegSpeckleRangeReset,
       "largest step between neighbours of one region", {
           {"units", kSpeckleRangeUnits, "speckle_range", "in 1/DisparityScale px"},
       }},
      {"MESH_ADDRESS", kRegMeshAddress, Access::kReadWrite, kRegMeshAddressReset,
       "where the next MESH_DATA goes", {
           {"node", kMeshAddressNode, "", "number; MESH_DATA increments it"},
           {"camera", kMeshAddressCamera, "", "0 left, 1 right"},
       }},
      {"MESH_DATA", kRegMeshData, Access::kWriteOnly, kRegMeshDataReset,
       "one node: displacement, source minus destination, in 1/MeshScale px, signed", {
           {"dx", kMeshDataDx, "", "to the right"},
           {"dy", kMeshDataDy, "", "down"},
       }},
      {"MESH_SIGNATURE", kRegMeshSignature, Access::kReadOnly, kRegMeshSignatureReset,
       "signature, as below, of the words written to MESH_DATA since MESH_ADDRESS was: how a mesh is read back", {
       }},
      {"FRAMES_IN", kRegFramesIn, Access::kReadOnly, kRegFramesInReset,
       "frames that have started at the input", {
       }},
      {"FRAMES_OUT", kRegFramesOut, Access::kReadOnly, kRegFramesOutReset,
       "frames of which the last pixel has left speckle", {
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
      {"MESH_SWAPS", kRegMeshSwaps, Access::kReadOnly, kRegMeshSwapsReset,
       "swaps of the bank of meshes in use: applies with a node written since the last one", {
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
       "1 kept, 0 not", {
       }},
      {"SIGNATURE_SUBPIXEL", kRegSignatureSubpixel, Access::kReadOnly, kRegSignatureSubpixelReset,
       "the disparity", {
       }},
      {"SIGNATURE_SPECKLE", kRegSignatureSpeckle, Access::kReadOnly, kRegSignatureSpeckleReset,
       "the disparity", {
       }},
      {"BUILD_STREAMS", kRegBuildStreams, Access::kReadOnly, {},
       "what this build can send and take: bit s for stream s", {
           {"streams", kBuildStreamsStreams, "", "a bit each"},
       }},
      {"BUILD_CLOCK", kRegBuildClock, Access::kReadOnly, {},
       "Hz, of the pixels", {
       }},
      {"STREAMS", kRegStreams, Access::kReadWrite, kRegStreamsReset,
       "what is sent: bit s for stream s", {
           {"disparity", kStreamsDisparity, "", "1 sent"},
           {"rectified_left", kStreamsRectifiedLeft, "", "1 sent"},
           {"rectified_right", kStreamsRectifiedRight, "", "1 sent"},
           {"raw_left", kStreamsRawLeft, "", "1 sent"},
           {"raw_right", kStreamsRawRight, "", "1 sent"},
       }},
      {"FRAME_INTERVAL", kRegFrameInterval, Access::kReadWrite, kRegFrameIntervalReset,
       "of how many pairs one is sent", {
           {"pairs", kFrameIntervalPairs, "", "1 or more; 0 acts as 1"},
           {"raw", kFrameIntervalRaw, "", "raw images only of one in so many of those that are sent; 0 acts as 1"},
       }},
      {"INPUT", kRegInput, Access::kReadWrite, kRegInputReset,
       "where raw pixels come from", {
           {"host", kInputHost, "", "1 stream input of the link, 0 the cameras"},
       }},
      {"MID_EXPOSURE", kRegMidExposure, Access::kReadWrite, kRegMidExposureReset,
       "from the middle of the exposure to the first pixel: subtracted from timestamps", {
           {"us", kMidExposureUs, "", "us"},
       }},
      {"CONFIGURATION", kRegConfiguration, Access::kReadOnly, kRegConfigurationReset,
       "applies that took effect, since the reset, modulo 2^32", {
       }},
      {"FRAMES_DROPPED", kRegFramesDropped, Access::kReadOnly, kRegFramesDroppedReset,
       "frames, of any stream, that the link was too slow for, since CONTROL.clear", {
       }},
      {"BAD_PACKETS", kRegBadPackets, Access::kReadOnly, kRegBadPacketsReset,
       "sync words of the host with no intact packet behind, since CONTROL.clear", {
       }},
      {"LOST_PACKETS", kRegLostPackets, Access::kReadOnly, kRegLostPacketsReset,
       "gaps in the host's sequence, in packets, since CONTROL.clear", {
       }},
      {"INPUT_ERRORS", kRegInputErrors, Access::kReadOnly, kRegInputErrorsReset,
       "pairs from the host that lacked rows or a trailer, since CONTROL.clear", {
       }},
  };
  // clang-format on
  return table;
}

}  // namespace fpga_stereo::spec
