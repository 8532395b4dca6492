// Two delays in one dual-port block RAM: a whole lane below SplitBase, half a lane above it.
//
// Formula   a_o(t) = a_i(t - ring length - 2), b_o likewise
// Schedule  tick 0: reads the oldest word of the ring, then writes the newest in its place;
//           tick 1: register.
// Limits    The two regions do not overlap, so the ports never access the same address.
module fs_line_delay_pair #(
  parameter int Word = 18,
  parameter int Depth = 1024,
  parameter int SplitBase = 704
) (
  input  logic                     clk_i,
  input  logic                     en_i,
  input  logic [$clog2(Depth)-1:0] a_position_i,
  input  logic [Word-1:0]          a_i,
  output logic [Word-1:0]          a_o,
  input  logic [$clog2(Depth)-1:0] b_position_i,
  input  logic [Word-1:0]          b_i,
  output logic [Word-1:0]          b_o
);
  localparam int AddressBits = $clog2(Depth);
  (* no_rw_check *) logic [Word-1:0] memory[0:Depth-1];
  logic [Word-1:0] a_read_q, b_read_q;
  logic [AddressBits-1:0] b_address;
  assign b_address = AddressBits'(SplitBase) + b_position_i;

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      a_read_q <= memory[a_position_i];
      memory[a_position_i] <= a_i;
      a_o <= a_read_q;
    end
  end
  // A dual-port memory: each port has its own process.
  // verilator lint_off MULTIDRIVEN
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      b_read_q <= memory[b_address];
      memory[b_address] <= b_i;
      b_o <= b_read_q;
    end
  end
  // verilator lint_on MULTIDRIVEN
endmodule
