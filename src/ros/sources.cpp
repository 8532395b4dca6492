#include "ros/sources.hpp"

namespace fpga_stereo {

const char* name(Sources::Maker maker) {
  return maker == Sources::Maker::kBoard ? "board" : "software";
}

Sources::Sources(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                 const SyncSettings& sync, const BoardSettings& board_settings, Health& health,
                 FramePublisher& publisher, const std::function<void()>& changed)
    : board_settings_(board_settings), health_(health), publisher_(publisher) {
  software_ = std::make_unique<SoftwareSource>(
      health_, [this](const StereoFrame& frame) { publisher_.publish(frame); });
  if (board_settings_.backend != Backend::kSoftware) make_board(nh, changed);
  topics_ = std::make_unique<TopicInput>(nh, private_nh, sync, health_, gate_,
                                         [this](const SourcePair& pair) { on_pair(pair); });
}

void Sources::make_board(const ros::NodeHandle& nh, const std::function<void()>& changed) {
  cameras_ = std::make_unique<CameraTopics>(nh, board_settings_, changed);
  BoardSource::Callbacks callbacks;
  callbacks.frame = [this](const StereoFrame& frame) { publisher_.publish(frame); };
  callbacks.pair = [this](const SourcePair& pair) { software_->receive(pair); };
  callbacks.changed = changed;
  board_ = std::make_unique<BoardSource>(board_settings_, *cameras_, health_, gate_, callbacks);
}

Sources::~Sources() {
  // In the direction of the data: topics feed the board, both feed the software.
  topics_->stop();
  topics_.reset();
  board_.reset();
  software_.reset();
}

void Sources::set_settings(const Settings& settings) {
  settings_ = settings;
  if (board_) board_->set_settings(settings);
  update_software();
}

void Sources::update_software() {
  Settings settings = settings_;
  if (board_) settings.pipeline = board_->parameters();
  software_->set_settings(settings);
}

void Sources::set_demand(const Demand& demand) {
  update_software();  // a board may have come or gone
  software_->set_demand(demand);
  if (board_) board_->set_demand(demand);
  topics_->set_demand(demand);
  if (demand.any() && needs_topics()) {
    topics_->start();
  } else {
    topics_->stop();
  }
  if (!demand.any()) software_->drop_waiting();
  health_.set_has_subscribers(demand.any() || (cameras_ && cameras_->demand().any()));
}

void Sources::refresh() {
  if (board_) board_->refresh();
}

bool Sources::reset_board() {
  if (!board_) return false;
  board_->reset();
  return true;
}

bool Sources::needs_topics() const {
  if (!board_ || board_settings_.topic_input) return true;
  return board_settings_.backend == Backend::kAuto && !board_->is_present();
}

void Sources::on_pair(const SourcePair& pair) {
  if (board_ && board_->send(pair)) return;
  if (board_settings_.backend == Backend::kBoard) {
    return health_.refused(DropCause::kLink, refusal_of_board());
  }
  software_->receive(pair);
}

StateReport Sources::refusal_of_board() const {
  if (const auto trouble = board_->trouble()) {
    return {trouble->state, "pair dropped: " + trouble->text};
  }
  const BoardReport board = board_->report();
  if (board.ability == link::BoardAbility::kMakesDisparity) {
    return {NodeState::kBoardStarting,
            "pair dropped: the board is being configured or its image size does not match"};
  }
  return {NodeState::kBoardUnsuitable,
          "pair dropped: the board cannot make this disparity: " + board.limitation};
}

Sources::Maker Sources::active() const {
  if (!board_) return Maker::kSoftware;
  const bool only_board = board_settings_.backend == Backend::kBoard;
  if (only_board && (board_settings_.topic_input || !board_->is_present())) return Maker::kBoard;
  return board_->makes_disparity() ? Maker::kBoard : Maker::kSoftware;
}

std::optional<StateReport> Sources::input_trouble() const {
  return needs_topics() ? topics_->trouble() : board_->trouble();
}

StateReport Sources::state() const {
  if (!health_.has_subscribers()) return {NodeState::kIdle, "idle: no output has a subscriber"};
  if (const auto trouble = input_trouble()) return *trouble;
  if (const auto refusal = health_.refusal()) return *refusal;
  return {NodeState::kStreaming, "streaming"};
}

std::optional<BoardReport> Sources::board_report() const {
  if (!board_) return std::nullopt;
  return board_->report();
}

}  // namespace fpga_stereo
