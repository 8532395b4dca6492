// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
//
// The numbers that software and gateware share. RTL twin: fpga_fw/rtl/fs_pkg.sv. Document:
// fpga_fw/spec/registers.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fpga_stereo {

/// Stages of the pipeline, in data order. stereo_algorithm decides between match, and cost with
/// aggregate.
enum class Stage {
  kRectify,    // moves both images onto common rows
  kCensus,     // compares each pixel with its neighbours, a bit each
  kMatch,      // sums Hamming distances over a window
  kCost,       // finds the matching cost of a pixel, in two bits
  kAggregate,  // sums the costs of the paths that lead to a pixel
  kSelect,     // finds the smallest sum, left and right
  kCheck,      // applies the left-right check and the uniqueness check
  kSubpixel,   // finds the fraction of the disparity
  kSpeckle,    // drops small regions
  kFill,       // gives every pixel a disparity
  kMedian,     // smooths the filled disparities
};
constexpr int kNumStages = 11;
// clang-format off
constexpr std::array<const char*, kNumStages> kStageNames{
    "rectify", "census", "match", "cost", "aggregate", "select", "check", "subpixel", "speckle",
    "fill", "median"};
/// The stages of the gateware, in the order of its signatures.
constexpr int kNumGatewareStages = 7;
constexpr std::array<Stage, kNumGatewareStages> kGatewareStages{
    Stage::kRectify, Stage::kCensus, Stage::kMatch, Stage::kSelect, Stage::kCheck, Stage::kSubpixel,
    Stage::kSpeckle};
// clang-format on
/// Returns the name of a stage of the gateware.
constexpr const char* gateware_stage_name(int signature) {
  const Stage stage = kGatewareStages[static_cast<std::size_t>(signature)];
  return kStageNames[static_cast<std::size_t>(stage)];
}

