// Holds the mesh of one camera and computes the displacement of each pixel of a row.
//
// Formula   column(i) = 8 n(i, j) + (n(i, j+1) - n(i, j)) fy, fy = y modulo 8          1/1024 px
//           m = 8 column(i) + (column(i+1) - column(i)) fx, fx = x modulo 8            1/8192 px
//           d*_o = (m + 128) >> 8                                                      1/32 px
//           The same logic computes dx and dy, one after the other.
// C++ twin  fpga_stereo::MeshRow (src/core/mesh.cpp)
// Schedule  stages of a column, counted for its second node:
//             6 address  7 read  8 register  9 node, selected from its chunk  10 difference
//             11-13 column, by Horner's rule  14 step from the previous column
//           stages of a pixel: 19 (dx: 21) start of a row or a cell, 20 (dx: 22) output.
//           m is a sum of steps; at the start of a cell it equals 8 column(i).
//           The rounding constant 128 is 16 in every column, or 2 in every node.
// Latency   as above; fs_rectify schedules the reads.
// Limits    result_i in stage 13 for each column, dy before dx; step_dy_i, step_dx_i with it except
//           for column 0. A step must not come before the start of the cell that uses the previous
//           step.
//           The mesh is 0 (identity) after the FPGA is configured. Node and coordinate form the
//           address: {node, dy}. A chunk of 1024 nodes is 2 block RAMs of 18 kbit, read 8 bits
//           wide.
module fs_rectify_mesh #(
  parameter int MeshNodes = 5120
) (
  input  logic        clk_i,
  input  logic        en_i,
  input  logic        we_i,    // independent of en_i
  input  logic [15:0] write_node_i,
  input  logic [31:0] data_i,
  input  logic [15:0] node_i,       // stage 6
  input  logic        node_dy_i,    // stage 6
  input  logic [2:0]  fraction_i,   // stage 10
  input  logic        result_i,     // stage 13
  input  logic        step_dy_i,    // stage 13
  input  logic        step_dx_i,    // stage 13
  input  logic        row_dy_i,     // stage 19
  input  logic        row_dx_i,     // stage 21
  input  logic        cell_dy_i,    // stage 19
  input  logic        cell_dx_i,    // stage 21
  output logic [14:0] dy_o,         // stage 20
  output logic [14:0] dx_o          // stage 22
);
  localparam int Node = fs_pkg::MeshBits;
  localparam int Chunks = (MeshNodes + 1023) / 1024;
  if (MeshNodes < 1 || MeshNodes > 65535)
    initial $fatal(1, "fs_rectify_mesh: MeshNodes is %0d, allowed: 1 to 65535", MeshNodes);

  logic [Node*Chunks-1:0] chunk_q;
  logic [5:0] block_q;
  logic [Chunks-1:0] select_q;
  always_ff @(posedge clk_i) begin
    if (en_i) block_q <= node_i[15:10];
  end
  for (genvar c = 0; c < Chunks; c++) begin : g_chunk
    (* no_rw_check *) logic [Node-1:0] memory[0:2047];
    logic [Node-1:0] read_q;
    initial for (int k = 0; k < 2048; k++) memory[k] = '0;  // identity
    always_ff @(posedge clk_i) begin
      if (we_i && write_node_i[15:10] == 6'(c)) begin
        memory[{write_node_i[9:0], 1'b0}] <= data_i[Node-1:0];
        memory[{write_node_i[9:0], 1'b1}] <= data_i[2*Node-1:Node];
      end
    end
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        read_q <= memory[{node_i[9:0], node_dy_i}];
        chunk_q[Node*c+:Node] <= read_q;
        select_q[c] <= block_q == 6'(c);
      end
    end
  end
  logic [Node-1:0] node;
  always_comb begin
    node = '0;
    for (int c = 0; c < Chunks; c++) node = node | ({Node{select_q[c]}} & chunk_q[Node*c+:Node]);
  end

  // Columns.
  logic [Node-1:0] node_q, upper_q;
  logic signed [Node:0] difference_q, difference_11_q, difference_12_q, base_q;
  logic signed [Node+1:0] column_11_q;
  logic signed [Node+2:0] column_12_q;
  logic signed [Node+3:0] column_q, before_1_q, before_2_q, before_3_q, step;
  logic [1:0] fraction_11_q;
  logic fraction_12_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      node_q <= node;
      upper_q <= node_q;
      difference_q <= (Node+1)'($signed(node_q)) - (Node+1)'($signed(upper_q));
      base_q <= (Node+1)'($signed(upper_q)) + (Node+1)'(2);
      column_11_q <= (Node+2)'({base_q, 1'b0})
                     + (fraction_i[2] ? (Node+2)'(difference_q) : '0);
      difference_11_q <= difference_q;
      fraction_11_q <= fraction_i[1:0];
      column_12_q <= {column_11_q, 1'b0}
                     + (fraction_11_q[1] ? (Node+3)'(difference_11_q) : '0);
      difference_12_q <= difference_11_q;
      fraction_12_q <= fraction_11_q[0];
      column_q <= {column_12_q, 1'b0} + (fraction_12_q ? (Node+4)'(difference_12_q) : '0);
      if (result_i) begin
        before_1_q <= column_q;
        before_2_q <= before_1_q;
        before_3_q <= before_2_q;
      end
    end
  end
  assign step = column_q - before_2_q;

  // Sum along the row. At its start before_3_q is column 0: column 1 was the last one computed.
  logic signed [Node+3:0] next_dy_q, next_dx_q, step_dy_q, step_dx_q;
  logic signed [Node+6:0] m_dy_q, m_dx_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (step_dy_i) next_dy_q <= step;
      if (step_dx_i) next_dx_q <= step;
      if (cell_dy_i) step_dy_q <= next_dy_q;
      if (cell_dx_i) step_dx_q <= next_dx_q;
      m_dy_q <= row_dy_i ? {before_3_q, 3'd0} : m_dy_q + (Node+7)'(step_dy_q);
      m_dx_q <= row_dx_i ? {before_3_q, 3'd0} : m_dx_q + (Node+7)'(step_dx_q);
    end
  end
  assign dy_o = m_dy_q[Node+6:8];
  assign dx_o = m_dx_q[Node+6:8];
endmodule
