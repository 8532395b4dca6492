#include "sim/virtual_board/pty_port.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {
namespace {

class PtyLine final : public Line {
 public:
  PtyLine(sim::FaultyBoard& board, const std::string& path) : board_(board), port_(path) {
    port_.plug(true);
  }

  void plug(bool plugged) override {
    if (plugged == port_.is_plugged()) return;
    port_.plug(plugged);
    if (!plugged) board_.cut();
  }
  void serve(std::chrono::milliseconds most) override {
    const bool moved = port_.move(board_);
    if (port_.is_plugged() && !port_.has_host()) board_.discard();
    if (!moved) port_.wait(most);
  }
  std::string ready() const override { return port_.path(); }

 private:
  sim::FaultyBoard& board_;
  sim::PtyPort port_;
};

}  // namespace

std::unique_ptr<Line> make_pty_line(sim::FaultyBoard& board, const std::string& path) {
  return std::make_unique<PtyLine>(board, path);
}

}  // namespace fpga_stereo::tools