constexpr int kDisparityScale = 32;                         // units of a disparity per px
constexpr int kDisparityBits = 16;                          // width of a disparity, unsigned
constexpr std::uint16_t kNoDisparity = 0xFFFF;              // marks a pixel without a disparity
constexpr int kSpeckleLookAhead = 24;                       // rows of look-ahead of speckle
constexpr int kMeshPitch = 8;                               // px between mesh nodes
constexpr int kMeshScale = 128;                             // units of a displacement per px
constexpr int kMeshBits = 16;                               // width of a displacement, signed
constexpr int kSourceScale = 32;                            // units of a source position per px
constexpr int kMaxWidth = 1920;                             // px, software pipeline
constexpr int kMaxHeight = 1200;                            // px, software pipeline
constexpr int kGatewareMinWidth = 16;                       // px
constexpr int kGatewareMaxWidth = 1280;                     // px; a build may allow less
constexpr int kGatewareMaxHeight = 1200;                    // px
constexpr int kPixelBits = 8;                               // width of a grey value
constexpr int kUniquenessScale = 256;                       // uniqueness factor that means 1
constexpr int kSpeckleMax = 1000;                           // px, largest speckle_size
constexpr int kSubpixelNumerator = 7;                       // offset = 7 num / (10 den)
constexpr int kSubpixelDenominator = 10;                    // offset = 7 num / (10 den)
constexpr std::uint32_t kSignaturePolynomial = 0x1EDC6F41;  // CRC-32C, without x^32
constexpr std::uint32_t kSignatureStart = 0xFFFFFFFF;       // signature before the first pixel
constexpr int kRegisterBits = 32;                           // width of a register
constexpr int kRegisterAddressBits = 8;                     // width of a word address
constexpr std::uint32_t kLinkSync = 0xA75346D5;             // first word of a packet
constexpr std::uint8_t kLinkVersion = 0x01;                 // version of the packets
constexpr int kLinkMaxPayloadBytes = 8192;                  // in a packet from the board
constexpr int kLinkMaxHostPayloadBytes = 4096;              // in a packet from the host
constexpr int kLinkMaxRequestRegisters = 64;                // registers in one request
constexpr int kLinkMaxRequestNodes = 255;                   // mesh nodes in one request
constexpr std::uint32_t kLinkFirstSequence = 0xFFFFFFF0;    // sequence of the first packet
constexpr std::uint32_t kLinkFirstFrame = 0xFFFFFFF0;       // low word of the first frame_id
constexpr std::uint8_t kLinkFirstRegister = 0x60;           // first register of the link
constexpr int kHeartbeatMs = 500;                           // longest pause between packets
constexpr int kHostTimeoutMs = 2000;                        // host silence that stops the board
constexpr int kBoardSilenceMs = 100;                        // board discards a partial packet
constexpr int kHostSilenceMs = 1000;                        // host discards a partial packet
constexpr std::uint8_t kPacketReadRegisters = 0x01;         // from the host
constexpr std::uint8_t kPacketWriteRegisters = 0x02;        // from the host
constexpr std::uint8_t kPacketWriteMesh = 0x03;             // from the host
constexpr std::uint8_t kPacketLeader = 0x10;                // from either side
constexpr std::uint8_t kPacketRows = 0x11;                  // from either side
constexpr std::uint8_t kPacketTrailer = 0x12;               // from either side
constexpr std::uint8_t kPacketRegisters = 0x81;             // from the board: values read
constexpr std::uint8_t kPacketWritten = 0x82;               // from the board: write done
constexpr std::uint8_t kPacketRefused = 0x83;               // from the board: packet refused
constexpr std::uint8_t kPacketHeartbeat = 0x84;             // from the board
constexpr std::uint8_t kStreamDisparity = 0x01;             // frames from the board
constexpr std::uint8_t kStreamRectifiedLeft = 0x02;         // frames from the board
constexpr std::uint8_t kStreamRectifiedRight = 0x03;        // frames from the board
constexpr std::uint8_t kStreamRawLeft = 0x04;               // frames from the board
constexpr std::uint8_t kStreamRawRight = 0x05;              // frames from the board
constexpr std::uint8_t kStreamInput = 0x06;                 // pairs from the host
constexpr std::uint8_t kFormatDisparity = 0x01;             // pixels are u16
constexpr std::uint8_t kFormatGrey = 0x02;                  // pixels are u8
constexpr std::uint32_t kFrameCut = 0x00000001;             // flag: too few pixels arrived
constexpr std::uint32_t kFrameLong = 0x00000002;            // flag: too many pixels arrived
constexpr std::uint32_t kFrameBufferError = 0x00000004;     // flag: rectify missed a pixel
constexpr std::uint32_t kFrameOverrun = 0x00000008;         // flag: the link was too slow
constexpr std::uint32_t kRefusedVersion = 0x00000001;       // reason: unknown version
constexpr std::uint32_t kRefusedType = 0x00000002;          // reason: unknown type
constexpr std::uint32_t kRefusedLength = 0x00000003;        // reason: length not allowed
constexpr int kSgmCensusBits = 16;                          // of a pixel
constexpr int kSgmCensusDistance = 3;                       // px, of the outer neighbours
constexpr int kSgmMaxCost = 3;                              // largest matching cost
constexpr int kSgmMaxPath = 15;                             // largest path cost, without C
constexpr int kSgmMinP2 = 6;                                // twice the largest matching cost
constexpr int kFitRadiusX = 4;                              // px, window of the sub-pixel fit
constexpr int kFitRadiusY = 5;                              // px
constexpr int kFitDamping = 64;                             // pulls offsets towards 0
constexpr int kMaskedMedianRadiusX = 6;                     // px, of the first median
constexpr int kMaskedMedianStepX = 6;                       // px
constexpr int kMaskedMedianRadiusY = 4;                     // px, of the first median
constexpr int kMaskedMedianStepY = 2;                       // px
constexpr int kMedianRadius = 2;                            // px, of the second median

