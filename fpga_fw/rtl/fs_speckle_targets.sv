// Finds, for each pixel, where its region continues one row below: the map from row r to row r+1.
//
// Formula   target_o[x] = target[name[x]] where the pixel x of row r has a region, else drop
// Schedule  Two tables swap at each row start: fs_speckle_area writes the table of its row, and the
//           table of the previous row is read. The names come back one row after they were output.
//             tick 9, 10: wait, as the last target may be written when the next row starts
//             tick 11: the table is read     12: RAM register       13: selection
// Latency   5 ticks (output: tick 14).
module fs_speckle_targets #(
  parameter int WordBits = 8
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                en_i,
  input  logic                first_i,         // tick 10: row start
  input  logic                write_i,         // tick 11
  input  logic [WordBits+1:0] write_name_i,
  input  logic [WordBits+1:0] write_target_i,
  input  logic [WordBits+1:0] name_i,          // tick 9; slot 3: no region
  output logic [WordBits+1:0] target_o
);
  localparam int Bits = WordBits + 2;
  localparam logic [Bits-1:0] Drop = Bits'(3);

  logic odd_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) odd_q <= 1'b0;
    else if (en_i) odd_q <= odd_q ^ first_i;
  end

  (* no_rw_check *) logic [Bits-1:0] memory[0:2**(Bits+1)-1];
  logic [Bits-1:0] name_10_q, name_11_q, read_q, target_q;
  logic none_12_q, none_13_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (write_i) memory[{odd_q, write_name_i}] <= write_target_i;
      name_10_q <= name_i;
      name_11_q <= name_10_q;
      read_q <= memory[{~odd_q, name_11_q}];
      target_q <= read_q;
      none_12_q <= &name_11_q[1:0];
      none_13_q <= none_12_q;
      target_o <= none_13_q ? Drop : target_q;
    end
  end
endmodule
