#include "ros/sources.hpp"

#include "ros/board_source.hpp"
#include "ros/replay_source.hpp"

namespace fpga_stereo {

Sources::Sources(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                 const Options& options, Health& health, Outputs& outputs,
                 FramePublisher& publisher, const std::function<void()>& changed)
    : board_settings_(options.board), health_(health), publisher_(publisher) {
  software_ = std::make_unique<SoftwareSource>(
      health_, [this](const StereoFrame& frame) { publisher_.publish(frame); });
  if (board_settings_.backend != Backend::kSoftware) make_board(nh, outputs, changed);
  TopicInput::Callbacks callbacks;
  callbacks.pair = [this](const SourcePair& pair) { on_pair(pair); };
  callbacks.image = [&outputs](Side side, const sensor_msgs::ImageConstPtr& image) {
    return outputs.publish_image(side, image);
  };
  const CalibrationUrls urls{board_settings_.left_url, board_settings_.right_url};
  topics_ = std::make_unique<TopicInput>(nh, private_nh, options.topics, options.sync, urls,
                                         health_, gate_, callbacks);
}

void Sources::make_board(const ros::NodeHandle& nh, Outputs& outputs,
                         const std::function<void()>& changed) {
  cameras_ = std::make_unique<CameraTopics>(nh, board_settings_, changed);
  BoardInput::Callbacks callbacks;
  callbacks.frame = [this](const StereoFrame& frame) { publisher_.publish(frame); };
  callbacks.pair = [this](const SourcePair& pair) { software_->receive(pair); };
  callbacks.images = [&outputs](const SourcePair& pair) { outputs.publish_images(pair); };
  callbacks.changed = changed;
  if (is_recording(board_settings_)) {
    board_ = std::make_unique<ReplaySource>(board_settings_, *cameras_, health_, gate_, callbacks);
  } else {
    board_ = std::make_unique<BoardSource>(board_settings_, *cameras_, health_, gate_, callbacks);
  }
}

Sources::~Sources() {
  // In the direction of the data: topics feed the board, both feed the software.
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
  const bool is_topics = needs_topics();
  note_input(is_topics);
  topics_->set_demand(is_topics ? demand : Demand());
  if (!demand.needs_pairs()) software_->drop_waiting();
  health_.set_has_subscribers(demand.any() || (cameras_ && cameras_->demand().any()));
}

void Sources::note_input(bool needs_topics) {
  const bool is_same = needs_topics == needed_topics_ && has_board() == had_board_;
  needed_topics_ = needs_topics;
  had_board_ = has_board();
  if (!is_same) health_.expect_first_frame();
}

void Sources::refresh() {
  if (board_) board_->refresh();
}

Status Sources::reset_board() {
  if (!board_) return Error{ErrorKind::kNotFound, "there is no board: backend is software"};
  return board_->reset();
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

std::string Sources::origin() const {
  const bool is_replay = board_ && is_recording(board_settings_) && !needs_topics();
  return is_replay ? board_settings_.device : "";
}

std::optional<BoardReport> Sources::board_report() const {
  if (!board_) return std::nullopt;
  return board_->report();
}

}  // namespace fpga_stereo