// Build parameters of a gateware unless a board sets others.
constexpr int kDefaultMaxWidth = 640;          // px
constexpr int kDefaultDisparities = 64;        // disparity_range
constexpr int kDefaultCensusWindow = 11;       // px
constexpr int kDefaultCorrelationWindow = 15;  // px
constexpr int kDefaultLineRows = 102;          // rows of each line buffer
constexpr int kDefaultMeshNodes = 5120;        // nodes that one mesh may have

// Byte offsets in the header of each packet.
constexpr int kLinkHeaderBytes = 36;
constexpr int kLinkHeaderSyncAt = 0;
constexpr int kLinkHeaderVersionAt = 4;
constexpr int kLinkHeaderTypeAt = 5;
constexpr int kLinkHeaderFlagsAt = 6;
constexpr int kLinkHeaderStreamAt = 7;
constexpr int kLinkHeaderLengthAt = 8;
constexpr int kLinkHeaderIndexAt = 10;
constexpr int kLinkHeaderSequenceAt = 12;
constexpr int kLinkHeaderFrameIdAt = 16;
constexpr int kLinkHeaderTimestampAt = 24;
constexpr int kLinkHeaderCrcAt = 32;

// Byte offsets in the payload of a leader packet.
constexpr int kLinkLeaderBytes = 12;
constexpr int kLinkLeaderWidthAt = 0;
constexpr int kLinkLeaderHeightAt = 2;
constexpr int kLinkLeaderFormatAt = 4;
constexpr int kLinkLeaderConfigurationAt = 8;

// Byte offsets in the payload of a trailer packet.
constexpr int kLinkTrailerBytes = 12;
constexpr int kLinkTrailerRowsAt = 0;
constexpr int kLinkTrailerFlagsAt = 4;
constexpr int kLinkTrailerSignatureAt = 8;

/// The specification hash. The host refuses a gateware with another hash.
constexpr std::uint32_t kSpecHash = 0xB7A06FF4;

/// The register map of the gateware.
namespace spec {

/// Bits of a register.
struct Field {
  int lsb, bits;

