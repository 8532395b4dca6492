// FIFO in block RAM between two streams (defined in fs_stream_fifo.sv) of one clock.
//
// Formula   words out = words in
// C++ twin  test/rtl/link/camera_test.cpp, as part of fs_cameras
// Schedule  clock 1: a word enters the ring; 2, 3: block RAM and its output register;
//           4, 5: fs_stream_fifo (fs_ring_reader)
// Latency   5 clocks when empty; one word per clock in and out.
// Handshake Stream on both sides. All outputs are registered: no combinational path leads from one
//           side to the other. During reset ready_o is low.
// Limits    Depth: a power of two, 16 or more. At least Depth - 4 words fit.
module fs_block_fifo #(
  parameter int Bits = 18,
  parameter int Depth = 1024
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            valid_i,
  output logic            ready_o,
  input  logic [Bits-1:0] data_i,
  output logic            valid_o,
  input  logic            ready_i,
  output logic [Bits-1:0] data_o
);
  localparam int Pointer = $clog2(Depth) + 1;
  if (Depth < 16 || Depth != 1 << (Pointer - 1))
    initial $fatal(1, "fs_block_fifo: Depth is %0d, allowed: 16, 32, ..", Depth);

  logic [Pointer-1:0] write_q, read, used_q;
  logic write, ready_q;
  assign write = valid_i & ready_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) write_q <= '0;
    else if (write) write_q <= write_q + 1'b1;
    // Two clocks late: as many words may come meanwhile.
    used_q <= write_q - read;
    ready_q <= rst_ni & used_q <= Pointer'(Depth - 4);
  end
  assign ready_o = ready_q;

  fs_ring_reader #(.Bits(Bits), .Words(Depth)) u_ring (
    .clk_i, .rst_ni, .write_i(write), .at_i(write_q), .data_i, .end_i(write_q), .jump_i(1'b0),
    .to_i(Pointer'(0)), .read_o(read), .valid_o, .ready_i, .data_o
  );
endmodule
