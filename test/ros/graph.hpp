// Asks the master and the nodes which connections exist.
#pragma once

#include <map>
#include <set>
#include <string>

namespace fpga_stereo::test {

/// Returns the nodes that publish each topic.
std::map<std::string, std::set<std::string>> publishers_by_topic();
/// Returns the type of each published topic whose name begins with `prefix`, without the prefix.
std::map<std::string, std::string> types_by_topic(const std::string& prefix);

/// Returns true if every publisher of this process's subscriptions sends to it, and this process
/// sends to every subscriber of its topics. getNumPublishers() cannot tell: it counts a publisher
/// before that has accepted the connection.
bool all_links_are_up();

}  // namespace fpga_stereo::test
