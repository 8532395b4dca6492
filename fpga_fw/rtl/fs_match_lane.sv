// One disparity of match: two Hamming distances, the column sum, the window sum.
//
// Schedule  the vectors at the inputs are those of tick 2 of fs_match:
//             ticks 3, 4  Hamming distances of the entering and of the leaving row (with more than
//                         30 bits they take one tick more, and everything after is one tick later)
//             tick 5      change of the column sum
//             tick 6      column sum (column_new_o), which starts from 0 in row 0 of a frame; it
//                         comes back as column_old_i a row later, at tick 5
//             tick 7      running sum along the rows, never reset, modulo its width; stored as its
//                         complement, which turns the last step into an addition
//             tick 8      its value at the window's right end; beyond the end of the row, the value
//                         held there
//             tick 9      window sum: subtracts the value before the window's left end; before the
//                         start of the row, the value held there. The earlier values are kept in a
//                         ring of LUT RAM
module fs_match_lane #(
  parameter int CensusBits = 24,
  parameter int CorrelationWindow = 15,
  parameter int Primitives = 0,
  localparam int SumBits = $clog2(CorrelationWindow * CorrelationWindow * CensusBits + 1),
  localparam int ColumnBits = $clog2(CorrelationWindow * CensusBits + 1),
  localparam int PlaceBits = $clog2(CorrelationWindow)
) (
  input  logic                  clk_i,
  input  logic                  en_i,
  input  logic [CensusBits-1:0] enter_left_i,
  input  logic [CensusBits-1:0] enter_right_i,
  input  logic [CensusBits-1:0] leave_left_i,
  input  logic [CensusBits-1:0] leave_right_i,
  input  logic                  seen_i,         // tick 2: the right pixel is in the image
  input  logic                  enters_i,       // tick 4: a row of the frame enters
  input  logic                  leaves_i,       // tick 4: a row of the frame leaves
  input  logic                  row0_i,         // tick 5: row 0 of the frame enters
  input  logic [ColumnBits-1:0] column_old_i,   // tick 5
  output logic [ColumnBits-1:0] column_new_o,   // tick 6
  input  logic [PlaceBits-1:0]  place_i,        // counts 0 .. CorrelationWindow - 1
  input  logic                  row_end_i,      // tick 7: last column of the row
  input  logic                  first_i,        // tick 8: the window extends past the left edge
  input  logic                  last_i,         // tick 7: the window extends past the right edge
  output logic [SumBits-1:0]    sum_o           // tick 9
);
  localparam int CountBits = $clog2(CensusBits + 1);
  localparam logic [CountBits-1:0] Chance = CountBits'(CensusBits / 2);

  localparam int SeenTicks = CensusBits > 30 ? 3 : 2;
  logic [SeenTicks-1:0] seen_q;
  logic [CountBits-1:0] enter_count, leave_count, enter, leave;
  fs_hamming #(.Bits(CensusBits)) u_enter (
    .clk_i, .en_i, .a_i(enter_left_i), .b_i(enter_right_i), .count_o(enter_count)
  );
  fs_hamming #(.Bits(CensusBits)) u_leave (
    .clk_i, .en_i, .a_i(leave_left_i), .b_i(leave_right_i), .count_o(leave_count)
  );
  assign enter = seen_q[SeenTicks-1] ? enter_count : Chance;
  assign leave = seen_q[SeenTicks-1] ? leave_count : Chance;

  logic signed [CountBits:0] change_q;
  logic [ColumnBits-1:0] column;
  fs_add_select #(.Bits(ColumnBits), .Primitives(Primitives)) u_column (
    .a_i(ColumnBits'(change_q)), .b_i(ColumnBits'(0)), .c_i(column_old_i),
    .select_i(row0_i), .sum_o(column)
  );

  // The complement of the running sum, n = -1 - sum: so sum(high) - sum(low) = n(low) - n(high).
  logic [SumBits-1:0] running_q, row_end_q, not_high_q, sum;
  logic [SumBits-1:0] before_q;  // running_q, CorrelationWindow + 1 ticks earlier
  (* ram_style = "distributed" *) logic [SumBits-1:0] ring[0:CorrelationWindow-1];
  fs_add_select #(.Bits(SumBits), .CarryIn(1), .Primitives(Primitives)) u_sum (
    .a_i(not_high_q), .b_i(row_end_q), .c_i(before_q),
    .select_i(first_i), .sum_o(sum)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      seen_q <= SeenTicks'({seen_q, seen_i});

      change_q <= {1'b0, enters_i ? enter : '0} - {1'b0, leaves_i ? leave : '0};

      column_new_o <= column;

      running_q <= running_q - SumBits'(column_new_o);
      before_q <= ring[place_i];
      ring[place_i] <= running_q;
      if (row_end_i) row_end_q <= running_q;

      not_high_q <= ~(last_i ? row_end_q : running_q);
      sum_o <= sum;
    end
  end
endmodule
