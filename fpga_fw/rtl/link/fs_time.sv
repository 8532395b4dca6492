// The board's clock: microseconds since the reset, and a pulse every millisecond.
//
// Formula   us = floor(clocks * 10^6 / ClockHz), exactly: the remaining fraction of a microsecond
//           is carried over. With a ClockHz below 10^6 (a slow simulation) us advances in larger
//           steps.
// Latency   none
module fs_time #(
  parameter int ClockHz = 100000000
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  output logic [63:0] us_o,
  output logic        ms_o
);
  localparam int Whole = 1000000 / ClockHz, Part = 1000000 % ClockHz;
  if (ClockHz < 10000) initial $fatal(1, "fs_time: ClockHz is %0d, allowed: 10000 or more", ClockHz);

  logic [31:0] part_q, part;
  logic carry;
  logic [9:0] add_q;  // microseconds, at most 100 + 1
  logic [10:0] in_ms_q, in_ms;
  assign part = part_q + 32'(Part);
  assign carry = part >= 32'(ClockHz);
  assign in_ms = in_ms_q + 11'(add_q);
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      part_q <= '0;
      add_q <= '0;
      us_o <= '0;
      in_ms_q <= '0;
      ms_o <= 1'b0;
    end else begin
      part_q <= carry ? part - 32'(ClockHz) : part;
      add_q <= 10'(Whole) + 10'(carry);
      us_o <= us_o + 64'(add_q);
      in_ms_q <= in_ms >= 11'd1000 ? in_ms - 11'd1000 : in_ms;
      ms_o <= in_ms >= 11'd1000;
    end
  end
endmodule
