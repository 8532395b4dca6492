// Register slice between two streams (defined in fs_stream_fifo.sv): cuts every path across a border
// between modules.
//
// Formula   words out = words in
// Schedule  A word goes to the output register. If the output stalls, the word that ready_o has
//           already promised to take goes to the spare register, and ready_o falls.
// Latency   1 clock; one word per clock.
// Handshake Stream on both sides. All outputs are registers: no combinational path leads from one
//           side to the other. During reset ready_o is high and incoming words are lost.
// Limits    none
module fs_stream_slice #(
  parameter int Bits = 18
) (
  input  logic            clk_i,
  input  logic            rst_ni,
  input  logic            valid_i,
  output logic            ready_o,
  input  logic [Bits-1:0] data_i,
  output logic            valid_o,
  input  logic            ready_i,
  output logic [Bits-1:0] data_o
);
  logic valid_q, spare_valid_q, ready_q, go;
  logic [Bits-1:0] data_q, spare_q;
  assign go = ~valid_q | ready_i;
  always_ff @(posedge clk_i) begin
    // ready_q is ~spare_valid_q, kept as a register of its own so that ready_o needs no inverter.
    if (!rst_ni) begin
      valid_q <= 1'b0;
      spare_valid_q <= 1'b0;
      ready_q <= 1'b1;
    end else begin
      if (go) valid_q <= valid_i | spare_valid_q;
      spare_valid_q <= ~go & (spare_valid_q | valid_i);
      ready_q <= go | ~(spare_valid_q | valid_i);
    end
    if (go) data_q <= spare_valid_q ? spare_q : data_i;
    if (ready_q) spare_q <= data_i;
  end
  assign ready_o = ready_q;
  assign valid_o = valid_q;
  assign data_o = data_q;
endmodule
