// Formal: fs_async_fifo is a queue, for any clocks, data, valid, ready and resets.
//
// Time advances in steps. In a step each clock may rise or not (clk2fflogic transforms the FIFO's
// flip-flops accordingly), and late_sync.sv lets bits arrive late at the synchronisers. The
// flip-flops of this module are clocked in every step: x is the value in this step, x_q that in the
// previous one. Flip-flops start as 0.
//
// A model queue runs in parallel. Wires named like u_fifo's signals in Yosys's flattened netlist
// connect to those signals.
module async_fifo #(
  parameter int Depth = 4,
  localparam int Bits = 2,
  localparam int Most = Depth + 1,  // words inside, at most
  localparam int SizeBits = $clog2(Most + 1),
  localparam int Address = $clog2(Depth),
  localparam int Pointer = Address + 1
) (
  input  logic            step_i,
  input  logic            wr_clk_i,
  input  logic            wr_rst_ni,
  input  logic            wr_valid_i,
  input  logic [Bits-1:0] wr_data_i,
  input  logic            rd_clk_i,
  input  logic            rd_rst_ni,
  input  logic            rd_ready_i,
  output logic [2:0]      reached_o
);
  logic wr_ready_o, rd_valid_o;
  logic [Bits-1:0] rd_data_o;
  fs_async_fifo #(.Bits(Bits), .Depth(Depth)) u_fifo (
    .wr_clk_i, .wr_rst_ni, .wr_valid_i, .wr_ready_o, .wr_data_i, .rd_clk_i, .rd_rst_ni, .rd_valid_o,
    .rd_ready_i, .rd_data_o
  );
  (* hierconn *) wire \u_fifo.wr_up_q , \u_fifo.wr_run_q , \u_fifo.rd_up_q , \u_fifo.rd_ask_q ;
  (* hierconn *) wire \u_fifo.wr_up_seen_q ;
  (* hierconn *) wire [Pointer-1:0] \u_fifo.wr_q , \u_fifo.rd_q ;
  (* hierconn *) wire [Pointer-1:0] \u_fifo.wr_gray_q , \u_fifo.rd_gray_q ;
  (* hierconn *) wire [Pointer+1:0] \u_fifo.u_to_write.first , \u_fifo.u_to_write.second ;
  (* hierconn *) wire [Pointer:0] \u_fifo.u_to_read.first , \u_fifo.u_to_read.second ;
  logic up, run, read_up, ask, up_1, up_2, up_3, read_up_1, read_up_2, ask_1, ask_2;
  assign up = \u_fifo.wr_up_q ;
  assign run = \u_fifo.wr_run_q ;
  assign read_up = \u_fifo.rd_up_q ;
  assign ask = \u_fifo.rd_ask_q ;
  assign up_1 = \u_fifo.u_to_read.first [Pointer];
  assign up_2 = \u_fifo.u_to_read.second [Pointer];
  assign up_3 = \u_fifo.wr_up_seen_q ;
  assign {read_up_1, ask_1} = \u_fifo.u_to_write.first [Pointer+1:Pointer];
  assign {read_up_2, ask_2} = \u_fifo.u_to_write.second [Pointer+1:Pointer];

  // The events of this step were determined by the values in the previous step.
  logic wr_clk_q, rd_clk_q, wr_rise, rd_rise, push_q, pop_q, held_q, wr_rst_nq, rd_rst_nq, run_q;
  logic [Bits-1:0] wr_data_q, rd_data_q;
  logic push, pop;
  assign wr_rise = wr_clk_i & ~wr_clk_q;
  assign rd_rise = rd_clk_i & ~rd_clk_q;
  assign push = wr_rise & push_q;
  assign pop = rd_rise & pop_q;
  always_ff @(posedge step_i) begin
    wr_clk_q <= wr_clk_i;
    rd_clk_q <= rd_clk_i;
    wr_rst_nq <= wr_rst_ni;
    rd_rst_nq <= rd_rst_ni;
    push_q <= wr_valid_i & wr_ready_o & wr_rst_ni;
    pop_q <= rd_valid_o & rd_ready_i & rd_rst_ni;
    held_q <= rd_valid_o & ~(rd_ready_i & rd_rst_ni);
    wr_data_q <= wr_data_i;
    rd_data_q <= rd_data_o;
    run_q <= run;
  end

  // The model, the oldest word first. Empty while the read side is down.
  logic [SizeBits-1:0] size_q, size;
  logic [Bits*Most-1:0] queue_q, queue;
  always_comb begin
    size = size_q - SizeBits'(pop);
    queue = pop ? queue_q >> Bits : queue_q;
    for (int i = 0; i < Most; i++)
      if (push & size == SizeBits'(i)) queue[Bits*i+:Bits] = wr_data_q;
    size = read_up ? size + SizeBits'(push) : '0;
  end
  // calm: no reset since the FIFO was empty. dirty: a side was reset, and its words are not yet
  // discarded.
  logic calm_q, calm, wr_dirty_q, wr_dirty, rd_dirty_q, rd_dirty;
  logic [2:0] reached_q;
  assign calm = (calm_q | (up & ~run & ~read_up)) & ~(wr_rise & ~wr_rst_nq) &
                ~(rd_rise & ~rd_rst_nq);
  assign wr_dirty = (wr_dirty_q | (wr_rise & ~wr_rst_nq & size_q != '0)) & read_up;
  assign rd_dirty = (rd_dirty_q | (rd_rise & ~rd_rst_nq)) & read_up;
  always_ff @(posedge step_i) begin
    size_q <= size;
    queue_q <= queue;
    calm_q <= calm;
    wr_dirty_q <= wr_dirty;
    rd_dirty_q <= rd_dirty;
    reached_q <= reached_o;
  end

  // No word is lost, duplicated or reordered: the output is the model's oldest word.
  always_comb if (rd_valid_o) begin
    p_nothing_from_nothing: assert (size != '0);
    p_oldest_word: assert (rd_data_o == queue[Bits-1:0]);
  end
  always_comb if (read_up & ~ask) p_no_overflow: assert (size <= SizeBits'(Most));
  // The rules of a stream, except during resets.
  always_comb if (held_q & read_up & ~ask) begin
    p_valid_stays: assert (rd_valid_o);
    p_payload_stays: assert (rd_data_o == rd_data_q);
  end
  // A reset of either side empties both before any word moves again; nothing else empties them.
  always_comb if (wr_dirty) p_reset_of_write_empties: assert (~wr_ready_o);
  always_comb if (rd_dirty) p_reset_of_read_empties: assert (~rd_valid_o);
  always_comb if (run_q & ~run) p_only_a_reset_empties: assert (~calm);
  always_comb if (push & ~rd_dirty) p_taken_when_both_are_up: assert (read_up);

  // Invariants for induction. The request and answer signals: at most one change is in progress.
  logic [6:0] ring;
  logic [2:0] changes;
  assign ring = {up, up_1, up_2, up_3, read_up, read_up_1, read_up_2};
  always_comb begin
    changes = '0;
    for (int i = 0; i < 6; i++) changes = changes + 3'(ring[i] ^ ring[i+1]);
  end
  always_comb begin
    i_ring: assert (changes <= 3'd1);
    i_run: assert (~run | &ring);
    i_ready: assert (~wr_ready_o | run);
    i_valid: assert (~rd_valid_o | (read_up & ~ask));
    i_ask: assert (~ask | read_up);
    i_wr_dirty: assert (~wr_dirty | (~up & ~run));
    i_rd_dirty: assert (~rd_dirty | ask);
    i_calm: assert (~calm | (~ask & ~ask_1 & ~ask_2 & up));
  end
  // Pointers, as each side sees them: in order, and at most Depth apart.
  function automatic [Pointer-1:0] binary(input [Pointer-1:0] gray);
    for (int i = Pointer - 1; i >= 0; i--)
      binary[i] = i == Pointer - 1 ? gray[i] : gray[i] ^ binary[i+1];
  endfunction
  logic [Pointer-1:0] write, write_1, write_2, read, read_1, read_2;
  assign write = \u_fifo.wr_q ;
  assign read = \u_fifo.rd_q ;
  assign write_1 = binary(\u_fifo.u_to_read.first [Pointer-1:0]);
  assign write_2 = binary(\u_fifo.u_to_read.second [Pointer-1:0]);
  assign read_1 = binary(\u_fifo.u_to_write.first [Pointer-1:0]);
  assign read_2 = binary(\u_fifo.u_to_write.second [Pointer-1:0]);
  logic [Pointer-1:0] words, words_1, words_2, held, held_1, held_2;
  assign words = write - read;
  assign words_1 = write_1 - read;
  assign words_2 = write_2 - read;
  assign held = write - read_2;
  assign held_1 = read_1 - read_2;
  assign held_2 = read - read_2;
  always_comb begin
    i_gray_write: assert (\u_fifo.wr_gray_q == (write ^ (write >> 1)));
    i_gray_read: assert (\u_fifo.rd_gray_q == (read ^ (read >> 1)));
    i_read_down: assert (read_up | read == '0);
    i_seen_down: assert (up | read_up_2 | (read_1 == '0 & ~ask_1));
  end
  always_comb if (up & ~run) begin
    i_rise: assert (write == '0 & read == '0 & read_1 == '0 & read_2 == '0 &
                    ~rd_valid_o & size == '0);
    i_rise_ask: assert (read_up | (~ask_1 & ~ask_2));
    i_rise_seen_first: assert (~up_2 | write_1 == '0);
    i_rise_seen_second: assert (~up_3 | write_2 == '0);
  end
  always_comb if (read_up) begin
    i_window_read: assert (words_2 <= words_1 & words_1 <= words & words <= Pointer'(Depth));
    if (~ask) i_size: assert (size == SizeBits'(words) + SizeBits'(rd_valid_o));
  end
  always_comb if (run) begin
    i_window_write: assert (held_1 <= held_2 & held_2 <= held & held <= Pointer'(Depth));
    i_ready_room: assert (~wr_ready_o | held < Pointer'(Depth));
  end
  // The memory holds the model's words.
  (* hierconn *) wire [Bits-1:0]
      \u_fifo.g_distributed.memory[0] , \u_fifo.g_distributed.memory[1] ,
      \u_fifo.g_distributed.memory[2] , \u_fifo.g_distributed.memory[3] ,
      \u_fifo.g_distributed.memory[4] , \u_fifo.g_distributed.memory[5] ,
      \u_fifo.g_distributed.memory[6] , \u_fifo.g_distributed.memory[7] ;
  logic [8*Bits-1:0] memory;
  assign memory = {
      \u_fifo.g_distributed.memory[7] , \u_fifo.g_distributed.memory[6] ,
      \u_fifo.g_distributed.memory[5] , \u_fifo.g_distributed.memory[4] ,
      \u_fifo.g_distributed.memory[3] , \u_fifo.g_distributed.memory[2] ,
      \u_fifo.g_distributed.memory[1] , \u_fifo.g_distributed.memory[0] };
  logic [Bits*Depth-1:0] inside, model;
  assign inside = (2 * Bits * Depth)'({memory[Bits*Depth-1:0], memory[Bits*Depth-1:0]}) >>
                  Bits * read[Address-1:0];
  assign model = (Bits * Depth)'(rd_valid_o ? queue >> Bits : queue);
  logic [Depth-1:0] same;
  for (genvar i = 0; i < Depth; i++) begin : g_word
    assign same[i] = words <= Pointer'(i) || inside[Bits*i+:Bits] == model[Bits*i+:Bits];
  end
  always_comb if (read_up & ~ask) i_words: assert (&same);

  // Cover: these events are reachable.
  assign reached_o = reached_q | {pop, wr_dirty, run & size == SizeBits'(Most)};
endmodule
