#include "link/state_machine.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

namespace fpga_stereo::test {
namespace {

using link::LinkEvent;
using link::LinkState;
using link::LinkTransition;
using link::next_state;

std::string row(const LinkTransition& t) {
  return std::string("| ") + name(t.from) + " | " + name(t.event) + " | " + name(t.to) + " |";
}

TEST(StateMachine, TheDocumentHasTheSameTable) {
  std::ifstream document(FPGA_STEREO_SOURCE_DIR "/src/link/README.md");
  ASSERT_TRUE(document) << "src/link/README.md";
  std::multiset<std::string> documented, expected;
  bool is_in_table = false;
  for (std::string line; std::getline(document, line);) {
    if (line == "| from | event | to |") {
      is_in_table = true;
      std::getline(document, line);  // the rule below the header
    } else if (line.empty()) {
      is_in_table = false;
    } else if (is_in_table) {
      documented.insert(line);
    }
  }
  for (const LinkTransition& t : link::kLinkTransitions) expected.insert(row(t));
  EXPECT_EQ(documented, expected);
}

TEST(StateMachine, EveryEventHasAtMostOneOutcome) {
  std::set<std::pair<LinkState, LinkEvent>> seen;
  for (const LinkTransition& t : link::kLinkTransitions) {
    EXPECT_TRUE(seen.insert({t.from, t.event}).second) << row(t);
    EXPECT_EQ(next_state(t.from, t.event), t.to) << row(t);
  }
}

TEST(StateMachine, EveryStateCanBeLeftByClosing) {
  for (int i = 0; i < link::kNumLinkStates; ++i) {
    EXPECT_EQ(next_state(static_cast<LinkState>(i), LinkEvent::kClosed), LinkState::kClosed) << i;
  }
}

TEST(StateMachine, RefusesEventsThatTheTableLacks) {
  EXPECT_FALSE(next_state(LinkState::kClosed, LinkEvent::kIdentified));
  EXPECT_FALSE(next_state(LinkState::kRefused, LinkEvent::kStreamsOn));
  EXPECT_FALSE(next_state(LinkState::kStreaming, LinkEvent::kOpened));
  EXPECT_FALSE(next_state(LinkState::kIdentifying, LinkEvent::kStreamsOff));
}

}  // namespace
}  // namespace fpga_stereo::test
