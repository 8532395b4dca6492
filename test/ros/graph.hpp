// What the master and the nodes themselves say of who is connected to whom.
#pragma once

namespace fpga_stereo::test {

/// Whether every node that publishes a topic to which this process subscribes sends to it, and
/// every node that subscribes to one of its topics is sent to. getNumPublishers() does not tell:
/// it counts a publisher before that has accepted the connection, and may send without it.
bool all_links_are_up();

}  // namespace fpga_stereo::test
