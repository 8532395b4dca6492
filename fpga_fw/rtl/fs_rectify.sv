// Rectifies both raw images onto common rows: interpolates each rectified pixel from four raw ones
// at the position given by the camera's mesh.
//
// Formula   pipeline.md "rectify" and "Line buffer"; exact for every mesh of 16-bit nodes
// C++ twin  fpga_stereo::rectify (src/core/rectify.cpp); line_buffer_need() gives T_s and rows
// Schedule  stage s of a rectified pixel n is the tick s ticks after the raw pixel n + T_s came in:
//
//              1-3   raw row and column; rectified rows begin T_s after the raw rows
//              4     row of the mesh
//              5-8   mesh reads, two cells ahead: column i = nodes (i, j) and (i, j + 1), dy first
//              9-13  column(i)                               (fs_rectify_mesh)
//              20    displacement dy, 22: dx                 (fs_rectify_mesh)
//              21-25 position, inside, errors                (fs_rectify_camera)
//              24-29 four taps                               (fs_rectify_buffer)
//              30-35 bilinear                                (fs_rectify_camera)
//           and raw pixel n + T_s is written at the end of stage 11.
//           Ticks at which nodes are read, counted from the start of a row (four reads a column):
//             0-3 column 0, 4-7 column 1, 9-12 column 2, 13-16 column 3, 8 k + 21 .. 24 column
//             k + 4: so the last column is read by the tick of pixel W - 1, and the step to each
//             column is known only after the previous step has been used.
// Latency   T_s + LatencyTicks ticks; T_s = read_rows_i * width_i + read_pixels_i.
// Handshake The raster (see fs_top); only sof and height_i decide which rows belong to a frame.
//           left_error_o, right_error_o: come with the pixel; one of its taps was in the raw image
//           but not in the buffer, or its mesh row is not entirely in the mesh memory. With
//           k = raster number of the tap - raster number of its pixel, a tap is in the buffer iff
//             T_s - (LineRows - 1) * width_i <= k < T_s
//           A host may send a map iff line_buffer_need() gives at most LineRows - 1 rows for T_s.
// Limits    width_i 16..MaxWidth, height_i 1..1200, T_s >= 0 with any read_pixels_i < width_i and
//           read_rows_i < 2^ceil(log2(LineRows + 1)). The rows of the ring hold raster rows,
//           bubble rows included, so short frames and odd heights waste none of it.
//           The mesh has ceil(W/8)+1 nodes a row; node (i, j) is at j * (ceil(W/8)+1) + i. Its
//           write port goes straight to memory: drive it from registers. It takes one node per
//           clock, independent of en_i and rst_ni. What is then rectified of a frame inside may be
//           wrong. Settings may change while no frame is inside. The rows output around a change
//           of width_i or T_s may have any length.
module fs_rectify #(
  parameter int MaxWidth = 640,
  parameter int LineRows = 102,
  parameter int MeshNodes = 5120,
  parameter int Copies = 1  // of the tick: position logic, then per camera the rest and its mesh
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic [Copies-1:0] en_i,
  input  logic [11:0] width_i,
  input  logic [11:0] height_i,
  input  logic [7:0]  read_rows_i,
  input  logic [11:0] read_pixels_i,
  input  logic        mesh_we_i,
  input  logic        mesh_right_i,
  input  logic [15:0] mesh_node_i,
  input  logic [31:0] mesh_data_i,  // {dy, dx}
  input  logic        valid_i,
  input  logic        sof_i,
  input  logic        sol_i,
  input  logic [7:0]  left_i,
  input  logic [7:0]  right_i,
  output logic        valid_o,
  output logic        sof_o,
  output logic        sol_o,
  output logic [7:0]  left_o,
  output logic [7:0]  right_o,
  output logic        left_error_o,
  output logic        right_error_o
);
  localparam int LatencyTicks = 35;  // beyond T_s
  localparam int WriteStage = 11;
  localparam int ReadStage = 26;     // of the buffer
  localparam int RowBits = $clog2(LineRows + 1);
  localparam int RingBits = $clog2(LineRows);
  localparam int HalfWidth = (MaxWidth + 1) / 2;
  localparam int HalfBits = $clog2(HalfWidth + 1);
  localparam int BankBits = $clog2(LineRows / 2 * HalfWidth);
  if (MaxWidth < fs_pkg::GatewareMinWidth || MaxWidth > fs_pkg::GatewareMaxWidth)
    initial $fatal(1, "fs_rectify: MaxWidth is %0d, allowed: %0d to %0d", MaxWidth,
                   fs_pkg::GatewareMinWidth, fs_pkg::GatewareMaxWidth);
  if (LineRows < 4 || LineRows > 254 || LineRows % 2 != 0)
    initial $fatal(1, "fs_rectify: LineRows is %0d, allowed: even, 4 to 254", LineRows);

  // The oldest row promised to the reader is overwritten one row after its last read at T_s.
  if (ReadStage < WriteStage || ReadStage - WriteStage >= fs_pkg::GatewareMinWidth)
    initial $fatal(1, "fs_rectify: reads must come 0 to %0d ticks after writes",
                   fs_pkg::GatewareMinWidth - 1);

  // Values derived from the settings.
  logic [HalfBits-1:0] half_q;    // ceil(W / 2), words of a row in a bank
  logic [9:0] stride_q;           // nodes in a row of the mesh
  logic [11:0] wrap_q, no_wrap_q; // x - column of the writer, in the rows after and before its wrap
  always_ff @(posedge clk_i) begin
    half_q <= HalfBits'((width_i + 12'd1) >> 1);
    stride_q <= 10'((width_i + 12'd7) >> 3) + 10'd1;
    wrap_q <= width_i - read_pixels_i;
    no_wrap_q <= -read_pixels_i;
  end

  // Raw rows: bit s belongs to stage s. Column in stage 2.
  logic [21:1] raw_sol_q;
  logic raw_sof_q, running_q;
  logic [11:0] raw_column_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      raw_sol_q <= '0;
      raw_sof_q <= 1'b0;
      running_q <= 1'b0;
    end else if (en_i[0]) begin
      raw_sol_q <= {raw_sol_q[20:1], sol_i};
      raw_sof_q <= valid_i & sof_i;
      running_q <= running_q | raw_sol_q[1];
    end
    if (en_i[0]) raw_column_q <= raw_sol_q[1] ? '0 : raw_column_q + 12'd1;
  end

  // Detects the first rectified row of a frame: delays the rows' sof flags by read_rows_i rows,
  // with one delay per power of two; the upper ones work one tick later.
  localparam int Split = RowBits / 2;
  logic [RowBits:0] late_sof /* verilator split_var */;
  logic middle_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) middle_q <= 1'b0;
    else if (en_i[0]) middle_q <= late_sof[Split];
  end
  for (genvar k = 0; k < RowBits; k++) begin : g_rows
    logic [(1<<k)-1:0] rows_q;
    logic in, move;
    assign in = k == Split ? middle_q : late_sof[k];
    assign move = k < Split ? raw_sol_q[1] : raw_sol_q[2];
    always_ff @(posedge clk_i) begin
      if (!rst_ni) rows_q <= '0;
      else if (en_i[0] && move) rows_q <= (1<<k)'({rows_q, in});
    end
    assign late_sof[k+1] = read_rows_i[k] ? rows_q[(1<<k)-1] : in;
  end
  if (RowBits < 8) begin : g_unused
    logic unused;
    assign unused = ^read_rows_i[7:RowBits];
  end
  logic row_sof_q;
  assign late_sof[0] = row_sof_q;

  // Rectified rows: bit s of sol and sof belongs to stage s.
  logic [LatencyTicks:3] sol_q;
  logic [LatencyTicks:4] sof_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      row_sof_q <= 1'b0;
      sol_q <= '0;
      sof_q <= '0;
    end else if (en_i[0]) begin
      if (raw_sol_q[1]) row_sof_q <= raw_sof_q;
      sol_q <= {sol_q[LatencyTicks-1:3], running_q && raw_column_q == read_pixels_i};
      sof_q <= {sof_q[LatencyTicks-1:4], sol_q[3] & late_sof[RowBits]};
    end
  end

  // Mesh reads. Stage 5: node to read; stage 6: address.
  logic [2:0] fraction_q;               // y modulo 8
  logic [15:0] upper_q, lower_q, next;  // addresses of the nodes (0, j), (0, j + 1), (0, j + 2)
  logic [2:0] phase_q;
  logic [1:0] cell_q;                   // counts 0, 1, then stays at 2
  logic pause_q, read;
  logic [8:0] column_q;
  assign next = lower_q + 16'(stride_q);
  assign read = !pause_q && (!cell_q[1] || phase_q[2]);
  logic [15:0] node_q;
  logic node_dy_q;
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      if (sol_q[4]) begin
        phase_q <= '0;
        cell_q <= '0;
        pause_q <= 1'b0;
        column_q <= '0;
        if (sof_q[4]) begin
          fraction_q <= '0;
          upper_q <= '0;
          lower_q <= 16'(stride_q);
        end else begin
          fraction_q <= fraction_q + 3'd1;
          if (&fraction_q) begin
            upper_q <= lower_q;
            lower_q <= next;
          end
        end
      end else if (pause_q) begin
        pause_q <= 1'b0;
      end else begin
        phase_q <= phase_q + 3'd1;
        if (&phase_q) begin
          cell_q <= cell_q[1] ? cell_q : cell_q + 2'd1;
          pause_q <= cell_q == '0;
        end
        if (read && &phase_q[1:0]) column_q <= column_q + 9'd1;
      end
      node_q <= (phase_q[0] ? lower_q : upper_q) + 16'(column_q);
      node_dy_q <= !phase_q[1];
    end
  end

  // Together with the second node of a column: y modulo 8 in stage 10, results in stage 13.
  logic [2:0] fraction_6_q, fraction_7_q, fraction_8_q, fraction_9_q, fraction_10_q;
  logic [13:6] result_q, result_dy_q, result_first_q;
  logic [24:6] mesh_over_q;  // the mesh row of the pixel in stage s is not entirely in memory
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      fraction_6_q <= fraction_q;
      fraction_7_q <= fraction_6_q;
      fraction_8_q <= fraction_7_q;
      fraction_9_q <= fraction_8_q;
      fraction_10_q <= fraction_9_q;
      result_q <= {result_q[12:6], read & phase_q[0]};
      result_dy_q <= {result_dy_q[12:6], !phase_q[1]};
      result_first_q <= {result_first_q[12:6], column_q == '0};
      mesh_over_q <= {mesh_over_q[23:6], next > 16'(MeshNodes)};
    end
  end

  // Position of the pixel. Stage 19: x modulo 8; stage 20: y; stage 22: x.
  logic [2:0] x_fraction_q;
  logic [21:19] cell_start;
  logic [20:19] cell_start_q;
  logic [11:0] y_q, rows_left_q, x_q, x_from_end_q, x_from_writer_q;
  logic [RowBits:0] lead_q;      // rows from the pixel's row to the writer's
  logic [RingBits-1:0] ring_q;   // row of the ring that is being written, stage 21
  logic [LatencyTicks:20] valid_q;
  assign cell_start = {cell_start_q, x_fraction_q == '0};
  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      x_fraction_q <= sol_q[18] ? '0 : x_fraction_q + 3'd1;
      cell_start_q <= cell_start[20:19];
      if (sol_q[19]) begin
        y_q <= sof_q[19] ? '0 : y_q + 12'd1;
        rows_left_q <= sof_q[19] ? height_i : rows_left_q - 12'd1;
        lead_q <= (RowBits+1)'(read_rows_i[RowBits-1:0]);
      end else if (raw_sol_q[19]) begin
        lead_q <= (RowBits+1)'(read_rows_i[RowBits-1:0]) + 1'b1;
      end
      x_q <= sol_q[21] ? '0 : x_q + 12'd1;
      x_from_end_q <= sol_q[21] ? -width_i : x_from_end_q + 12'd1;
      if (sol_q[21]) x_from_writer_q <= no_wrap_q;
      else if (raw_sol_q[21]) x_from_writer_q <= wrap_q;
    end
    if (!rst_ni) begin
      ring_q <= '0;
      valid_q <= '0;
    end else if (en_i[0]) begin
      if (raw_sol_q[20]) ring_q <= ring_q == RingBits'(LineRows - 1) ? '0 : ring_q + 1'b1;
      valid_q[LatencyTicks:21] <= valid_q[LatencyTicks-1:20];
      if (sol_q[19]) valid_q[20] <= sof_q[19] | (valid_q[20] & rows_left_q != 12'd1);
    end
  end
  // Write side. Stage 9: row of the ring; stage 10: its address, column; stage 11: address.
  logic [RingBits-1:0] write_ring_q;
  logic write_odd_q;
  logic [BankBits-1:0] write_base_q, write_address_q;
  logic [11:0] write_column_q;
  logic [3:0] write_bank_q;  // one-hot; index = {odd row, odd column}
  logic [16*WriteStage-1:0] raw_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      write_ring_q <= '0;
    end else if (en_i[0] && raw_sol_q[8]) begin
      write_ring_q <= write_ring_q == RingBits'(LineRows - 1) ? '0 : write_ring_q + 1'b1;
    end
    if (en_i[0]) begin
      write_base_q <= BankBits'(write_ring_q[RingBits-1:1] * half_q);
      write_odd_q <= write_ring_q[0];
      write_column_q <= raw_sol_q[9] ? '0 : write_column_q + 12'd1;
      write_address_q <= write_base_q + BankBits'(write_column_q[11:1]);
      write_bank_q <= 4'd1 << {write_odd_q, write_column_q[0]};
      raw_q <= {raw_q[16*(WriteStage-1)-1:0], right_i, left_i};
    end
  end

  logic [15:0] pixel;
  logic [1:0] error;
  for (genvar k = 0; k < 2; k++) begin : g_camera
    localparam int Camera = k;
    logic mesh_we;
    assign mesh_we = mesh_we_i && mesh_right_i == (Camera == 1);
    fs_rectify_camera #(
      .MaxWidth(MaxWidth), .LineRows(LineRows), .MeshNodes(MeshNodes)
    ) u_camera (
      .clk_i, .rst_ni, .en_i(en_i[(1+2*Camera)%Copies]), .mesh_en_i(en_i[(2+2*Camera)%Copies]),
      .half_i(half_q),
      .mesh_we_i(mesh_we), .mesh_node_i, .mesh_data_i,
      .node_i(node_q), .node_dy_i(node_dy_q),
      .fraction_i(fraction_10_q), .result_i(result_q[13]),
      .step_dy_i(result_q[13] & result_dy_q[13] & !result_first_q[13]),
      .step_dx_i(result_q[13] & !result_dy_q[13] & !result_first_q[13]),
      .row_dy_i(sol_q[19]), .row_dx_i(sol_q[21]),
      .cell_dy_i(cell_start[19]), .cell_dx_i(cell_start[21]),
      .lead_i(lead_q), .y_i(y_q), .rows_left_i(rows_left_q), .ring_i(ring_q),
      .x_i(x_q), .x_from_end_i(x_from_end_q), .x_from_writer_i(x_from_writer_q),
      .valid_i(valid_q[24]), .mesh_over_i(mesh_over_q[24]),
      .write_bank_i(write_bank_q), .write_address_i(write_address_q),
      .raw_i(raw_q[16*(WriteStage-1)+8*Camera+:8]),
      .pixel_o(pixel[8*Camera+:8]), .error_o(error[Camera])
    );
  end
  assign {right_o, left_o} = pixel;
  assign {right_error_o, left_error_o} = error;
  assign valid_o = valid_q[LatencyTicks];
  assign sof_o = sof_q[LatencyTicks];
  assign sol_o = sol_q[LatencyTicks];
endmodule
