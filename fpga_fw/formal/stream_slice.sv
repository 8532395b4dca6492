// Formal: fs_stream_slice is a queue of up to two words, for any data, valid and ready.
//
// A model queue runs in parallel. Wires named like u_slice's signals in Yosys's flattened netlist
// connect to those signals.
module stream_slice #(
  localparam int Bits = 3
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            valid_i,
  input  logic            ready_i,
  input  logic [Bits-1:0] data_i,
  output logic            reached_o
);
  logic ready_o, valid_o;
  logic [Bits-1:0] data_o;
  fs_stream_slice #(.Bits(Bits)) u_slice (
    .clk_i, .rst_ni, .valid_i, .ready_o, .data_i, .valid_o, .ready_i, .data_o
  );
  (* hierconn *) wire [Bits-1:0] \u_slice.spare_q ;
  (* hierconn *) wire \u_slice.spare_valid_q ;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // The model, the oldest word in the low bits.
  logic [1:0] size_q, size;
  logic [2*Bits-1:0] queue_q, queue;
  logic push, pop;
  assign push = valid_i & ready_o;
  assign pop = valid_o & ready_i;
  always_comb begin
    size = size_q - 2'(pop);
    queue = pop ? queue_q >> Bits : queue_q;
    if (push & size == 2'd0) queue[Bits-1:0] = data_i;
    if (push & size == 2'd1) queue[2*Bits-1:Bits] = data_i;
    size = size + 2'(push);
  end
  logic held_q, waits_q;
  logic [Bits-1:0] held_data_q;
  always_ff @(posedge clk_i) begin
    size_q <= rst_ni ? size : '0;
    queue_q <= queue;
    held_q <= rst_ni & valid_o & ~ready_i;
    held_data_q <= data_o;
    waits_q <= rst_ni & push;
  end
  assign reached_o = started_q & size_q == 2'd2;

  // No word is lost, duplicated or reordered: the output is the model's oldest word.
  always_comb if (started_q & valid_o) p_nothing_from_nothing: assert (size_q != '0);
  always_comb if (started_q & valid_o) p_oldest_word: assert (data_o == queue_q[Bits-1:0]);
  // It cannot get stuck, and takes a word per clock while its output does not stall.
  always_comb if (started_q & waits_q) p_offered_in_the_next_clock: assert (valid_o);
  always_comb if (started_q & size_q < 2'd2) p_ready_unless_two_words_wait: assert (ready_o);
  always_comb if (started_q) p_no_overflow: assert (size_q <= 2'd2);
  // The rules of a stream.
  always_comb if (started_q & held_q) p_valid_stays: assert (valid_o);
  always_comb if (started_q & held_q) p_payload_stays: assert (data_o == held_data_q);

  // Invariants for induction.
  always_comb if (started_q) i_size: assert (size_q == 2'(valid_o) + 2'( \u_slice.spare_valid_q ));
  always_comb if (started_q) i_ready: assert (ready_o != \u_slice.spare_valid_q );
  always_comb if (started_q & \u_slice.spare_valid_q ) begin
    i_spare_is_second: assert (valid_o & \u_slice.spare_q == queue_q[2*Bits-1:Bits]);
  end
endmodule
