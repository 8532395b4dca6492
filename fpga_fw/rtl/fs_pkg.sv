// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
//
// The numbers that gateware and software share. C++ twin: include/fpga_stereo/core/spec.hpp.
// Document: fpga_fw/spec/registers.md.

/* verilator lint_off UNUSEDPARAM */  // no design uses every name
package fs_pkg;
  // The specification hash.
  localparam logic [31:0] SpecHash = 32'hB7A06FF4;

  // Stages, in data order.
  localparam int StageRectify = 0;   // moves both images onto common rows
  localparam int StageCensus = 1;    // compares each pixel with its neighbours, a bit each
  localparam int StageMatch = 2;     // sums Hamming distances over a window
  localparam int StageSelect = 3;    // finds the smallest sum, left and right
  localparam int StageCheck = 4;     // applies the left-right check and the uniqueness check
  localparam int StageSubpixel = 5;  // finds the fraction of the disparity
  localparam int StageSpeckle = 6;   // drops small regions
  localparam int NumStages = 7;

  // Constants.
  localparam int DisparityScale = 32;                          // units of a disparity per px
  localparam int DisparityBits = 16;                           // width of a disparity, unsigned
  localparam logic [15:0] NoDisparity = 16'hFFFF;              // marks a pixel without a disparity
  localparam int SpeckleLookAhead = 24;                        // rows of look-ahead of speckle
  localparam int MeshPitch = 8;                                // px between mesh nodes
  localparam int MeshScale = 128;                              // units of a displacement per px
  localparam int MeshBits = 16;                                // width of a displacement, signed
  localparam int SourceScale = 32;                             // units of a source position per px
  localparam int MaxWidth = 1920;                              // px, software pipeline
  localparam int MaxHeight = 1200;                             // px, software pipeline
  localparam int GatewareMinWidth = 16;                        // px
  localparam int GatewareMaxWidth = 1280;                      // px; a build may allow less
  localparam int GatewareMaxHeight = 1200;                     // px
  localparam int PixelBits = 8;                                // width of a grey value
  localparam int UniquenessScale = 256;                        // uniqueness factor that means 1
  localparam int SpeckleMax = 1000;                            // px, largest speckle_size
  localparam int SubpixelNumerator = 7;                        // offset = 7 num / (10 den)
  localparam int SubpixelDenominator = 10;                     // offset = 7 num / (10 den)
  localparam logic [31:0] SignaturePolynomial = 32'h1EDC6F41;  // CRC-32C, without x^32
  localparam logic [31:0] SignatureStart = 32'hFFFFFFFF;       // signature before the first pixel
  localparam int RegisterBits = 32;                            // width of a register
  localparam int RegisterAddressBits = 8;                      // width of a word address
  localparam logic [31:0] LinkSync = 32'hA75346D5;             // first word of a packet
  localparam logic [7:0] LinkVersion = 8'h01;                  // version of the packets
  localparam int LinkMaxPayloadBytes = 8192;                   // in a packet from the board
  localparam int LinkMaxHostPayloadBytes = 4096;               // in a packet from the host
  localparam int LinkMaxRequestRegisters = 64;                 // registers in one request
  localparam int LinkMaxRequestNodes = 255;                    // mesh nodes in one request
  localparam logic [31:0] LinkFirstSequence = 32'hFFFFFFF0;    // sequence of the first packet
  localparam logic [31:0] LinkFirstFrame = 32'hFFFFFFF0;       // low word of the first frame_id
  localparam logic [7:0] LinkFirstRegister = 8'h60;            // first register of the link
  localparam int HeartbeatMs = 500;                            // longest pause between packets
  localparam int HostTimeoutMs = 2000;                         // host silence that stops the board
  localparam int BoardSilenceMs = 100;                         // board discards a partial packet
  localparam int HostSilenceMs = 1000;                         // host discards a partial packet
  localparam logic [7:0] PacketReadRegisters = 8'h01;          // from the host
  localparam logic [7:0] PacketWriteRegisters = 8'h02;         // from the host
  localparam logic [7:0] PacketWriteMesh = 8'h03;              // from the host
  localparam logic [7:0] PacketLeader = 8'h10;                 // from either side
  localparam logic [7:0] PacketRows = 8'h11;                   // from either side
  localparam logic [7:0] PacketTrailer = 8'h12;                // from either side
  localparam logic [7:0] PacketRegisters = 8'h81;              // from the board: values read
  localparam logic [7:0] PacketWritten = 8'h82;                // from the board: write done
  localparam logic [7:0] PacketRefused = 8'h83;                // from the board: packet refused
  localparam logic [7:0] PacketHeartbeat = 8'h84;              // from the board
  localparam logic [7:0] StreamDisparity = 8'h01;              // frames from the board
  localparam logic [7:0] StreamRectifiedLeft = 8'h02;          // frames from the board
  localparam logic [7:0] StreamRectifiedRight = 8'h03;         // frames from the board
  localparam logic [7:0] StreamRawLeft = 8'h04;                // frames from the board
  localparam logic [7:0] StreamRawRight = 8'h05;               // frames from the board
  localparam logic [7:0] StreamInput = 8'h06;                  // pairs from the host
  localparam logic [7:0] FormatDisparity = 8'h01;              // pixels are u16
  localparam logic [7:0] FormatGrey = 8'h02;                   // pixels are u8
  localparam logic [31:0] FrameCut = 32'h00000001;             // flag: too few pixels arrived
  localparam logic [31:0] FrameLong = 32'h00000002;            // flag: too many pixels arrived
  localparam logic [31:0] FrameBufferError = 32'h00000004;     // flag: rectify missed a pixel
  localparam logic [31:0] FrameOverrun = 32'h00000008;         // flag: the link was too slow
  localparam logic [31:0] RefusedVersion = 32'h00000001;       // reason: unknown version
  localparam logic [31:0] RefusedType = 32'h00000002;          // reason: unknown type
  localparam logic [31:0] RefusedLength = 32'h00000003;        // reason: length not allowed

  // Build parameters unless a board sets others.
  localparam int DefaultMaxWidth = 640;          // px
  localparam int DefaultDisparities = 64;        // disparity_range
  localparam int DefaultCensusWindow = 11;       // px
  localparam int DefaultCorrelationWindow = 15;  // px
  localparam int DefaultLineRows = 102;          // rows of each line buffer
  localparam int DefaultMeshNodes = 5120;        // nodes that one mesh may have

  // Byte offsets in the header of each packet.
  localparam int LinkHeaderBytes = 36;
  localparam int LinkHeaderSyncAt = 0;
  localparam int LinkHeaderVersionAt = 4;
  localparam int LinkHeaderTypeAt = 5;
  localparam int LinkHeaderFlagsAt = 6;
  localparam int LinkHeaderStreamAt = 7;
  localparam int LinkHeaderLengthAt = 8;
  localparam int LinkHeaderIndexAt = 10;
  localparam int LinkHeaderSequenceAt = 12;
  localparam int LinkHeaderFrameIdAt = 16;
  localparam int LinkHeaderTimestampAt = 24;
  localparam int LinkHeaderCrcAt = 32;

  // Byte offsets in the payload of a leader packet.
  localparam int LinkLeaderBytes = 12;
  localparam int LinkLeaderWidthAt = 0;
  localparam int LinkLeaderHeightAt = 2;
  localparam int LinkLeaderFormatAt = 4;
  localparam int LinkLeaderConfigurationAt = 8;

  // Byte offsets in the payload of a trailer packet.
  localparam int LinkTrailerBytes = 12;
  localparam int LinkTrailerRowsAt = 0;
  localparam int LinkTrailerFlagsAt = 4;
  localparam int LinkTrailerSignatureAt = 8;

  // Registers: word address, reset value, fields.
  localparam int NumRegisters = 45;

  // IDENTITY (ro): "FST1", with F in the top byte
  localparam logic [7:0] RegIdentity = 8'h00;
  localparam logic [31:0] RegIdentityReset = 32'h46535431;

  // SPEC_HASH (ro): hash of the specification that the gateware was built from
  localparam logic [7:0] RegSpecHash = 8'h01;
  localparam logic [31:0] RegSpecHashReset = 32'hB7A06FF4;

  // VERSION (ro): version of protocol and gateware
  localparam logic [7:0] RegVersion = 8'h02;
  localparam logic [31:0] RegVersionReset = 32'h00000001;
  localparam int VersionMajorLsb = 16;
  localparam int VersionMajorBits = 16;
  localparam int VersionMinorLsb = 0;
  localparam int VersionMinorBits = 16;

  // BUILD (ro): build parameters
  localparam logic [7:0] RegBuild = 8'h03;
  localparam int BuildMaxWidthLsb = 0;
  localparam int BuildMaxWidthBits = 12;
  localparam int BuildDisparitiesLsb = 12;
  localparam int BuildDisparitiesBits = 8;
  localparam int BuildCensusWindowLsb = 20;
  localparam int BuildCensusWindowBits = 4;
  localparam int BuildCorrelationWindowLsb = 24;
  localparam int BuildCorrelationWindowBits = 5;
  localparam int BuildCensusFullLsb = 29;
  localparam int BuildCensusFullBits = 1;

  // BUILD_LINE_ROWS (ro): rows of each line buffer of rectify
  localparam logic [7:0] RegBuildLineRows = 8'h04;

  // BUILD_MESH_NODES (ro): nodes that one mesh may have
  localparam logic [7:0] RegBuildMeshNodes = 8'h05;

  // CONTROL (wo): commands
  localparam logic [7:0] RegControl = 8'h08;
  localparam logic [31:0] RegControlReset = 32'h00000000;
  localparam int ControlApplyLsb = 0;
  localparam int ControlApplyBits = 1;
  localparam int ControlClearLsb = 1;
  localparam int ControlClearBits = 1;

  // STATUS (ro): present state
  localparam logic [7:0] RegStatus = 8'h09;
  localparam logic [31:0] RegStatusReset = 32'h00000000;
  localparam int StatusPendingLsb = 0;
  localparam int StatusPendingBits = 1;
  localparam int StatusBusyLsb = 1;
  localparam int StatusBusyBits = 1;
  localparam int StatusUploadingLsb = 2;
  localparam int StatusUploadingBits = 1;

  // ERRORS (w1c): errors since they were last cleared
  localparam logic [7:0] RegErrors = 8'h0A;
  localparam logic [31:0] RegErrorsReset = 32'h00000000;
  localparam int ErrorsCutFrameLsb = 0;
  localparam int ErrorsCutFrameBits = 1;
  localparam int ErrorsLongFrameLsb = 1;
  localparam int ErrorsLongFrameBits = 1;
  localparam int ErrorsBufferLeftLsb = 2;
  localparam int ErrorsBufferLeftBits = 1;
  localparam int ErrorsBufferRightLsb = 3;
  localparam int ErrorsBufferRightBits = 1;
  localparam int ErrorsConfigLsb = 4;
  localparam int ErrorsConfigBits = 1;
  localparam int ErrorsLabelsLsb = 5;
  localparam int ErrorsLabelsBits = 1;

  // WIDTH (rw): image width, GatewareMinWidth to BUILD.max_width
  localparam logic [7:0] RegWidth = 8'h10;
  localparam logic [31:0] RegWidthReset = 32'h00000280;
  localparam int WidthPixelsLsb = 0;
  localparam int WidthPixelsBits = 12;

  // HEIGHT (rw): image height, 1 to GatewareMaxHeight
  localparam logic [7:0] RegHeight = 8'h11;
  localparam logic [31:0] RegHeightReset = 32'h000001E0;
  localparam int HeightRowsLsb = 0;
  localparam int HeightRowsBits = 12;

  // READ_START (rw): delay T_s of rectify = rows x WIDTH + pixels
  localparam logic [7:0] RegReadStart = 8'h12;
  localparam logic [31:0] RegReadStartReset = 32'h00010002;
  localparam int ReadStartPixelsLsb = 0;
  localparam int ReadStartPixelsBits = 12;
  localparam int ReadStartRowsLsb = 16;
  localparam int ReadStartRowsBits = 8;

  // FLAGS (rw): switches of the stages
  localparam logic [7:0] RegFlags = 8'h13;
  localparam logic [31:0] RegFlagsReset = 32'h00000007;
  localparam int FlagsLeftRightCheckLsb = 0;
  localparam int FlagsLeftRightCheckBits = 1;
  localparam int FlagsUniquenessCheckLsb = 1;
  localparam int FlagsUniquenessCheckBits = 1;
  localparam int FlagsSubpixelLsb = 2;
  localparam int FlagsSubpixelBits = 1;

  // DISP12_MAX_DIFF (rw): largest difference that the left-right check allows
  localparam logic [7:0] RegDisp12MaxDiff = 8'h14;
  localparam logic [31:0] RegDisp12MaxDiffReset = 32'h00000001;
  localparam int Disp12MaxDiffPixelsLsb = 0;
  localparam int Disp12MaxDiffPixelsBits = 8;

  // UNIQUENESS (rw): factor N of the uniqueness check = 256 (1 + uniqueness_ratio / 100), rounded
  localparam logic [7:0] RegUniqueness = 8'h15;
  localparam logic [31:0] RegUniquenessReset = 32'h00000154;
  localparam int UniquenessFactorLsb = 0;
  localparam int UniquenessFactorBits = 10;

  // SPECKLE_SIZE (rw): speckle drops regions of fewer pixels; 0 turns it off; up to SpeckleMax
  localparam logic [7:0] RegSpeckleSize = 8'h16;
  localparam logic [31:0] RegSpeckleSizeReset = 32'h00000028;
  localparam int SpeckleSizePixelsLsb = 0;
  localparam int SpeckleSizePixelsBits = 10;

  // SPECKLE_RANGE (rw): largest disparity step between neighbours of one region
  localparam logic [7:0] RegSpeckleRange = 8'h17;
  localparam logic [31:0] RegSpeckleRangeReset = 32'h00000020;
  localparam int SpeckleRangeUnitsLsb = 0;
  localparam int SpeckleRangeUnitsBits = 10;

  // MESH_ADDRESS (rw): node that the next write to MESH_DATA sets
  localparam logic [7:0] RegMeshAddress = 8'h20;
  localparam logic [31:0] RegMeshAddressReset = 32'h00000000;
  localparam int MeshAddressNodeLsb = 0;
  localparam int MeshAddressNodeBits = 16;
  localparam int MeshAddressCameraLsb = 16;
  localparam int MeshAddressCameraBits = 1;

  // MESH_DATA (wo): displacement of one node, source minus destination, in 1/MeshScale px, signed
  localparam logic [7:0] RegMeshData = 8'h21;
  localparam logic [31:0] RegMeshDataReset = 32'h00000000;
  localparam int MeshDataDxLsb = 0;
  localparam int MeshDataDxBits = 16;
  localparam int MeshDataDyLsb = 16;
  localparam int MeshDataDyBits = 16;

  // MESH_SIGNATURE (ro): signature (see Signatures) of the words written to MESH_DATA since the
  // last write to MESH_ADDRESS; the host verifies a mesh with it
  localparam logic [7:0] RegMeshSignature = 8'h22;
  localparam logic [31:0] RegMeshSignatureReset = 32'hFFFFFFFF;

  // FRAMES_IN (ro): frames that started at the input
  localparam logic [7:0] RegFramesIn = 8'h30;
  localparam logic [31:0] RegFramesInReset = 32'h00000000;

  // FRAMES_OUT (ro): frames whose last pixel left speckle
  localparam logic [7:0] RegFramesOut = 8'h31;
  localparam logic [31:0] RegFramesOutReset = 32'h00000000;

  // CUT_FRAMES (ro): frames with ERRORS.cut_frame
  localparam logic [7:0] RegCutFrames = 8'h32;
  localparam logic [31:0] RegCutFramesReset = 32'h00000000;

  // LONG_FRAMES (ro): frames with ERRORS.long_frame
  localparam logic [7:0] RegLongFrames = 8'h33;
  localparam logic [31:0] RegLongFramesReset = 32'h00000000;

  // BUFFER_ERRORS (ro): frames with ERRORS.buffer_left or buffer_right
  localparam logic [7:0] RegBufferErrors = 8'h34;
  localparam logic [31:0] RegBufferErrorsReset = 32'h00000000;

  // LABEL_EXHAUSTION (ro): frames with ERRORS.labels; always 0 in this design
  localparam logic [7:0] RegLabelExhaustion = 8'h35;
  localparam logic [31:0] RegLabelExhaustionReset = 32'h00000000;

  // MESH_UPLOADS (ro): applies that took effect after a mesh was written
  localparam logic [7:0] RegMeshUploads = 8'h36;
  localparam logic [31:0] RegMeshUploadsReset = 32'h00000000;

  // SIGNATURE_RECTIFY (ro): left << 8 ^ right
  localparam logic [7:0] RegSignatureRectify = 8'h40;
  localparam logic [31:0] RegSignatureRectifyReset = 32'h00000000;

  // SIGNATURE_CENSUS (ro): fold(left bits) ^ rol(fold(right bits), 16)
  localparam logic [7:0] RegSignatureCensus = 8'h41;
  localparam logic [31:0] RegSignatureCensusReset = 32'h00000000;

  // SIGNATURE_MATCH (ro): XOR over d of rol(S(x, y, d), d mod 32)
  localparam logic [7:0] RegSignatureMatch = 8'h42;
  localparam logic [31:0] RegSignatureMatchReset = 32'h00000000;

  // SIGNATURE_SELECT (ro): dL ^ dR << 8 ^ v1 << 16 ^ rol(v2, 8) ^ XOR over k = 0..4 of rol(C(k -
  // 2), 5 k)
  localparam logic [7:0] RegSignatureSelect = 8'h43;
  localparam logic [31:0] RegSignatureSelectReset = 32'h00000000;

  // SIGNATURE_CHECK (ro): 1 if the pixel is kept, else 0
  localparam logic [7:0] RegSignatureCheck = 8'h44;
  localparam logic [31:0] RegSignatureCheckReset = 32'h00000000;

  // SIGNATURE_SUBPIXEL (ro): the disparity
  localparam logic [7:0] RegSignatureSubpixel = 8'h45;
  localparam logic [31:0] RegSignatureSubpixelReset = 32'h00000000;

  // SIGNATURE_SPECKLE (ro): the disparity
  localparam logic [7:0] RegSignatureSpeckle = 8'h46;
  localparam logic [31:0] RegSignatureSpeckleReset = 32'h00000000;

  // BUILD_STREAMS (ro): streams that this build supports
  localparam logic [7:0] RegBuildStreams = 8'h60;
  localparam int BuildStreamsStreamsLsb = 0;
  localparam int BuildStreamsStreamsBits = 8;

  // BUILD_CLOCK (ro): pixel clock, Hz
  localparam logic [7:0] RegBuildClock = 8'h61;

  // STREAMS (rw): streams that the board sends: bit s stands for stream s
  localparam logic [7:0] RegStreams = 8'h62;
  localparam logic [31:0] RegStreamsReset = 32'h00000000;
  localparam int StreamsDisparityLsb = 1;
  localparam int StreamsDisparityBits = 1;
  localparam int StreamsRectifiedLeftLsb = 2;
  localparam int StreamsRectifiedLeftBits = 1;
  localparam int StreamsRectifiedRightLsb = 3;
  localparam int StreamsRectifiedRightBits = 1;
  localparam int StreamsRawLeftLsb = 4;
  localparam int StreamsRawLeftBits = 1;
  localparam int StreamsRawRightLsb = 5;
  localparam int StreamsRawRightBits = 1;

  // FRAME_INTERVAL (rw): how often frames are sent
  localparam logic [7:0] RegFrameInterval = 8'h63;
  localparam logic [31:0] RegFrameIntervalReset = 32'h00010001;
  localparam int FrameIntervalPairsLsb = 0;
  localparam int FrameIntervalPairsBits = 16;
  localparam int FrameIntervalRawLsb = 16;
  localparam int FrameIntervalRawBits = 16;

  // INPUT (rw): source of raw pixels
  localparam logic [7:0] RegInput = 8'h64;
  localparam logic [31:0] RegInputReset = 32'h00000000;
  localparam int InputHostLsb = 0;
  localparam int InputHostBits = 1;

  // MID_EXPOSURE (rw): time from the middle of the exposure to the first pixel; the board subtracts
  // it from timestamps
  localparam logic [7:0] RegMidExposure = 8'h65;
  localparam logic [31:0] RegMidExposureReset = 32'h00000000;
  localparam int MidExposureUsLsb = 0;
  localparam int MidExposureUsBits = 24;

  // CONFIGURATION (ro): configuration id: applies that took effect since the reset, modulo 2^32
  localparam logic [7:0] RegConfiguration = 8'h66;
  localparam logic [31:0] RegConfigurationReset = 32'h00000000;

  // FRAMES_DROPPED (ro): frames of any stream that the board dropped because the link was too slow,
  // since CONTROL.clear
  localparam logic [7:0] RegFramesDropped = 8'h67;
  localparam logic [31:0] RegFramesDroppedReset = 32'h00000000;

  // BAD_PACKETS (ro): sync words from the host without an intact packet, since CONTROL.clear
  localparam logic [7:0] RegBadPackets = 8'h68;
  localparam logic [31:0] RegBadPacketsReset = 32'h00000000;

  // LOST_PACKETS (ro): packets missing in the host's sequence, since CONTROL.clear
  localparam logic [7:0] RegLostPackets = 8'h69;
  localparam logic [31:0] RegLostPacketsReset = 32'h00000000;

  // INPUT_ERRORS (ro): pairs from the host without all rows or without a trailer, since
  // CONTROL.clear
  localparam logic [7:0] RegInputErrors = 8'h6A;
  localparam logic [31:0] RegInputErrorsReset = 32'h00000000;

  // The configuration vector: configuration registers side by side, the first one lowest. A field
  // begins at Config...Lsb and has the width of the register's field.
  localparam int ConfigWords = 8;
  localparam int ConfigBits = 256;
  localparam logic [255:0] ConfigMask = {  // bits that lie in a field
      32'h000003FF, 32'h000003FF, 32'h000003FF, 32'h000000FF, 32'h00000007, 32'h00FF0FFF,
      32'h00000FFF, 32'h00000FFF};
  localparam logic [255:0] ConfigReset = {
      RegSpeckleRangeReset, RegSpeckleSizeReset, RegUniquenessReset, RegDisp12MaxDiffReset,
      RegFlagsReset, RegReadStartReset, RegHeightReset, RegWidthReset};
  localparam int ConfigWidthPixelsLsb = 0;
  localparam int ConfigHeightRowsLsb = 32;
  localparam int ConfigReadStartPixelsLsb = 64;
  localparam int ConfigReadStartRowsLsb = 80;
  localparam int ConfigFlagsLeftRightCheckLsb = 96;
  localparam int ConfigFlagsUniquenessCheckLsb = 97;
  localparam int ConfigFlagsSubpixelLsb = 98;
  localparam int ConfigDisp12MaxDiffPixelsLsb = 128;
  localparam int ConfigUniquenessFactorLsb = 160;
  localparam int ConfigSpeckleSizePixelsLsb = 192;
  localparam int ConfigSpeckleRangeUnitsLsb = 224;
endpackage
/* verilator lint_on UNUSEDPARAM */
