// A ring in block RAM with read-ahead, up to the end of the complete data.
//
// Formula   the words at read positions from 0 on, or after jump_i from to_i on, up to end_i
// C++ twin  none
// Schedule  clock 1, 2: block RAM and its output register; clock 3: fs_stream_fifo
// Latency   3 clocks from end_i to valid_o
// Handshake Stream out. A written word stays until its place is written again; read_o is the next
//           position to be read, which may be some words ahead of the words taken.
//           jump_i discards the words read ahead; valid_o is low in the next clock.
// Limits    Words is a power of two. A position has one bit more than a place in the ring.
module fs_ring_reader #(
  parameter int Bits = 32,
  parameter int Words = 2048,
  localparam int Pointer = $clog2(Words) + 1
) (
  input  logic               clk_i,
  input  logic               rst_ni,
  input  logic               write_i,
  input  logic [Pointer-1:0] at_i,
  input  logic [Bits-1:0]    data_i,
  input  logic [Pointer-1:0] end_i,
  input  logic               jump_i,
  input  logic [Pointer-1:0] to_i,
  output logic [Pointer-1:0] read_o,
  output logic               valid_o,
  input  logic               ready_i,
  output logic [Bits-1:0]    data_o
);
  localparam int Ahead = 8, OnTheWay = 3;
  // A word is read in the clock after its write at the earliest; what is read before is discarded.
  (* no_rw_check *) logic [Bits-1:0] ring[0:Words-1];
  logic [Bits-1:0] ring_q, ring_qq;
  logic [Pointer-1:0] read_q;
  logic read, read_1q, read_2q, unused_ready;
  logic [$clog2(Ahead):0] ahead;
  assign read = read_q != end_i & ahead <= ($clog2(Ahead) + 1)'(Ahead - OnTheWay);
  assign read_o = read_q;
  always_ff @(posedge clk_i) begin
    if (write_i) ring[at_i[Pointer-2:0]] <= data_i;
    ring_q <= ring[read_q[Pointer-2:0]];
    ring_qq <= ring_q;
    read_1q <= rst_ni & read & ~jump_i;
    read_2q <= rst_ni & read_1q & ~jump_i;
    if (!rst_ni) read_q <= '0;
    else if (jump_i) read_q <= to_i;
    else if (read) read_q <= read_q + 1'b1;
  end
  fs_stream_fifo #(.Bits(Bits), .Depth(Ahead)) u_ahead (
    .clk_i, .rst_ni(rst_ni & ~jump_i), .valid_i(read_2q), .ready_o(unused_ready),
    .data_i(ring_qq), .valid_o, .ready_i, .data_o, .count_o(ahead)
  );
  logic unused;
  assign unused = at_i[Pointer-1];
endmodule
