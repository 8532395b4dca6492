// The register file: configuration (shadow and in effect), mesh upload, errors, counters,
// signatures.
//
// Formula   fpga_fw/spec/registers.md, generated from spec.yaml together with fs_pkg.
// C++ twin  fpga_stereo/core/spec.hpp (addresses, fields, reset values)
// Schedule  write_i  the register has its value in the next clock
//           read_i   read_valid_o and data_o in the next clock
//           apply    CONTROL.apply starts a range check of the shadow. In the clock after the check
//                    either pending_o goes high, or ERRORS.config is set and nothing else changes.
//                    When fs_input answers with apply_i, the whole shadow is copied in that clock.
//                    The shadow takes effect as it was at CONTROL.apply: a write to the shadow or
//                    to a mesh withdraws an apply that still waits; CONTROL.apply must then be
//                    written again.
//           meshes   MESH_DATA gives one clock of mesh_we_o. From then on until the next apply
//                    uploading_o is high: what is rectified meanwhile may come from parts of two
//                    meshes, so its frame is bad.
// Latency   1 clock.
// Handshake none: write_i and read_i are accepted in every clock, also together.
// Limits    out of range: WIDTH below the smallest that the stages allow or above MaxWidth, HEIGHT
//           0 or above GatewareMaxHeight, READ_START.pixels not below WIDTH, READ_START.rows not
//           below LineRows. Nodes from MeshNodes on are not written. An event in the same clock as
//           the clearing of its counter or error is counted.
module fs_registers #(
  parameter int MaxWidth = 640,
  parameter int Disparities = 64,
  parameter int CensusWindow = 11,
  parameter int CorrelationWindow = 15,
  parameter int CensusFull = 0,
  parameter int LineRows = 32,
  parameter int MeshNodes = 8192,
  localparam int NodeBits = $clog2(MeshNodes)
) (
  input  logic                           clk_i,
  input  logic                           rst_ni,
  // The bus.
  input  logic                           write_i,
  input  logic                           read_i,
  input  logic [7:0]                     address_i,
  input  logic [31:0]                    data_i,
  output logic                           read_valid_o,
  output logic [31:0]                    data_o,
  // The configuration in effect; field X begins at fs_pkg::ConfigXLsb.
  output logic [fs_pkg::ConfigBits-1:0]  config_o,
  // Handshake with fs_input for a change of the configuration.
  output logic                           pending_o,
  input  logic                           apply_i,
  // Meshes.
  output logic                           mesh_we_o,
  output logic                           mesh_right_o,
  output logic [NodeBits-1:0]            mesh_node_o,
  output logic [31:0]                    mesh_data_o,
  output logic                           uploading_o,
  // Events: pulses, except for busy_i, buffer_left_i, buffer_right_i, signatures_i.
  input  logic                           busy_i,
  input  logic                           frame_in_i,
  input  logic                           frame_out_i,
  input  logic                           cut_frame_i,
  input  logic                           long_frame_i,
  input  logic                           buffer_left_i,
  input  logic                           buffer_right_i,
  input  logic                           buffer_frame_i,
  input  logic [32*fs_pkg::NumStages-1:0] signatures_i
);
  // The running sum of match needs an image that is wider than the window.
  localparam int MinWidth = CorrelationWindow + 1 > fs_pkg::GatewareMinWidth ?
                            CorrelationWindow + 1 : fs_pkg::GatewareMinWidth;
  localparam int ResetWidth = MaxWidth < fs_pkg::RegWidthReset ? MaxWidth : fs_pkg::RegWidthReset;
  localparam logic [31:0] Build = 32'(MaxWidth) << fs_pkg::BuildMaxWidthLsb |
                                  32'(Disparities % 256) << fs_pkg::BuildDisparitiesLsb |
                                  32'(CensusWindow) << fs_pkg::BuildCensusWindowLsb |
                                  32'(CorrelationWindow) << fs_pkg::BuildCorrelationWindowLsb |
                                  32'(CensusFull != 0 ? 1 : 0) << fs_pkg::BuildCensusFullLsb;
  if (MaxWidth < MinWidth || MaxWidth > fs_pkg::GatewareMaxWidth)
    initial $fatal(1, "fs_registers: MaxWidth is %0d, allowed: %0d to %0d", MaxWidth, MinWidth,
                   fs_pkg::GatewareMaxWidth);
  if (LineRows < 2 || LineRows > 256)
    initial $fatal(1, "fs_registers: LineRows is %0d, allowed: 2 to 256", LineRows);
  if (MeshNodes < 2 || MeshNodes > 65536)
    initial $fatal(1, "fs_registers: MeshNodes is %0d, allowed: 2 to 65536", MeshNodes);

  // Each group begins at a multiple of its size, so that no address has to be subtracted.
  // generate_spec checks this for the configuration; the other groups have up to eight registers.
  if (fs_pkg::RegFramesIn % 8 != 0 || fs_pkg::RegSignatureRectify % 8 != 0)
    initial $fatal(1, "fs_registers: a group of registers does not begin at a multiple of 8");
  localparam int Words = fs_pkg::ConfigWords;
  localparam int WordBits = $clog2(Words);
  logic [2:0] word;
  logic [WordBits-1:0] shadow_word;
  logic at_shadow, at_counters, at_signatures;
  assign word = address_i[2:0];
  assign shadow_word = address_i[WordBits-1:0];
  assign at_shadow = address_i >> WordBits == fs_pkg::RegWidth >> WordBits &
                     {1'b0, shadow_word} < (WordBits + 1)'(Words);
  assign at_counters = address_i >> 3 == fs_pkg::RegFramesIn >> 3;
  assign at_signatures = address_i >> 3 == fs_pkg::RegSignatureRectify >> 3;

  logic write_control, clear, write_mesh;
  assign write_control = write_i & address_i == fs_pkg::RegControl;
  assign clear = write_control & data_i[fs_pkg::ControlClearLsb];
  assign write_mesh = write_i & address_i == fs_pkg::RegMeshData;

  // The shadow and the configuration in effect; bits outside all fields stay 0.
  localparam int Bits = fs_pkg::ConfigBits;
  localparam int Width = fs_pkg::ConfigWidthPixelsLsb;
  localparam int Height = fs_pkg::ConfigHeightRowsLsb;
  localparam int ReadPixels = fs_pkg::ConfigReadStartPixelsLsb;
  localparam int ReadRows = fs_pkg::ConfigReadStartRowsLsb;
  localparam logic [Bits-1:0] Mask = fs_pkg::ConfigMask;
  localparam logic [Bits-1:0] FirstValue = fs_pkg::ConfigReset;
  logic [Bits-1:0] shadow_q, active_q;

  logic write_shadow;
  assign write_shadow = write_i & at_shadow;
  for (genvar i = 0; i < Words; i++) begin : g_word
    always_ff @(posedge clk_i) begin
      if (!rst_ni) shadow_q[32*i+:32] <= FirstValue[32*i+:32];
      else if (write_shadow & shadow_word == WordBits'(i))
        shadow_q[32*i+:32] <= data_i & Mask[32*i+:32];
    end
  end

  // The range check sees the shadow one clock late; it is evaluated one clock after CONTROL.apply.
  logic [11:0] width, height, read_pixels;
  logic [7:0] read_rows;
  assign width = shadow_q[Width+:12];
  assign height = shadow_q[Height+:12];
  assign read_pixels = shadow_q[ReadPixels+:12];
  assign read_rows = shadow_q[ReadRows+:8];
  logic width_ok_q, height_ok_q, pixels_ok_q, rows_ok_q, check_q, pending_q, ok;
  assign ok = width_ok_q & height_ok_q & pixels_ok_q & rows_ok_q;
  always_ff @(posedge clk_i) begin
    width_ok_q <= width >= 12'(MinWidth) & width <= 12'(MaxWidth);
    height_ok_q <= height >= 12'd1 & height <= 12'(fs_pkg::GatewareMaxHeight);
    pixels_ok_q <= read_pixels < width;
    rows_ok_q <= {1'b0, read_rows} < 9'(LineRows);
  end

  logic apply;
  assign apply = apply_i & pending_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      active_q <= FirstValue;
      active_q[Width+:12] <= 12'(ResetWidth);
      check_q <= 1'b0;
      pending_q <= 1'b0;
      uploading_o <= 1'b0;
    end else begin
      if (apply) active_q <= shadow_q;
      check_q <= write_control & data_i[fs_pkg::ControlApplyLsb];
      pending_q <= (check_q ? ok : pending_q & ~apply) & ~write_shadow & ~write_mesh;
      uploading_o <= mesh_we_o | (uploading_o & ~apply);
    end
  end
  assign pending_o = pending_q;
  assign config_o = active_q;

  // Meshes.
  logic [15:0] node_q;
  logic right_q;
  logic [31:0] mesh_signature_q;
  always_ff @(posedge clk_i) begin
    if (write_i & address_i == fs_pkg::RegMeshAddress) begin
      node_q <= 16'(data_i >> fs_pkg::MeshAddressNodeLsb);
      right_q <= data_i[fs_pkg::MeshAddressCameraLsb];
    end else if (write_mesh) begin
      node_q <= node_q + 16'd1;
    end
    if (write_i & address_i == fs_pkg::RegMeshAddress)
      mesh_signature_q <= fs_pkg::SignatureStart;
    else if (write_mesh)
      mesh_signature_q <= (mesh_signature_q << 1) ^
          (mesh_signature_q[31] ? fs_pkg::SignaturePolynomial : '0) ^ data_i;
    mesh_we_o <= rst_ni & write_mesh & {1'b0, node_q} < 17'(MeshNodes);
    mesh_right_o <= right_q;
    mesh_node_o <= NodeBits'(node_q);
    mesh_data_o <= data_i;
    if (!rst_ni) begin
      node_q <= '0;
      right_q <= 1'b0;
      mesh_signature_q <= fs_pkg::SignatureStart;
    end
  end

  // Errors and counters.
  localparam int ErrorBits = fs_pkg::ErrorsLabelsLsb + 1;
  logic [ErrorBits-1:0] errors_q, raised, cleared;
  always_comb begin
    raised = '0;
    raised[fs_pkg::ErrorsCutFrameLsb] = cut_frame_i;
    raised[fs_pkg::ErrorsLongFrameLsb] = long_frame_i;
    raised[fs_pkg::ErrorsBufferLeftLsb] = buffer_left_i;
    raised[fs_pkg::ErrorsBufferRightLsb] = buffer_right_i;
    raised[fs_pkg::ErrorsConfigLsb] = check_q & ~ok;
    cleared = clear ? '1 : '0;
    if (write_i & address_i == fs_pkg::RegErrors) cleared = ErrorBits'(data_i);
  end
  always_ff @(posedge clk_i) begin
    if (!rst_ni) errors_q <= '0;
    else errors_q <= (errors_q & ~cleared) | raised;
  end

  // In the order of their registers, from RegFramesIn on.
  localparam int Counters = 32'(fs_pkg::RegMeshUploads) - 32'(fs_pkg::RegFramesIn) + 1;
  logic [Counters-1:0] events;
  logic [32*Counters-1:0] counters_q;
  always_comb begin
    events = '0;
    events[3'(fs_pkg::RegFramesIn-fs_pkg::RegFramesIn)] = frame_in_i;
    events[3'(fs_pkg::RegFramesOut-fs_pkg::RegFramesIn)] = frame_out_i;
    events[3'(fs_pkg::RegCutFrames-fs_pkg::RegFramesIn)] = cut_frame_i;
    events[3'(fs_pkg::RegLongFrames-fs_pkg::RegFramesIn)] = long_frame_i;
    events[3'(fs_pkg::RegBufferErrors-fs_pkg::RegFramesIn)] = buffer_frame_i;
    events[3'(fs_pkg::RegMeshUploads-fs_pkg::RegFramesIn)] = apply & uploading_o;
  end
  for (genvar i = 0; i < Counters; i++) begin : g_counter
    always_ff @(posedge clk_i) begin
      if (!rst_ni) counters_q[32*i+:32] <= '0;
      else if (clear) counters_q[32*i+:32] <= 32'(events[i]);
      else if (events[i]) counters_q[32*i+:32] <= counters_q[32*i+:32] + 32'd1;
    end
  end

  // Reading.
  logic [31:0] value;
  logic [32*8-1:0] counters, signatures;  // padded to whole groups
  logic [32*2**WordBits-1:0] shadow;      // likewise
  assign counters = (32 * 8)'(counters_q);
  assign signatures = (32 * 8)'(signatures_i);
  assign shadow = (32 * 2**WordBits)'(shadow_q);
  always_comb begin
    value = '0;
    case (address_i)
      fs_pkg::RegIdentity: value = fs_pkg::RegIdentityReset;
      fs_pkg::RegSpecHash: value = fs_pkg::RegSpecHashReset;
      fs_pkg::RegVersion: value = fs_pkg::RegVersionReset;
      fs_pkg::RegBuild: value = Build;
      fs_pkg::RegBuildLineRows: value = 32'(LineRows);
      fs_pkg::RegBuildMeshNodes: value = 32'(MeshNodes);
      fs_pkg::RegStatus: begin
        value[fs_pkg::StatusPendingLsb] = pending_q | check_q;
        value[fs_pkg::StatusBusyLsb] = busy_i;
        value[fs_pkg::StatusUploadingLsb] = uploading_o;
      end
      fs_pkg::RegErrors: value = 32'(errors_q);
      fs_pkg::RegMeshAddress:
        value = 32'(node_q) << fs_pkg::MeshAddressNodeLsb |
                32'(right_q) << fs_pkg::MeshAddressCameraLsb;
      fs_pkg::RegMeshSignature: value = mesh_signature_q;
      default: ;
    endcase
    if (at_shadow) value = shadow[32*shadow_word+:32];
    if (at_counters) value = counters[32*word+:32];
    if (at_signatures) value = signatures[32*word+:32];
  end
  always_ff @(posedge clk_i) begin
    read_valid_o <= rst_ni & read_i;
    if (read_i) data_o <= value;
  end
endmodule
