// Makes ticks at a rate that need not divide the clock's.
//
// Formula   ticks = floor(sum of step_i / ClockHz): step_i per second, each at most a clock late
// C++ twin  none: test/rtl/link/uart_test.cpp counts the ticks
// Schedule  an accumulator that starts at -ClockHz: adds step_i while negative, else adds
//           step_i - ClockHz and gives a tick
// Latency   the first tick comes ceil(ClockHz / step_i) clocks after the last clock with restart_i
// Handshake none
// Limits    step_i <= ClockHz < 2^30; 0: no ticks. A new step_i takes effect two clocks later.
module fs_baud #(
  parameter int ClockHz = 100000000,
  parameter int StepBits = 26
) (
  input  logic                clk_i,
  input  logic                restart_i,
  input  logic [StepBits-1:0] step_i,
  output logic                tick_o
);
  localparam int Sum = $clog2(ClockHz) + 2;
  logic signed [Sum-1:0] sum_q, up_q, down_q;
  always_ff @(posedge clk_i) begin
    up_q <= Sum'(step_i);
    down_q <= Sum'(step_i) - Sum'(ClockHz);
    if (restart_i) sum_q <= down_q;
    else sum_q <= sum_q + (sum_q[Sum-1] ? up_q : down_q);
  end
  assign tick_o = ~sum_q[Sum-1];
endmodule
