// A stack of words: one push or pop per tick, the top in a register.
//
// Schedule  Registers hold the three topmost words; block RAM holds a copy of all words. A push
//           moves the registers down and writes the RAM. A pop moves them up and leaves a gap
//           below, which the RAM fills two ticks later:
//             tick 0: pop; the RAM reads the word that is missing in the gap (place 2)
//             tick 1: RAM register
//             tick 2: the word goes to where the gap is now (place 0 to 2, or nowhere)
// Limits    no push and pop in the same tick; no pop of an empty stack; at most Depth words.
module fs_speckle_stack #(
  parameter int Bits = 21,
  parameter int Depth = 320
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            en_i,
  input  logic            clear_i,  // empties the stack; not together with push or pop
  input  logic            push_i,
  input  logic            pop_i,
  input  logic [Bits-1:0] data_i,
  output logic [Bits-1:0] top_o
);
  localparam int AddressBits = $clog2(Depth);
  logic [AddressBits-1:0] size_q, fill_address;
  (* no_rw_check *) logic [Bits-1:0] memory[0:2**AddressBits-1];
  logic [Bits-1:0] read_q, filler_q, top_q, second_q, third_q;
  // A pop leaves a gap in place 2. One tick later the gap can be in place 1 or 2, or gone.
  logic made_q, gap_1_q, gap_2_q;

  assign fill_address = size_q - AddressBits'(4);
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (push_i) memory[size_q] <= data_i;
      read_q <= memory[fill_address];
      filler_q <= read_q;
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      size_q <= '0;
      made_q <= 1'b0;
      gap_1_q <= 1'b0;
      gap_2_q <= 1'b0;
    end else if (en_i) begin
      if (clear_i) size_q <= '0;
      else if (push_i) size_q <= size_q + 1'b1;
      else if (pop_i) size_q <= size_q - 1'b1;
      made_q <= pop_i;
      gap_1_q <= made_q & pop_i;
      gap_2_q <= made_q & ~pop_i & ~push_i;
    end
    if (en_i) begin
      if (push_i) top_q <= data_i;
      else if (pop_i) top_q <= gap_1_q ? filler_q : second_q;
      if (push_i) second_q <= top_q;
      else if (pop_i ? gap_2_q : gap_1_q) second_q <= filler_q;
      else if (pop_i) second_q <= third_q;
      if (push_i ? gap_1_q : gap_2_q) third_q <= filler_q;
      else if (push_i) third_q <= second_q;
    end
  end
  assign top_o = top_q;
endmodule