  constexpr std::uint32_t mask() const { return (0xFFFFFFFFU >> (32 - bits)) << lsb; }
  constexpr std::uint32_t get(std::uint32_t word) const { return (word & mask()) >> lsb; }
  constexpr std::uint32_t put(std::uint32_t value) const { return (value << lsb) & mask(); }
};

struct FieldInfo {
  const char* name;
  Field field;
  const char* parameter;  // pipeline parameter that the field holds, or ""
  const char* about;
};

enum class Access { kReadOnly, kReadWrite, kWriteOnly, kWriteOneToClear };

struct Register {
  const char* name;
  std::uint32_t address;  // of the word; byte address = 4 x this
  Access access;
  std::optional<std::uint32_t> reset;  // nullopt: a build parameter of the gateware gives it
  const char* about;
  std::vector<FieldInfo> fields;  // empty: one number of 32 bits
};

/// Returns all registers in ascending address order.
const std::vector<Register>& register_table();

/// Configuration registers: addresses from the first one up to, but without, the end.
constexpr std::uint32_t kConfigurationBegin = 0x10;
constexpr std::uint32_t kConfigurationEnd = 0x18;

// Word addresses, reset values, fields.

constexpr std::uint32_t kRegIdentity = 0x00;
constexpr std::uint32_t kRegIdentityReset = 0x46535431;

constexpr std::uint32_t kRegSpecHash = 0x01;
constexpr std::uint32_t kRegSpecHashReset = 0xB7A06FF4;

constexpr std::uint32_t kRegVersion = 0x02;
constexpr std::uint32_t kRegVersionReset = 0x00000001;
constexpr Field kVersionMajor{16, 16};
constexpr Field kVersionMinor{0, 16};

constexpr std::uint32_t kRegBuild = 0x03;
constexpr Field kBuildMaxWidth{0, 12};
constexpr Field kBuildDisparities{12, 8};
constexpr Field kBuildCensusWindow{20, 4};
constexpr Field kBuildCorrelationWindow{24, 5};
constexpr Field kBuildCensusFull{29, 1};

constexpr std::uint32_t kRegBuildLineRows = 0x04;

constexpr std::uint32_t kRegBuildMeshNodes = 0x05;

constexpr std::uint32_t kRegControl = 0x08;
constexpr std::uint32_t kRegControlReset = 0x00000000;
constexpr Field kControlApply{0, 1};
constexpr Field kControlClear{1, 1};

constexpr std::uint32_t kRegStatus = 0x09;
constexpr std::uint32_t kRegStatusReset = 0x00000000;
constexpr Field kStatusPending{0, 1};
constexpr Field kStatusBusy{1, 1};
constexpr Field kStatusUploading{2, 1};

constexpr std::uint32_t kRegErrors = 0x0A;
constexpr std::uint32_t kRegErrorsReset = 0x00000000;
constexpr Field kErrorsCutFrame{0, 1};
constexpr Field kErrorsLongFrame{1, 1};
constexpr Field kErrorsBufferLeft{2, 1};
constexpr Field kErrorsBufferRight{3, 1};
constexpr Field kErrorsConfig{4, 1};
constexpr Field kErrorsLabels{5, 1};

constexpr std::uint32_t kRegWidth = 0x10;
constexpr std::uint32_t kRegWidthReset = 0x00000280;
constexpr Field kWidthPixels{0, 12};

constexpr std::uint32_t kRegHeight = 0x11;
constexpr std::uint32_t kRegHeightReset = 0x000001E0;
constexpr Field kHeightRows{0, 12};

constexpr std::uint32_t kRegReadStart = 0x12;
constexpr std::uint32_t kRegReadStartReset = 0x00010002;
constexpr Field kReadStartPixels{0, 12};
constexpr Field kReadStartRows{16, 8};

constexpr std::uint32_t kRegFlags = 0x13;
constexpr std::uint32_t kRegFlagsReset = 0x00000007;
constexpr Field kFlagsLeftRightCheck{0, 1};
constexpr Field kFlagsUniquenessCheck{1, 1};
constexpr Field kFlagsSubpixel{2, 1};

constexpr std::uint32_t kRegDisp12MaxDiff = 0x14;
constexpr std::uint32_t kRegDisp12MaxDiffReset = 0x00000001;
constexpr Field kDisp12MaxDiffPixels{0, 8};

constexpr std::uint32_t kRegUniqueness = 0x15;
constexpr std::uint32_t kRegUniquenessReset = 0x00000154;
constexpr Field kUniquenessFactor{0, 10};

constexpr std::uint32_t kRegSpeckleSize = 0x16;
constexpr std::uint32_t kRegSpeckleSizeReset = 0x00000028;
constexpr Field kSpeckleSizePixels{0, 10};

constexpr std::uint32_t kRegSpeckleRange = 0x17;
constexpr std::uint32_t kRegSpeckleRangeReset = 0x00000020;
constexpr Field kSpeckleRangeUnits{0, 10};

constexpr std::uint32_t kRegMeshAddress = 0x20;
constexpr std::uint32_t kRegMeshAddressReset = 0x00000000;
constexpr Field kMeshAddressNode{0, 16};
constexpr Field kMeshAddressCamera{16, 1};

constexpr std::uint32_t kRegMeshData = 0x21;
constexpr std::uint32_t kRegMeshDataReset = 0x00000000;
constexpr Field kMeshDataDx{0, 16};
constexpr Field kMeshDataDy{16, 16};

constexpr std::uint32_t kRegMeshSignature = 0x22;
constexpr std::uint32_t kRegMeshSignatureReset = 0xFFFFFFFF;

constexpr std::uint32_t kRegFramesIn = 0x30;
constexpr std::uint32_t kRegFramesInReset = 0x00000000;

constexpr std::uint32_t kRegFramesOut = 0x31;
constexpr std::uint32_t kRegFramesOutReset = 0x00000000;

constexpr std::uint32_t kRegCutFrames = 0x32;
constexpr std::uint32_t kRegCutFramesReset = 0x00000000;

constexpr std::uint32_t kRegLongFrames = 0x33;
constexpr std::uint32_t kRegLongFramesReset = 0x00000000;

constexpr std::uint32_t kRegBufferErrors = 0x34;
constexpr std::uint32_t kRegBufferErrorsReset = 0x00000000;

constexpr std::uint32_t kRegLabelExhaustion = 0x35;
constexpr std::uint32_t kRegLabelExhaustionReset = 0x00000000;

constexpr std::uint32_t kRegMeshUploads = 0x36;
constexpr std::uint32_t kRegMeshUploadsReset = 0x00000000;

constexpr std::uint32_t kRegSignatureRectify = 0x40;
constexpr std::uint32_t kRegSignatureRectifyReset = 0x00000000;

constexpr std::uint32_t kRegSignatureCensus = 0x41;
constexpr std::uint32_t kRegSignatureCensusReset = 0x00000000;

constexpr std::uint32_t kRegSignatureMatch = 0x42;
constexpr std::uint32_t kRegSignatureMatchReset = 0x00000000;

constexpr std::uint32_t kRegSignatureSelect = 0x43;
constexpr std::uint32_t kRegSignatureSelectReset = 0x00000000;

constexpr std::uint32_t kRegSignatureCheck = 0x44;
constexpr std::uint32_t kRegSignatureCheckReset = 0x00000000;

constexpr std::uint32_t kRegSignatureSubpixel = 0x45;
constexpr std::uint32_t kRegSignatureSubpixelReset = 0x00000000;

constexpr std::uint32_t kRegSignatureSpeckle = 0x46;
constexpr std::uint32_t kRegSignatureSpeckleReset = 0x00000000;

constexpr std::uint32_t kRegBuildStreams = 0x60;
constexpr Field kBuildStreamsStreams{0, 8};

constexpr std::uint32_t kRegBuildClock = 0x61;

constexpr std::uint32_t kRegStreams = 0x62;
constexpr std::uint32_t kRegStreamsReset = 0x00000000;
constexpr Field kStreamsDisparity{1, 1};
constexpr Field kStreamsRectifiedLeft{2, 1};
constexpr Field kStreamsRectifiedRight{3, 1};
constexpr Field kStreamsRawLeft{4, 1};
constexpr Field kStreamsRawRight{5, 1};

constexpr std::uint32_t kRegFrameInterval = 0x63;
constexpr std::uint32_t kRegFrameIntervalReset = 0x00010001;
constexpr Field kFrameIntervalPairs{0, 16};
constexpr Field kFrameIntervalRaw{16, 16};

constexpr std::uint32_t kRegInput = 0x64;
constexpr std::uint32_t kRegInputReset = 0x00000000;
constexpr Field kInputHost{0, 1};

constexpr std::uint32_t kRegMidExposure = 0x65;
constexpr std::uint32_t kRegMidExposureReset = 0x00000000;
constexpr Field kMidExposureUs{0, 24};

constexpr std::uint32_t kRegConfiguration = 0x66;
constexpr std::uint32_t kRegConfigurationReset = 0x00000000;

constexpr std::uint32_t kRegFramesDropped = 0x67;
constexpr std::uint32_t kRegFramesDroppedReset = 0x00000000;

constexpr std::uint32_t kRegBadPackets = 0x68;
constexpr std::uint32_t kRegBadPacketsReset = 0x00000000;

constexpr std::uint32_t kRegLostPackets = 0x69;
constexpr std::uint32_t kRegLostPacketsReset = 0x00000000;

constexpr std::uint32_t kRegInputErrors = 0x6A;
constexpr std::uint32_t kRegInputErrorsReset = 0x00000000;

}  // namespace spec
}  // namespace fpga_stereo
