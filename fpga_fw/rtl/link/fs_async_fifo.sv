// FIFO between two streams (defined in fs_stream_fifo.sv) in different clock domains.
//
// Formula   words out = words in
// C++ twin  std::deque in test/rtl/link/async_fifo_test.cpp; proved by fpga_fw/formal/async_fifo.sv
// Schedule  wr_clk 1     the word enters the memory, the write pointer advances
//           rd_clk 1..2  the pointer crosses as a Gray code: one of its bits changes per word, so
//                        the value seen is either the old one or the new one
//           rd_clk 3     the word moves to the output register
// Latency   3 clocks of rd_clk, 4 if the pointer arrives late; one word per clock in and out. Freed
//           room is seen with the same delay: with clocks of equal speed, a Depth of 16 suffices
//           for a word per clock.
// Handshake Stream on both sides. wr_ready_o, rd_valid_o and rd_data_o are registers.
// Reset     Either reset empties both sides; the words inside are lost, and rd_valid_o may fall
//           before its word has moved. No word is accepted or output until both sides have been
//           emptied and both clocks run. One signal crosses in each direction, each waiting for the
//           other:
//             write  down -(read is down, no reset)-> rise -(read is up)-> run
//                    run -(reset, or read asks)-> down
//             read   down -(write is up, no reset)-> up -(write is down)-> down
//                    up -(reset)-> asks -(write is down)-> down
//           A pointer returns to 0 only while the other side ignores it. A reset may be as short as
//           one clock, and come at any time.
// Limits    Depth: a power of two, 4 or more; more than 64 words are in block RAM. Flip-flops start
//           as 0, or both resets are low for some clocks of both.
module fs_async_fifo #(
  parameter int Bits = 32,
  parameter int Depth = 512
) (
  input  logic            wr_clk_i,
  input  logic            wr_rst_ni,
  input  logic            wr_valid_i,
  output logic            wr_ready_o,
  input  logic [Bits-1:0] wr_data_i,
  input  logic            rd_clk_i,
  input  logic            rd_rst_ni,
  output logic            rd_valid_o,
  input  logic            rd_ready_i,
  output logic [Bits-1:0] rd_data_o
);
  localparam int Address = $clog2(Depth);
  localparam int Pointer = Address + 1;  // words modulo 2 Depth
  if (Depth < 4 || Depth != 1 << Address)
    initial $fatal(1, "fs_async_fifo: Depth is %0d, allowed: 4, 8, 16, ..", Depth);

  // Signals of each side as seen by the other.
  logic wr_up_q, rd_up_q, rd_ask_q;
  logic wr_up_seen, rd_up_seen, rd_ask_seen;
  logic [Pointer-1:0] wr_gray_q, rd_gray_q, wr_gray_seen, rd_gray_seen;
  fs_sync #(.Bits(2 + Pointer)) u_to_write (
    .clk_i(wr_clk_i), .d_i({rd_up_q, rd_ask_q, rd_gray_q}),
    .q_o({rd_up_seen, rd_ask_seen, rd_gray_seen})
  );
  fs_sync #(.Bits(1 + Pointer)) u_to_read (
    .clk_i(rd_clk_i), .d_i({wr_up_q, wr_gray_q}), .q_o({wr_up_seen, wr_gray_seen})
  );

  // Write side, states: ~up: down; up & ~run: rise; run: run.
  logic wr_run_q, wr_run_d, wr_ready_q, push;
  logic [Pointer-1:0] wr_q, wr_d, wr_gray_d, full_gray;
  always_comb begin
    push = wr_valid_i & wr_ready_q & wr_rst_ni;
    wr_run_d = wr_run_q ? wr_rst_ni & ~rd_ask_seen : wr_up_q & rd_up_seen;
    wr_d = ~wr_run_q & ~rd_up_seen ? '0 : wr_q + Pointer'(push);
    wr_gray_d = wr_d ^ (wr_d >> 1);
    // Full is Depth words ahead: the two highest bits of the Gray code differ.
    full_gray = rd_gray_seen ^ {2'b11, (Pointer - 2)'(0)};
  end
  always_ff @(posedge wr_clk_i) begin
    wr_up_q <= wr_run_q ? wr_run_d : wr_up_q | (wr_rst_ni & ~rd_up_seen);
    wr_run_q <= wr_run_d;
    wr_q <= wr_d;
    wr_gray_q <= wr_gray_d;
    wr_ready_q <= wr_run_q & wr_run_d & wr_gray_d != full_gray;
  end
  assign wr_ready_o = wr_ready_q;

  // Read side, states: ~up: down; up & ~ask: up; up & ask: asks. Write must have been seen up
  // twice: then its pointer, which returned to 0 earlier, has been seen as well.
  logic wr_up_seen_q, rd_up_d, rd_ask_d, pop, rd_valid_q;
  logic [Pointer-1:0] rd_q, rd_d;
  logic [Bits-1:0] rd_data_q;
  always_comb begin
    rd_up_d = rd_up_q ? wr_up_seen : wr_up_seen & wr_up_seen_q & rd_rst_ni;
    rd_ask_d = rd_up_q & wr_up_seen & (rd_ask_q | ~rd_rst_ni);
    pop = rd_up_q & ~rd_ask_q & rd_gray_q != wr_gray_seen & (~rd_valid_q | rd_ready_i);
    rd_d = rd_up_d ? rd_q + Pointer'(pop) : '0;
  end
  always_ff @(posedge rd_clk_i) begin
    wr_up_seen_q <= wr_up_seen;
    rd_up_q <= rd_up_d;
    rd_ask_q <= rd_ask_d;
    rd_q <= rd_d;
    rd_gray_q <= rd_d ^ (rd_d >> 1);
    rd_valid_q <= rd_up_d & ~rd_ask_d & (pop | (rd_valid_q & ~rd_ready_i));
  end
  assign rd_valid_o = rd_valid_q;
  assign rd_data_o = rd_data_q;

  if (Depth > 64) begin : g_block
    (* ram_style = "block" *) logic [Bits-1:0] memory[0:Depth-1];
    always_ff @(posedge wr_clk_i) if (push) memory[wr_q[Address-1:0]] <= wr_data_i;
    always_ff @(posedge rd_clk_i) if (pop) rd_data_q <= memory[rd_q[Address-1:0]];
  end else begin : g_distributed
    (* ram_style = "distributed" *) logic [Bits-1:0] memory[0:Depth-1];
    always_ff @(posedge wr_clk_i) if (push) memory[wr_q[Address-1:0]] <= wr_data_i;
    always_ff @(posedge rd_clk_i) if (pop) rd_data_q <= memory[rd_q[Address-1:0]];
  end
endmodule
