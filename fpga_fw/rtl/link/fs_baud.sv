// Ticks at a rate that does not divide the clock's.
//
// Formula   ticks = floor(sum of step_i / ClockHz): step_i per second, each at most a clock late
// C++ twin  none: test/rtl/link/uart_test.cpp counts them
// Schedule  an accumulator from -ClockHz up: negative + step_i, else + step_i - ClockHz, and a tick
// Latency   the first tick comes ceil(ClockHz / step_i) clocks behind the last clock with restart_i
// Handshake none
// Limits    step_i <= ClockHz < 2^30; 0: no ticks. A new step_i counts from two clocks later on.
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
