// Resets two sensors and writes a table to the registers of both at once, over two-wire buses that
// share SCL. Repeats this if a sensor does not answer, or if no pair of frames comes.
//
// Formula   For each entry of the table: start, address, register, high byte, low byte, stop.
//           The 7-bit addresses 0x48, 0x4C, 0x58, 0x5C, which a sensor's two address pins select,
//           are tried in turn, the next one after each failure.
// C++ twin  TwoWireSensor in test/rtl/link/sensor_port.hpp, the other end
// Schedule  reset low for 1 ms, 1 ms of rest, the table at BitHz; retry 100 ms after a failure, or
//           after TimeoutMs without frames
// Latency   with 10 entries 6 ms after the reset
// Handshake The table is combinational: index_o to register_i, value_i, last_i. frame_i: a pulse
//           for each whole pair of frames. Lines are open drain: low with *_low_o, otherwise pulled
//           up.
// Limits    A quarter of a bit is at least 4 clocks. Clock stretching is not supported. Bit k of
//           answered_o is high if sensor k acknowledged every byte of the last table; both must.
module fs_sensor_setup #(
  parameter int ClockHz = 100000000,
  parameter int BitHz = 100000,
  parameter int TimeoutMs = 1000
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        frame_i,
  output logic [1:0]  answered_o,
  // The table.
  output logic [3:0]  index_o,
  input  logic [7:0]  register_i,
  input  logic [15:0] value_i,
  input  logic        last_i,
  // The pins.
  output logic        sensor_rst_no,
  output logic        scl_low_o,
  output logic        sda_low_o,  // SDA of both sensors
  input  logic [1:0]  sda_i
);
  localparam int RetryMs = 100;
  localparam int Quarter = ClockHz < 16 * BitHz ? 4 : ClockHz / (4 * BitHz);
  localparam int QuarterBits = $clog2(Quarter + 1);
  localparam int MsClocks = ClockHz / 1000;
  localparam int MsBits = $clog2(MsClocks + 1);
  localparam int WaitBits = $clog2(TimeoutMs + RetryMs + 1);
  if (ClockHz < 10000)
    initial $fatal(1, "fs_sensor_setup: ClockHz is %0d, allowed: 10000 or more", ClockHz);

  logic [1:0] sda;
  fs_sync #(.Bits(2)) u_sda (.clk_i, .d_i(sda_i), .q_o(sda));

  // Milliseconds, and quarters of a bit.
  logic [MsBits-1:0] ms_count_q;
  logic [QuarterBits-1:0] quarter_count_q;
  logic ms_q, quarter_q;
  always_ff @(posedge clk_i) begin
    ms_q <= rst_ni & ms_count_q == MsBits'(MsClocks - 1);
    ms_count_q <= ~rst_ni | ms_count_q == MsBits'(MsClocks - 1) ? '0 : ms_count_q + 1'b1;
    quarter_q <= rst_ni & quarter_count_q == QuarterBits'(Quarter - 1);
    quarter_count_q <= ~rst_ni | quarter_count_q == QuarterBits'(Quarter - 1) ? '0
                       : quarter_count_q + 1'b1;
  end

  // A write is 38 slots of four quarters: start, four bytes each with its acknowledge, stop.
  localparam logic [5:0] LastBit = 6'd36, StopSlot = 6'd37;
  typedef enum logic [1:0] {Reset, Rest, Write, Run} state_e;
  state_e state_q;
  logic [WaitBits-1:0] wait_q;  // ms; the first one may be shorter
  logic [5:0] slot_q;
  logic [1:0] phase_q;
  logic [35:0] shift_q;
  logic [1:0] address_q, refused_q;
  logic [3:0] index_q;
  logic acknowledge, slot_ends, over;
  assign index_o = index_q;
  assign acknowledge = slot_q == 6'd9 | slot_q == 6'd18 | slot_q == 6'd27 | slot_q == LastBit;
  assign slot_ends = quarter_q & phase_q == 2'd3;
  assign over = wait_q == '0;
  always_ff @(posedge clk_i) begin
    if (!rst_ni) begin
      state_q <= Reset;
      wait_q <= WaitBits'(2);
      address_q <= '0;
      answered_o <= '0;
    end else begin
      if (ms_q & ~over) wait_q <= wait_q - 1'b1;
      case (state_q)
        Reset: if (over) begin
          state_q <= Rest;
          wait_q <= WaitBits'(2);
        end
        Rest: begin
          slot_q <= '0;
          phase_q <= '0;
          index_q <= '0;
          refused_q <= '0;
          if (over) state_q <= Write;
        end
        Write: if (quarter_q) begin
          phase_q <= phase_q + 2'd1;
          if (phase_q == 2'd2 & acknowledge) refused_q <= refused_q | sda;
          if (slot_ends) begin
            slot_q <= slot_q == StopSlot ? '0 : slot_q + 6'd1;
            shift_q <= {shift_q[34:0], 1'b1};
            if (slot_q == '0)
              shift_q <= {2'b10, address_q[1], 1'b1, address_q[0], 4'b0001, register_i, 1'b1,
                          value_i[15:8], 1'b1, value_i[7:0], 1'b1};
            if (slot_q == StopSlot) begin
              index_q <= index_q + 4'd1;
              if (last_i) begin
                state_q <= Run;
                answered_o <= ~refused_q;
                wait_q <= refused_q == '0 ? WaitBits'(TimeoutMs) : WaitBits'(RetryMs);
              end
            end
          end
        end
        default: begin
          if (frame_i & refused_q == '0) wait_q <= WaitBits'(TimeoutMs);
          else if (over) begin
            state_q <= Reset;
            wait_q <= WaitBits'(2);
            if (refused_q != '0) address_q <= address_q + 2'd1;
          end
        end
      endcase
    end
  end
  always_ff @(posedge clk_i) begin
    sensor_rst_no <= rst_ni & state_q != Reset;
    scl_low_o <= 1'b0;
    sda_low_o <= 1'b0;
    if (rst_ni & state_q == Write) begin
      if (slot_q == '0) begin
        scl_low_o <= phase_q == 2'd3;
        sda_low_o <= phase_q != 2'd0;
      end else if (slot_q == StopSlot) begin
        scl_low_o <= phase_q == 2'd0;
        sda_low_o <= ~phase_q[1];
      end else begin
        scl_low_o <= phase_q == 2'd0 | phase_q == 2'd3;
        sda_low_o <= ~shift_q[35];
      end
    end
  end
endmodule
