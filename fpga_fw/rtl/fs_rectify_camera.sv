// One camera of rectify: mesh, line buffer, source position and interpolation.
//
// Formula   source = 32 (x, y) + displacement = 32 (u, v) + (a, b), 0 <= a, b < 32
//           pixel = ((32-b) ((32-a) I(u, v) + a I(u+1, v)) + b (... v+1 ...) + 512) >> 10
// C++ twin  rectify_row() in src/core/rectify.cpp
// Schedule  stages as in fs_rectify:
//             21     v, and v relative to the writer's row
//             22     rows inside the image and in the buffer; row of the ring before wrapping
//             23     row of the ring; u
//             24     columns inside; weights
//             25     error
//             24-29  fs_rectify_buffer
//             30-32  horizontal interpolation
//             33-35  vertical interpolation
//           The banks of the buffer hold even and odd rows and columns, so the weights are assigned
//           to even and odd as well and no tap has to be moved. A pixel is
//             even + weight (odd - even)
//           with the rounding constant inserted below the first product.
// Latency   35 stages.
// Limits    see fs_rectify. Distances from the writer are exact: with the writer at column c, R
//           rows below the pixel's row, T_s = R W + c - x. A tap at (u, v) has been written iff
//           (v - y, u) < (R, c), and is still held iff (v - y + LineRows - 1, u) >= (R, c); pairs
//           are compared row first.
module fs_rectify_camera #(
  parameter int MaxWidth = 640,
  parameter int LineRows = 102,
  parameter int MeshNodes = 5120,
  localparam int RowBits = $clog2(LineRows + 1),
  localparam int RingBits = $clog2(LineRows),
  localparam int HalfWidth = (MaxWidth + 1) / 2,
  localparam int HalfBits = $clog2(HalfWidth + 1),
  localparam int BankBits = $clog2(LineRows / 2 * HalfWidth)
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                en_i,
  input  logic                mesh_en_i,  // a copy of en_i
  input  logic [HalfBits-1:0] half_i,
  // Mesh: see fs_rectify_mesh.
  input  logic                mesh_we_i,
  input  logic [15:0]         mesh_node_i,
  input  logic [31:0]         mesh_data_i,
  input  logic [15:0]         node_i,
  input  logic                node_dy_i,
  input  logic [2:0]          fraction_i,
  input  logic                result_i,
  input  logic                step_dy_i,
  input  logic                step_dx_i,
  input  logic                row_dy_i,
  input  logic                row_dx_i,
  input  logic                cell_dy_i,
  input  logic                cell_dx_i,
  // Position of the pixel.
  input  logic [RowBits:0]    lead_i,           // stage 20: R
  input  logic [11:0]         y_i,              // stage 20
  input  logic [11:0]         rows_left_i,      // stage 20: H - y
  input  logic [RingBits-1:0] ring_i,           // stage 21: row of the ring that is being written
  input  logic [11:0]         x_i,              // stage 22
  input  logic [11:0]         x_from_end_i,     // stage 22: x - W
  input  logic [11:0]         x_from_writer_i,  // stage 22: x - c
  input  logic                valid_i,          // stage 24
  input  logic                mesh_over_i,      // stage 24
  // The writer, stage 11.
  input  logic [3:0]          write_bank_i,
  input  logic [BankBits-1:0] write_address_i,
  input  logic [7:0]          raw_i,
  output logic [7:0]          pixel_o,          // stage 35
  output logic                error_o           // stage 35
);
  logic [14:0] dy, dx;
  fs_rectify_mesh #(
    .MeshNodes(MeshNodes)
  ) u_mesh (
    .clk_i, .en_i(mesh_en_i),
    .we_i(mesh_we_i), .write_node_i(mesh_node_i), .data_i(mesh_data_i),
    .node_i, .node_dy_i, .fraction_i, .result_i, .step_dy_i, .step_dx_i,
    .row_dy_i, .row_dx_i, .cell_dy_i, .cell_dx_i, .dy_o(dy), .dx_o(dx)
  );

  // Vertical. Stage 21.
  logic signed [9:0] down_q;  // rows relative to the writer's row
  logic signed [11:0] v_q, v_from_end_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      down_q <= $signed(dy[14:5]) - 10'(lead_i);
      v_q <= 12'($signed(dy[14:5])) + $signed(y_i);
      v_from_end_q <= 12'($signed(dy[14:5])) - $signed(rows_left_i);
    end
  end
  // Stages 22 and 23, flags in 24.
  localparam logic signed [9:0] Oldest = 10'(1 - LineRows);
  logic upper_in, lower_in;
  logic [RingBits:0] ring_sum_q;
  logic [RingBits-1:0] row_q;
  logic upper_in_q, lower_in_q;
  logic [2:0] too_new_q, too_old_q, at_new_q, at_old_q, rows_in_q;  // [k]: stage 22 + k
  assign upper_in = !v_q[11] && v_from_end_q[11];
  assign lower_in = (!v_q[11] || &v_q) && v_from_end_q[11] && !(&v_from_end_q);
  logic upper_in_23_q, lower_in_23_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      upper_in_q <= upper_in;
      lower_in_q <= lower_in;
      upper_in_23_q <= upper_in_q;
      lower_in_23_q <= lower_in_q;
      // The lowest row that is in the image, and the uppermost.
      too_new_q <= {too_new_q[1:0], down_q > 0 || (down_q == 0 && lower_in)};
      at_new_q <= {at_new_q[1:0], lower_in ? down_q == -10'sd1 : down_q == 0};
      too_old_q <= {too_old_q[1:0],
                    down_q < Oldest - 10'sd1 || (down_q == Oldest - 10'sd1 && upper_in)};
      at_old_q <= {at_old_q[1:0], upper_in ? down_q == Oldest : down_q == Oldest - 10'sd1};
      rows_in_q <= {rows_in_q[1:0], upper_in | lower_in};
      ring_sum_q <= (RingBits+1)'(ring_i) + (RingBits+1)'(down_q);
      row_q <= ring_sum_q[RingBits-1:0] + (ring_sum_q[RingBits] ? RingBits'(LineRows) : '0);
    end
  end

  // Horizontal. Stage 23, flags in 24.
  logic signed [11:0] u_q, u_from_end_q, u_from_writer_q;
  logic left_in, right_in, left_in_q, right_in_q, column_odd_q, too_new_column_q, kept_column_q;
  assign left_in = !u_q[11] && u_from_end_q[11];
  assign right_in = (!u_q[11] || &u_q) && u_from_end_q[11] && !(&u_from_end_q);
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      u_q <= 12'($signed(dx[14:5])) + $signed(x_i);
      u_from_end_q <= 12'($signed(dx[14:5])) + $signed(x_from_end_i);
      u_from_writer_q <= 12'($signed(dx[14:5])) + $signed(x_from_writer_i);
      left_in_q <= left_in;
      right_in_q <= right_in;
      column_odd_q <= u_q[0];
      // The rightmost column that is in the image, and the leftmost.
      too_new_column_q <= !u_from_writer_q[11] || (right_in && &u_from_writer_q);
      kept_column_q <= left_in ? !u_from_writer_q[11] : &u_from_writer_q;
    end
  end

  // Stage 25.
  logic [35:25] error_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      error_q <= '0;
    end else if (en_i) begin
      error_q <= {error_q[34:25],
                  valid_i && (mesh_over_i
                              || (rows_in_q[2] && (left_in_q || right_in_q)
                                  && (too_new_q[2] || (at_new_q[2] && too_new_column_q)
                                      || too_old_q[2] || (at_old_q[2] && !kept_column_q))))};
    end
  end
  assign error_o = error_q[35];

  // Banks whose taps are inside the image. Rows in stage 24, columns in 25, both in 27 and 28.
  logic [1:0] rows_24_q, rows_25_q, rows_26_q, columns_25_q, columns_26_q;  // [1]: odd
  logic [3:0] inside_27_q, inside_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      rows_24_q <= row_q[0] ? {upper_in_23_q, lower_in_23_q} : {lower_in_23_q, upper_in_23_q};
      rows_25_q <= rows_24_q;
      rows_26_q <= rows_25_q;
      columns_25_q <= column_odd_q ? {left_in_q, right_in_q} : {right_in_q, left_in_q};
      columns_26_q <= columns_25_q;
      inside_27_q <= {{2{rows_26_q[1]}} & columns_26_q, {2{rows_26_q[0]}} & columns_26_q};
      inside_q <= inside_27_q;
    end
  end

  // Weights of the odd row and the odd column. From stage 24, delayed to 33 and 30.
  logic [4:0] b_21_q, b_22_q, b_23_q, a_23_q;
  logic [6*10-1:0] row_weight_q;
  logic [6*7-1:0] column_weight_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      b_21_q <= dy[4:0];
      b_22_q <= b_21_q;
      b_23_q <= b_22_q;
      a_23_q <= dx[4:0];
      row_weight_q <= {row_weight_q[6*9-1:0], row_q[0] ? 6'd32 - 6'(b_23_q) : 6'(b_23_q)};
      column_weight_q <= {column_weight_q[6*6-1:0], u_q[0] ? 6'd32 - 6'(a_23_q) : 6'(a_23_q)};
    end
  end
  logic signed [6:0] row_weight, column_weight;
  assign row_weight = {1'b0, row_weight_q[6*9+:6]};        // stage 33
  assign column_weight = {1'b0, column_weight_q[6*6+:6]};  // stage 30

  logic [31:0] taps;
  fs_rectify_buffer #(
    .MaxWidth(MaxWidth), .LineRows(LineRows)
  ) u_buffer (
    .clk_i, .en_i, .half_i, .write_bank_i, .write_address_i, .raw_i,
    .row_i(row_q), .column_i(u_q[HalfBits:0]), .inside_i(inside_q), .taps_o(taps)
  );

  // Interpolates along the even row and the odd row. Stage 32: 32 times the grey value, plus 16.
  logic [25:0] blend_q;
  for (genvar k = 0; k < 2; k++) begin : g_row
    logic signed [8:0] difference_q;
    logic signed [14:0] product_q;
    logic [7:0] even_30_q, even_31_q;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        difference_q <= $signed({1'b0, taps[16*k+8+:8]}) - $signed({1'b0, taps[16*k+:8]});
        even_30_q <= taps[16*k+:8];
        product_q <= 15'(difference_q * column_weight);
        even_31_q <= even_30_q;
        blend_q[13*k+:13] <= {even_31_q, 5'd16} + product_q[12:0];
      end
    end
    logic unused;
    assign unused = ^product_q[14:13];
  end

  // Interpolates between the rows. Stage 35.
  logic signed [13:0] difference_q;
  logic signed [19:0] product_q;
  logic [12:0] even_33_q, even_34_q;
  logic [17:0] sum_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      difference_q <= $signed({1'b0, blend_q[25:13]}) - $signed({1'b0, blend_q[12:0]});
      even_33_q <= blend_q[12:0];
      product_q <= 20'(difference_q * row_weight);
      even_34_q <= even_33_q;
      sum_q <= {even_34_q, 5'd0} + product_q[17:0];
    end
  end
  logic unused;
  assign unused = ^{product_q[19:18], sum_q[9:0]};
  assign pixel_o = sum_q[17:10];
endmodule
