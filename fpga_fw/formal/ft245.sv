// Formal: fs_ft245 obeys the rules of the bus, loses no word from the chip and withdraws none that
// it has offered, for any behaviour of the chip's flags and any streams. stream_fifo.sv proves its
// FIFOs, fs_stream_fifo.
//
// Wires named like u_ft245's signals in Yosys's flattened netlist connect to those signals.
module ft245 #(
  parameter int Burst = 5
) (
  input logic        clk_i,
  input logic        rst_ni,
  input logic        rxf_ni,
  input logic        txe_ni,
  input logic [7:0]  data_i,
  input logic        tx_valid_i,
  input logic [7:0]  tx_data_i,
  input logic        rx_ready_i,
  output logic [3:0] reached_o
);
  logic rd_no, wr_no, oe_no, siwu_no, data_oe_o, tx_ready_o, rx_valid_o, be_o, rx_keep_o;
  logic [7:0] data_o, rx_data_o;
  fs_ft245 #(.DataBits(8), .Burst(Burst), .FlushClocks(3)) u_ft245 (
    .clk_i, .rst_ni, .rxf_ni, .txe_ni, .rd_no, .wr_no, .oe_no, .siwu_no, .data_i, .be_i(1'b1),
    .data_o, .be_o, .data_oe_o, .tx_valid_i, .tx_ready_o, .tx_data_i, .rx_valid_o, .rx_ready_i,
    .rx_data_o, .rx_keep_o
  );
  (* hierconn *) wire \u_ft245.full_q , \u_ft245.head_valid , \u_ft245.head_ready ;
  (* hierconn *) wire \u_ft245.in_valid_q , \u_ft245.unused_ready , \u_ft245.room_q ;
  (* hierconn *) wire \u_ft245.stalled_q , \u_ft245.g_flush.unsent_q ;
  (* hierconn *) wire [7:0] \u_ft245.head_data ;
  (* hierconn *) wire [8:0] \u_ft245.in_q ;
  (* hierconn *) wire [4:0] \u_ft245.rx_count ;
  (* hierconn *) wire [1:0] \u_ft245.state_q ;
  localparam logic [1:0] Idle = 2'd0, Turn = 2'd1, Read = 2'd2, Write = 2'd3;

  // Starts with a reset; further resets may come.
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (started_q | ~rst_ni);

  // Values in the previous clock.
  logic rd_nq, wr_nq, oe_nq, data_oe_q, taken_q, loads_q, held_q, was_rst_nq;
  logic seen_q = 1'b0;
  logic [1:0] idle_reads_q, idle_writes_q, idle_reads, idle_writes;
  logic [7:0] data_q, head_data_q, data_out_q;
  assign idle_reads = ~rd_no & rxf_ni ? idle_reads_q + 2'd1 : 2'd0;
  assign idle_writes = ~wr_no & txe_ni ? idle_writes_q + 2'd1 : 2'd0;
  always_ff @(posedge clk_i) begin
    seen_q <= started_q;
    rd_nq <= rd_no;
    wr_nq <= wr_no;
    oe_nq <= oe_no;
    data_oe_q <= data_oe_o;
    was_rst_nq <= rst_ni;
    taken_q <= rst_ni & ~rd_no & ~rxf_ni;
    data_q <= data_i;
    loads_q <= rst_ni & \u_ft245.head_valid & \u_ft245.head_ready ;
    head_data_q <= \u_ft245.head_data ;
    held_q <= rst_ni & \u_ft245.full_q & (wr_no | txe_ni);
    data_out_q <= data_o;
    idle_reads_q <= started_q ? idle_reads : 2'd0;
    idle_writes_q <= started_q ? idle_writes : 2'd0;
  end

  // The bus: at most one side drives, with a clock in between in which nobody drives.
  always_comb if (started_q) p_one_drives: assert (~(data_oe_o & ~oe_no));
  always_comb if (seen_q) begin
    p_nobody_drives_between: assert (~(data_oe_o & ~oe_nq) & ~(data_oe_q & ~oe_no));
    p_read_behind_turn: assert (rd_no | (~oe_no & ~oe_nq));
    p_hold_behind_write: assert (wr_nq | data_oe_o);
  end
  always_comb if (started_q) begin
    p_write_drives: assert (wr_no | data_oe_o);
    p_read_or_write: assert (rd_no | wr_no);
    p_few_reads_of_nothing: assert (idle_reads <= 2'd2);
    p_few_writes_to_nobody: assert (idle_writes <= 2'd2);
  end
  // Words from the chip: those of clocks with RD# and RXF# low; each finds room.
  always_comb if (seen_q) p_words_read: assert (\u_ft245.in_valid_q == taken_q);
  always_comb if (seen_q & taken_q) p_data_read: assert (\u_ft245.in_q == {1'b1, data_q});
  always_comb if (started_q & \u_ft245.in_valid_q ) p_no_word_lost: assert (\u_ft245.unused_ready );
  // Words to the chip: every offered word is valid, stays until it is taken, and is followed by the
  // next word of the stream.
  always_comb if (started_q & ~wr_no) p_a_word_is_offered: assert (\u_ft245.full_q );
  always_comb if (seen_q & held_q) p_word_stays: assert (\u_ft245.full_q & data_o == data_out_q);
  always_comb if (seen_q & loads_q) p_next_word: assert (\u_ft245.full_q & data_o == head_data_q);
  always_comb if (seen_q & was_rst_nq & ~held_q & ~loads_q) p_not_twice: assert (~\u_ft245.full_q );

  // Invariants for induction.
  logic [4:0] on_the_way, before_q;
  logic reads;
  assign reads = ~rd_no;
  assign on_the_way = 5'(\u_ft245.in_valid_q ) + 5'(reads);
  always_ff @(posedge clk_i) before_q <= \u_ft245.rx_count ;
  always_comb if (started_q) begin
    i_read: assert (rd_no == (\u_ft245.state_q != Read));
    i_turn: assert (oe_no == (\u_ft245.state_q != Read & \u_ft245.state_q != Turn));
    i_write: assert (wr_no == (\u_ft245.state_q != Write));
    i_full: assert (\u_ft245.state_q != Write | \u_ft245.full_q );
    i_driven: assert (~data_oe_o | \u_ft245.state_q == Write | \u_ft245.state_q == Idle);
    i_count: assert (\u_ft245.rx_count <= 5'd16);
  end
  always_comb if (seen_q) begin
    i_room: assert (\u_ft245.room_q == (was_rst_nq & before_q < 5'd12));
    i_stalled_read: assert (rd_no | idle_reads_q <= 2'(\u_ft245.stalled_q ));
    i_stalled_write: assert (wr_no | idle_writes_q <= 2'(\u_ft245.stalled_q ));
    i_count_grows: assert (~was_rst_nq | \u_ft245.rx_count <= before_q + 5'd1);
    // Room for the words on their way: the one of this clock and the one of the next.
    i_on_the_way: assert (\u_ft245.rx_count + on_the_way <= 5'd16 - 5'(\u_ft245.room_q ));
    i_turn_room: assert (\u_ft245.state_q != Turn | \u_ft245.rx_count + on_the_way < 5'd15);
  end

  // Cover: these events are reachable.
  always_ff @(posedge clk_i) begin
    if (~rst_ni) reached_o <= '0;
    else reached_o <= reached_o | {~siwu_no, ~rd_no & ~\u_ft245.room_q , held_q & ~wr_nq, taken_q};
  end
endmodule
