// Composes two maps: looks each position of a stream up in the map of a row further below.
//
// Formula   code_o[x], verdict_o[x] = young[index_i[x]], where young is the stream of young_i in
//           the previous row; an index that already is a verdict (slot 3) passes through
// Schedule  Two tables swap at each row start: one is written with young_i, the other one is read.
//             tick 0: writes the entry together with the earlier ones of its word; reads the table
//             tick 1: RAM register
//             tick 2: selects one entry of the word
// Latency   3 ticks.
// Limits    index_i and young_i are in step: pixel x of a row in the same tick. Each row's index
//           points into the row that young_i carried one row time earlier.
module fs_speckle_compose #(
  parameter int WordBits = 8,
  parameter bit Codes = 1,     // the table holds positions
  parameter bit Verdicts = 0,  // the table holds verdict bits
  parameter bit Block = 1      // in block RAM instead of LUTs
) (
  input  logic                clk_i,
  input  logic                rst_ni,
  input  logic                en_i,
  input  logic                first_i,  // row start of the previous stage
  input  logic [WordBits+1:0] young_i,
  input  logic                young_verdict_i,
  input  logic [WordBits+1:0] index_i,
  output logic [WordBits+1:0] code_o,
  output logic                verdict_o
);
  localparam int CodeBits = WordBits + 2;
  localparam int Bits = (Codes ? CodeBits : 0) + (Verdicts ? 1 : 0);

  logic [WordBits-1:0] word;
  logic [1:0] slot;
  logic odd;
  fs_speckle_position #(.WordBits(WordBits)) u_position (
    .clk_i, .rst_ni, .en_i, .first_i, .word_o(word), .slot_o(slot), .odd_o(odd)
  );

  logic [Bits-1:0] entry, entry_0_q, entry_1_q;
  if (Codes && Verdicts) begin : g_both
    assign entry = {young_verdict_i, young_i};
  end else if (Codes) begin : g_codes
    assign entry = young_i;
    logic unused;
    assign unused = young_verdict_i;
  end else begin : g_verdicts
    assign entry = young_verdict_i;
    logic unused;
    assign unused = ^young_i;
  end

  // A word is written three times, each time with one more entry.
  logic [3*Bits-1:0] word_in, word_q;
  assign word_in = {
    entry, slot == 2'd1 ? entry : entry_1_q, slot == 2'd0 ? entry : entry_0_q
  };
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      if (slot == 2'd0) entry_0_q <= entry;
      if (slot == 2'd1) entry_1_q <= entry;
    end
  end

  logic [WordBits:0] write_address, read_address;
  assign write_address = {odd, word};
  assign read_address = {~odd, index_i[CodeBits-1:2]};
  if (Block) begin : g_block
    (* no_rw_check, ram_style = "block" *) logic [3*Bits-1:0] memory[0:2**(WordBits+1)-1];
    logic [3*Bits-1:0] read_q;
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        memory[write_address] <= word_in;
        read_q <= memory[read_address];
        word_q <= read_q;
      end
    end
  end else begin : g_luts
    // Four quarters, so that the path through the LUTs takes two ticks.
    logic [4*3*Bits-1:0] quarters_q;
    logic [1:0] quarter_q;
    for (genvar k = 0; k < 4; k++) begin : g_quarter
      (* no_rw_check, ram_style = "distributed" *) logic [3*Bits-1:0] memory[0:2**(WordBits-1)-1];
      always_ff @(posedge clk_i) begin
        if (en_i) begin
          if (write_address[WordBits-:2] == 2'(k)) memory[write_address[WordBits-2:0]] <= word_in;
          quarters_q[3*Bits*k+:3*Bits] <= memory[read_address[WordBits-2:0]];
        end
      end
    end
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        quarter_q <= read_address[WordBits-:2];
        word_q <= quarters_q[3*Bits*quarter_q+:3*Bits];
      end
    end
  end

  logic [CodeBits-1:0] index_1_q, index_2_q;
  logic [Bits-1:0] found;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      index_1_q <= index_i;
      index_2_q <= index_1_q;
    end
  end
  assign found = index_2_q[1] ? word_q[2*Bits+:Bits] :
      index_2_q[0] ? word_q[Bits+:Bits] : word_q[0+:Bits];

  if (Codes) begin : g_code
    always_ff @(posedge clk_i) begin
      if (en_i) code_o <= &index_2_q[1:0] ? index_2_q : found[CodeBits-1:0];
    end
  end else begin : g_no_code
    assign code_o = '0;
    logic unused;
    assign unused = ^index_2_q[CodeBits-1:3];
  end
  if (Verdicts) begin : g_verdict
    always_ff @(posedge clk_i) begin
      if (en_i) verdict_o <= &index_2_q[1:0] ? index_2_q[2] : found[Bits-1];
    end
  end else begin : g_no_verdict
    assign verdict_o = 1'b0;
  end
endmodule
