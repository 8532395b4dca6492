// Computes the areas of the regions that fs_speckle_link finds, and decides for each region where
// it continues one row below.
//
// Formula   area_r[E] = sum over the pixels x of E in row r of  1 + credit_r[x]
//           credit_r[x] = area_{r-1}[F] where F is first linked into row r at x, else 0
//           (saturates at 2**10 - 1, which is more than any speckle_size)
//           E is named by its first pixel in row r, a. After its last pixel in row r:
//             target[a] = keep                      if area >= speckle_size
//                         drop                      else if E is not linked into row r+1
//                         its first link's x        else: a pixel of row r+1 of the same region
// C++ twin  src/core/speckle.cpp
// Schedule  per pixel, in ticks; the input is tick 6
//             6  stack and credit read          8  E is pushed, popped or new; credit selected
//             9  name output; credit added; if E ends: credit for the next row written
//            10  compared                      11  target
//           A read of the stack misses the pushes of the two preceding ticks: hist_q holds the last
//           push. The first 12 credits are also kept in LUTs, because they can be written as late
//           as 1 tick before they are read; the credit of pixel 0 is forwarded.
// Limits    rows of at least 16 pixels. As in fs_speckle_link: no pop of an empty stack.
module fs_speckle_area #(
  parameter int WordBits = 8,
  parameter int StackDepth = 320
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                en_i,
  input  logic                first_i,         // tick 5: row start
  input  logic [9:0]          speckle_size_i,
  input  logic                above_valid_i,   // tick 6: from fs_speckle_link
  input  logic                new_i,
  input  logic                pop_i,
  input  logic                push_i,
  input  logic                close_i,
  input  logic                first_link_i,
  output logic                credited_o,      // tick 8: output, and returned one row later
  input  logic                credited_i,
  output logic                named_o,         // tick 9: the pixel above has a region
  output logic [WordBits+1:0] name_o,
  output logic                target_valid_o,  // tick 11
  output logic [WordBits+1:0] target_name_o,
  output logic [WordBits+1:0] target_o
);
  localparam int Bits = WordBits + 2;
  localparam int AreaBits = 10;
  localparam int AddressBits = $clog2(StackDepth);
  localparam logic [Bits-1:0] Keep = {Bits{1'b1}};  // Yosys reads '1 as 1 here
  localparam logic [Bits-1:0] Drop = Bits'(3);

  logic [WordBits-1:0] word_6;
  logic [1:0] slot_6;
  logic odd_6;
  fs_speckle_position #(.WordBits(WordBits)) u_position (
    .clk_i, .rst_ni, .en_i, .first_i, .word_o(word_6), .slot_o(slot_6), .odd_o(odd_6)
  );
  logic unused;
  assign unused = odd_6;

  logic [Bits-1:0] x_7_q, x_8_q;
  logic [8:6] row_start_q;
  logic [8:7] valid_q, new_q, pop_q, push_q, close_q, first_link_q;
  logic [9:9] ends_q, named_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      row_start_q <= '0;
      valid_q <= '0;
      new_q <= '0;
      pop_q <= '0;
      push_q <= '0;
      close_q <= '0;
      first_link_q <= '0;
      ends_q <= '0;
      named_q <= '0;
    end else if (en_i) begin
      row_start_q <= {row_start_q[7:6], first_i};
      valid_q <= {valid_q[7], above_valid_i};
      new_q <= {new_q[7], new_i};
      pop_q <= {pop_q[7], pop_i};
      push_q <= {push_q[7], push_i};
      close_q <= {close_q[7], close_i};
      first_link_q <= {first_link_q[7], first_link_i};
      ends_q <= close_q[8];
      named_q <= valid_q[8];
    end
    if (en_i) begin
      x_7_q <= {word_6, slot_6};
      x_8_q <= x_7_q;
    end
  end

  // The region under the cursor.
  logic [Bits-1:0] name_q, link_q;  // its name; its first link
  logic linked_q;
  logic [AreaBits-1:0] area_q, area, credit_q;
  logic one_q;
  logic [AreaBits:0] sum;
  assign sum = {1'b0, area_q} + {1'b0, credit_q} + {{AreaBits{1'b0}}, one_q};
  assign area = sum[AreaBits-1:0] | {AreaBits{sum[AreaBits]}};

  // Stack. A pop at tick 6 misses the pushes of the two preceding pixels.
  localparam int StackBits = 2 * Bits + 1 + AreaBits;
  (* no_rw_check *) logic [StackBits-1:0] stack[0:2**AddressBits-1];
  logic [AddressBits-1:0] size_q, size_before, address_7_q, address_8_q;
  logic [StackBits-1:0] stack_read_q, stack_q, hist_q, pushed, popped;
  logic recent_q, push_9_q;
  assign size_before = size_q - 1'b1;
  assign pushed = {name_q, link_q, linked_q, area};
  assign popped = recent_q ? hist_q : stack_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) size_q <= '0;
    else if (en_i)
      size_q <= row_start_q[6] ? '0 : push_i ? size_q + 1'b1 : pop_i ? size_before : size_q;
    if (en_i) begin
      address_7_q <= size_q;
      address_8_q <= address_7_q;
      if (push_q[8]) begin
        stack[address_8_q] <= pushed;
        hist_q <= pushed;
      end
      stack_read_q <= stack[size_before];
      stack_q <= stack_read_q;
      push_9_q <= push_q[8];
      recent_q <= push_q[8] | (push_9_q & ~pop_q[8]);
    end
  end

  // Credits.
  (* no_rw_check *) logic [AreaBits-1:0] credits[0:2**Bits-1];
  logic [AreaBits-1:0] credits_read_q, credits_q, near[0:15];
  logic write;
  assign write = ends_q[9] & linked_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (write) credits[link_q] <= area;
      credits_read_q <= credits[{word_6, slot_6}];
      credits_q <= credits_read_q;
      if (write && link_q < Bits'(16)) near[link_q[3:0]] <= area;
    end
  end

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (new_q[8]) begin
        name_q <= x_8_q;
        area_q <= '0;
      end else if (pop_q[8]) begin
        name_q <= popped[StackBits-1-:Bits];
        area_q <= popped[AreaBits-1:0];
      end else begin
        area_q <= area;
      end
      linked_q <= first_link_q[8] |
          (new_q[8] ? 1'b0 : pop_q[8] ? popped[AreaBits] : linked_q);
      if (first_link_q[8]) link_q <= x_8_q;
      else if (pop_q[8]) link_q <= popped[AreaBits+1+:Bits];
      one_q <= valid_q[8];
      if (!(valid_q[8] && credited_i)) credit_q <= '0;
      else if (row_start_q[8] && write && link_q == '0) credit_q <= area;
      else if (x_8_q < Bits'(16)) credit_q <= near[x_8_q[3:0]];
      else credit_q <= credits_q;
    end
  end
  assign credited_o = first_link_q[8];
  assign named_o = named_q[9];
  assign name_o = name_q;

  // Target of the region.
  logic ends_10_q, linked_10_q;
  logic [Bits-1:0] name_10_q, link_10_q;
  logic [AreaBits-1:0] area_10_q;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      ends_10_q <= 1'b0;
      target_valid_o <= 1'b0;
    end else if (en_i) begin
      ends_10_q <= ends_q[9];
      target_valid_o <= ends_10_q;
    end
    if (en_i) begin
      area_10_q <= area;
      linked_10_q <= linked_q;
      name_10_q <= name_q;
      link_10_q <= link_q;
      target_name_o <= name_10_q;
      target_o <= area_10_q >= speckle_size_i ? Keep : linked_10_q ? link_10_q : Drop;
    end
  end
endmodule
