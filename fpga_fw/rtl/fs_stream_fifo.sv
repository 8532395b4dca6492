// FIFO between two streams. This header defines a stream.
//
// Stream    valid, ready and a payload: data, and for images also sof (first pixel of a frame) and
//           eol (last pixel of a line). A word is transferred in each clock with valid and ready.
//           Once valid is high, valid and the payload stay unchanged until the transfer. ready may
//           change at any time and does not wait for valid. No blanking: a line may follow a line,
//           and a frame a frame, in the next clock.
// Formula   words out = words in
// Schedule  clock 1: a word enters the memory; clock 2: it moves to the output register.
// Latency   2 clocks when empty; one word per clock in and out.
// Handshake Stream on both sides. ready_o and data_o are registers: no combinational path leads
//           from one side to the other. During reset ready_o is high and incoming words are lost.
// Limits    Depth words in distributed RAM, a power of two, plus one in the output register.
module fs_stream_fifo #(
  parameter int Bits = 18,
  parameter int Depth = 16
) (
  input  logic                   clk_i,
  input  logic                   rst_ni,
  input  logic                   valid_i,
  output logic                   ready_o,
  input  logic [Bits-1:0]        data_i,
  output logic                   valid_o,
  input  logic                   ready_i,
  output logic [Bits-1:0]        data_o,
  output logic [$clog2(Depth):0] count_o  // words in the memory
);
  localparam int AddressBits = $clog2(Depth);
  if (Depth < 2 || Depth != 1 << AddressBits)
    initial $fatal(1, "fs_stream_fifo: Depth is %0d, allowed: 2, 4, 8, ..", Depth);

  (* ram_style = "distributed" *) logic [Bits-1:0] memory[0:Depth-1];
  logic [AddressBits-1:0] write_q, read_q;
  logic [AddressBits:0] count_q;
  logic [Bits-1:0] data_q;
  logic valid_q;

  logic write, read;
  assign ready_o = ~count_q[AddressBits];
  assign write = valid_i & ready_o;
  assign read = count_q != '0 & (~valid_q | ready_i);

  always_ff @(posedge clk_i) begin
    if (write) memory[write_q] <= data_i;
    if (read) data_q <= memory[read_q];
    if (!rst_ni) begin
      write_q <= '0;
      read_q <= '0;
      count_q <= '0;
      valid_q <= 1'b0;
    end else begin
      if (write) write_q <= write_q + 1'b1;
      if (read) read_q <= read_q + 1'b1;
      if (write & ~read) count_q <= count_q + 1'b1;
      if (~write & read) count_q <= count_q - 1'b1;
      valid_q <= read | (valid_q & ~ready_i);
    end
  end
  assign valid_o = valid_q;
  assign data_o = data_q;
  assign count_o = count_q;
endmodule
