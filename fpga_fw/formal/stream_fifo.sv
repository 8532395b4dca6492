// Formal: fs_stream_fifo is a queue, for any data, valid and ready.
//
// A model queue runs in parallel. Wires named like u_fifo's signals in Yosys's flattened netlist
// connect to those signals.
module stream_fifo #(
  parameter int Depth = 4,
  localparam int Bits = 3,
  localparam int Most = Depth + 1,  // words inside, at most
  localparam int SizeBits = $clog2(Most + 1),
  localparam int AddressBits = $clog2(Depth)
) (
  input logic            clk_i,
  input logic            rst_ni,
  input logic            valid_i,
  input logic            ready_i,
  input logic [Bits-1:0] data_i
);
  logic ready_o, valid_o;
  logic [Bits-1:0] data_o;
  logic [AddressBits:0] count_o;
  fs_stream_fifo #(.Bits(Bits), .Depth(Depth)) u_fifo (
    .clk_i, .rst_ni, .valid_i, .ready_o, .data_i, .valid_o, .ready_i, .data_o, .count_o
  );
  (* hierconn *) wire [AddressBits-1:0] \u_fifo.read_q ;
  (* hierconn *) wire [AddressBits-1:0] \u_fifo.write_q ;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // The model, the oldest word first.
  logic [SizeBits-1:0] size_q, size;
  logic [Bits*Most-1:0] queue_q, queue;
  logic push, pop;
  assign push = valid_i & ready_o;
  assign pop = valid_o & ready_i;
  always_comb begin
    size = size_q - SizeBits'(pop);
    queue = pop ? queue_q >> Bits : queue_q;
    for (int i = 0; i < Most; i++)
      if (push & size == SizeBits'(i)) queue[Bits*i+:Bits] = data_i;
    size = size + SizeBits'(push);
  end
  logic held_q;
  logic [Bits-1:0] held_data_q;
  logic waits_q;
  always_ff @(posedge clk_i) begin
    size_q <= rst_ni ? size : '0;
    queue_q <= queue;
    held_q <= rst_ni & valid_o & ~ready_i;
    held_data_q <= data_o;
    waits_q <= rst_ni & size_q != '0 & ~valid_o;
  end

  // No word is lost, duplicated or reordered: the output is the model's oldest word.
  always_comb if (started_q & valid_o) p_nothing_from_nothing: assert (size_q != '0);
  always_comb if (started_q & valid_o) p_oldest_word: assert (data_o == queue_q[Bits-1:0]);
  // It cannot get stuck: a word inside is offered in the next clock.
  always_comb if (started_q & waits_q) p_offered: assert (valid_o);
  always_comb if (started_q & size_q < SizeBits'(Depth)) p_takes_depth_words: assert (ready_o);
  always_comb if (started_q) p_no_overflow: assert (size_q <= SizeBits'(Most));
  // The rules of a stream.
  always_comb if (started_q & held_q) p_valid_stays: assert (valid_o);
  always_comb if (started_q & held_q) p_payload_stays: assert (data_o == held_data_q);
  always_comb if (started_q) p_count: assert (SizeBits'(count_o) + SizeBits'(valid_o) == size_q);

  // Invariants for induction: the memory holds the model's words, from read_q on.
  always_comb if (started_q) i_count: assert (count_o <= (AddressBits + 1)'(Depth));
  logic [AddressBits-1:0] behind;
  assign behind = \u_fifo.read_q + count_o[AddressBits-1:0];
  always_comb if (started_q) i_pointers: assert (\u_fifo.write_q == behind);
  (* hierconn *) wire [Bits-1:0]
      \u_fifo.memory[0] , \u_fifo.memory[1] , \u_fifo.memory[2] , \u_fifo.memory[3] ,
      \u_fifo.memory[4] , \u_fifo.memory[5] , \u_fifo.memory[6] , \u_fifo.memory[7] ,
      \u_fifo.memory[8] , \u_fifo.memory[9] , \u_fifo.memory[10] , \u_fifo.memory[11] ,
      \u_fifo.memory[12] , \u_fifo.memory[13] , \u_fifo.memory[14] , \u_fifo.memory[15] ;
  logic [16*Bits-1:0] memory;
  assign memory = {
      \u_fifo.memory[15] , \u_fifo.memory[14] , \u_fifo.memory[13] , \u_fifo.memory[12] ,
      \u_fifo.memory[11] , \u_fifo.memory[10] , \u_fifo.memory[9] , \u_fifo.memory[8] ,
      \u_fifo.memory[7] , \u_fifo.memory[6] , \u_fifo.memory[5] , \u_fifo.memory[4] ,
      \u_fifo.memory[3] , \u_fifo.memory[2] , \u_fifo.memory[1] , \u_fifo.memory[0] };
  logic [Bits*Depth-1:0] inside, model;
  assign inside = (2 * Bits * Depth)'({memory[Bits*Depth-1:0], memory[Bits*Depth-1:0]}) >>
                  Bits * \u_fifo.read_q ;
  assign model = (Bits * Depth)'(valid_o ? queue_q >> Bits : queue_q);
  logic [Depth-1:0] same;
  for (genvar i = 0; i < Depth; i++) begin : g_word
    assign same[i] = count_o <= (AddressBits + 1)'(i) ||
                     inside[Bits*i+:Bits] == model[Bits*i+:Bits];
  end
  always_comb if (started_q) i_words: assert (&same);
endmodule
