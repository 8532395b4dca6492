// Links each row to the row above it: finds the regions of rows 0..r as they appear in row r.
//
// A run is a set of horizontally linked pixels of a row, named by its first pixel. Regions of rows
// 0..r divide the runs of row r into sets that do not cross (the image is planar): if runs
// a < b < c < d have a, c in one region and b, d in one region, then all four are in one. So
//   - from left to right, the regions that will appear again form a stack;
//   - a region is identified by its first run in the row (its head) and by its last run.
//
// Formula   per run of row r (the table):  inner = not a head;  last = a head's last run
//           Row r+1, left to right; the region of the pixel above is E, with
//           E.head = head of the region of row r+1 that E is part of, none at first;
//           h = head of the region of the current run so far:
//             run starts:               h = the run
//             linked up, E.head none:   E.head = h           (first: E's pixels count here)
//             linked up, E.head set:    inner[h] = 1 unless it is E.head;  h = E.head
//             run c ends:               inner[h] = 0, last[h] = c
//           E changes at the start of a run p above. If inner[p], E is the previous region if that
//           has runs to come, else the top of the stack. If not inner[p], E is a new region,
//           last = last[p].
// C++ twin  src/core/speckle.cpp, as a union-find
// Schedule  per pixel, in ticks; the input is tick 3
//             1  table reads                          3  fetch: table entry, or that of `near`
//             4  visit: E is pushed, popped or new    5  event: E.head, h, table write
//           Row r+1 writes the table only at positions at which row r has already been read. After
//           a row start the last writes of that same table may be read next; hence
//             near     holds the first 12 entries once more, in registers and LUTs, without latency
//             `hit_*`  the last run of the row above applies to entry 0 or 1, which are visited
//                      while that run ends
//           One write per tick is sufficient. Runs are `inner` until the table says otherwise
//           (reading makes an entry inner again), so a run that is joined at once needs no write.
//           The end of a run is written in the tick after it, when there is no other write.
module fs_speckle_link #(
  parameter int WordBits = 8,
  parameter int StackDepth = 320
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic en_i,
  input  logic first_i,        // tick 0: row start
  input  logic valid_i,        // tick 3: the pixel has a disparity
  input  logic link_i,         //         it is linked to its left neighbour
  input  logic up_i,           //         it is linked to the pixel above
  input  logic above_valid_i,  //         the pixel above has a disparity
  input  logic above_link_i,   //         the pixel above is linked to its left neighbour
  output logic above_valid_o,  // tick 6
  output logic new_o,          // E is a new region, a popped one, else the same as before
  output logic pop_o,
  output logic push_o,         // the previous E was pushed
  output logic close_o,        // E ends at this pixel
  output logic first_o         // first link of E into this row
);
  localparam int Bits = WordBits + 2;

  // Positions and row starts of ticks 1 to 5.
  logic [WordBits-1:0] word_1;
  logic [1:0] slot_1;
  logic odd_1;
  fs_speckle_position #(.WordBits(WordBits)) u_position (
    .clk_i, .rst_ni, .en_i, .first_i, .word_o(word_1), .slot_o(slot_1), .odd_o(odd_1)
  );
  logic unused;
  assign unused = odd_1;
  logic [Bits-1:0] x_2_q, x_3_q, x_4_q, x_5_q;
  logic [5:1] row_start_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) row_start_q <= '0;
    else if (en_i) row_start_q <= {row_start_q[4:1], first_i};
    if (en_i) begin
      x_2_q <= {word_1, slot_1};
      x_3_q <= x_2_q;
      x_4_q <= x_3_q;
      x_5_q <= x_4_q;
    end
  end

  // Ticks 4 and 5: the pixel.
  logic valid_4_q, link_4_q, up_4_q, above_valid_4_q, above_link_4_q;
  logic valid_5_q, start_5_q, up_5_q, above_valid_5_q, new_5_q, pop_5_q, push_5_q;

  // The region under the cursor, E: ticks 4 and 5 each update it for the pixel they hold.
  logic region_q, region_ends_q, region_set_q;
  logic [Bits-1:0] region_last_q, region_head_q;

  // Tick 5: links upwards. The current run and the head of its region.
  logic [Bits-1:0] run_q, head_q;
  logic own_q;    // the run itself is the head
  logic ended_q;  // the run ended with the previous pixel
  logic joined, joined_inner;
  logic [Bits-1:0] head_before, head_d;
  assign joined = up_5_q & region_set_q;
  assign joined_inner = joined & ~start_5_q & (region_head_q != head_q);
  assign head_before = start_5_q ? x_5_q : head_q;
  assign head_d = joined ? region_head_q : head_before;

  logic ended_d, hit_0_q, hit_1_q;
  assign ended_d = valid_5_q & ~link_4_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      ended_q <= 1'b0;
      hit_0_q <= 1'b0;
      hit_1_q <= 1'b0;
    end else if (en_i) begin
      ended_q <= ended_d;
      hit_0_q <= ended_d & (head_d == Bits'(0));
      hit_1_q <= ended_d & (head_d == Bits'(1));
    end
    if (en_i) begin
      head_q <= head_d;
      if (start_5_q) run_q <= x_5_q;
      own_q <= start_5_q ? ~joined : own_q & ~joined_inner;
    end
  end

  // The table. Word: inner; the head is its own last run; last run.
  logic write, write_inner;
  assign write_inner = joined_inner & ~own_q;
  assign write = write_inner | ended_q;

  (* no_rw_check *) logic [Bits+1:0] memory[0:2**Bits-1];
  logic [Bits+1:0] read_q, far_q;
  // A dual-port memory: each port has its own process.
  // verilator lint_off MULTIDRIVEN
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      read_q <= memory[{word_1, slot_1}];
      memory[{word_1, slot_1}] <= '1;
      far_q <= read_q;
    end
  end
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (write) memory[head_q] <= {write_inner, own_q, run_q};
    end
  end
  // verilator lint_on MULTIDRIVEN

  logic [15:0] near_inner_q;
  logic [Bits:0] near[0:15];
  logic near_3, near_write;
  assign near_3 = x_3_q < Bits'(16);
  assign near_write = write & (head_q < Bits'(16));
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (near_write) begin
        near[head_q[3:0]] <= {own_q, run_q};
      end
      for (int k = 0; k < 16; k++) begin
        if (x_5_q == Bits'(k)) near_inner_q[k] <= 1'b1;
        else if (near_write && head_q[3:0] == 4'(k)) near_inner_q[k] <= write_inner;
      end
    end
  end

  // Tick 3: fetch.
  logic inner_4_q, single_4_q;
  logic [Bits-1:0] last_4_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (write && head_q == x_3_q) begin
        inner_4_q <= write_inner;
        {single_4_q, last_4_q} <= {own_q, run_q};
      end else if (near_3) begin
        inner_4_q <= near_inner_q[x_3_q[3:0]];
        {single_4_q, last_4_q} <= near[x_3_q[3:0]];
      end else begin
        {inner_4_q, single_4_q, last_4_q} <= far_q;
      end
    end
  end

  // Tick 4: visit.
  logic fix, fix_region, inner, single, start, open, region_ends, pop, push, is_new;
  logic [Bits-1:0] last, region_last, head_kept;
  assign fix_region = row_start_q[5] & hit_0_q;
  assign fix = (row_start_q[4] & hit_0_q) | (row_start_q[5] & hit_1_q);
  assign inner = inner_4_q & ~row_start_q[4] & ~(row_start_q[5] & hit_1_q);
  assign {single, last} = fix ? {own_q, run_q} : {single_4_q, last_4_q};
  assign region_ends = fix_region ? own_q : region_ends_q;
  assign region_last = fix_region ? run_q : region_last_q;
  assign start = above_valid_4_q & ~above_link_4_q;
  assign open = region_q & ~region_ends & ~row_start_q[4];
  assign is_new = start & ~inner;
  assign pop = start & inner & ~open;
  assign push = start & ~inner & open;
  assign head_kept = region_set_q ? region_head_q : head_before;

  logic top_set;
  logic [Bits-1:0] top_last, top_head;
  fs_speckle_stack #(.Bits(2 * Bits + 1), .Depth(StackDepth)) u_stack (
    .clk_i, .rst_ni, .en_i, .clear_i(row_start_q[4]), .push_i(push), .pop_i(pop),
    .data_i({region_set_q | up_5_q, region_last, head_kept}),
    .top_o({top_set, top_last, top_head})
  );

  always_ff @(posedge clk_i) begin
    if (!rst_ni) region_q <= 1'b0;
    else if (en_i) region_q <= start | (region_q & ~row_start_q[4]);
    if (en_i) begin
      region_last_q <= is_new ? last : pop ? top_last : region_last;
      region_ends_q <= is_new ? single :
          pop ? top_last == x_4_q : start ? region_last == x_4_q : region_ends;
      region_set_q <= is_new ? 1'b0 : pop ? top_set : region_set_q | up_5_q;
      region_head_q <= pop ? top_head : head_kept;
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      valid_4_q <= 1'b0;
      up_4_q <= 1'b0;
      above_valid_4_q <= 1'b0;
      valid_5_q <= 1'b0;
      start_5_q <= 1'b0;
      up_5_q <= 1'b0;
      above_valid_5_q <= 1'b0;
      new_5_q <= 1'b0;
      pop_5_q <= 1'b0;
      push_5_q <= 1'b0;
      above_valid_o <= 1'b0;
      new_o <= 1'b0;
      pop_o <= 1'b0;
      push_o <= 1'b0;
      close_o <= 1'b0;
      first_o <= 1'b0;
    end else if (en_i) begin
      valid_4_q <= valid_i;
      up_4_q <= up_i;
      above_valid_4_q <= above_valid_i;
      valid_5_q <= valid_4_q;
      start_5_q <= valid_4_q & ~link_4_q;
      up_5_q <= up_4_q;
      above_valid_5_q <= above_valid_4_q;
      new_5_q <= is_new;
      pop_5_q <= pop;
      push_5_q <= push;
      above_valid_o <= above_valid_5_q;
      new_o <= new_5_q;
      pop_o <= pop_5_q;
      push_o <= push_5_q;
      close_o <= above_valid_5_q & ~above_link_4_q & region_ends;
      first_o <= up_5_q & ~region_set_q;
    end
    if (en_i) begin
      link_4_q <= link_i;
      above_link_4_q <= above_link_i;
    end
  end
endmodule
