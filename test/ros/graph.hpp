// Asks the master and the nodes which connections exist.
#pragma once

namespace fpga_stereo::test {

/// Returns true if every publisher of this process's subscriptions sends to it, and this process
/// sends to every subscriber of its topics. getNumPublishers() cannot tell: it counts a publisher
/// before that has accepted the connection.
bool all_links_are_up();

}  // namespace fpga_stereo::test
