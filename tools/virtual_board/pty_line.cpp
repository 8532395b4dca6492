#include "sim/virtual_board/pty_port.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {
namespace {

class PtyLine final : public Line {
 public:
  PtyLine(sim::FaultyBoard& board, const std::string& path) : board_(board), port_(path) {
    port_.plug(true);
  }

  void plug(bool is_plugged) override {
    if (is_plugged == port_.is_plugged()) return;
    port_.plug(is_plugged);
    if (!is_plugged) board_.cut();
  }
  void serve(std::chrono::milliseconds timeout) override {
    const bool moved = port_.move(board_);
    if (port_.is_plugged() && !port_.has_host()) board_.discard();
    if (!moved) port_.wait(timeout);
  }
  std::string path() const override { return port_.path(); }

 private:
  sim::FaultyBoard& board_;
  sim::PtyPort port_;
};

}  // namespace

std::unique_ptr<Line> make_pty_line(sim::FaultyBoard& board, const std::string& path) {
  return std::make_unique<PtyLine>(board, path);
}

}  // namespace fpga_stereo::tools
