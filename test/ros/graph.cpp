#include "ros/graph.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace fpga_stereo::test {
namespace {

using XmlRpc::XmlRpcValue;
using Nodes = std::set<std::string>;
using Topology = std::map<std::string, Nodes>;

/// Returns the topics that `node` sends to this process.
std::set<std::string> topics_sent_by(const std::string& node) {
  XmlRpcValue name, answer, uri, links;
  name[0] = ros::this_node::getName();
  name[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", name, answer, uri, false) ||
      !ros::network::splitURI(uri, host, port)) {
    return {};
  }
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpcValue caller;
  caller[0] = ros::this_node::getName();
  if (!client.execute("getBusInfo", caller, answer) ||
      !ros::XMLRPCManager::instance()->validateXmlrpcResponse("getBusInfo", answer, links)) {
    return {};
  }
  std::set<std::string> topics;
  for (int i = 0; i < links.size(); ++i) {  // id, other node, direction, transport, topic, ...
    XmlRpcValue& link = links[i];
    const std::string other = link[1], direction = link[2], topic = link[4];
    if (other == ros::this_node::getName() && direction == "o") topics.insert(topic);
  }
  return topics;
}

/// Returns, by topic, the nodes other than this process that the master lists for it.
std::map<std::string, Nodes> others_by_topic(XmlRpcValue& topics) {
  std::map<std::string, Nodes> nodes;
  for (int i = 0; i < topics.size(); ++i) {
    for (int k = 0; k < topics[i][1].size(); ++k) {
      const std::string topic = topics[i][0], node = topics[i][1][k];
      if (node != ros::this_node::getName()) nodes[topic].insert(node);
    }
  }
  return nodes;
}

}  // namespace

Topology publishers_by_topic() {
  XmlRpcValue caller, answer, state;
  caller[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", caller, answer, state, false)) return {};
  Topology publishers;
  for (int i = 0; i < state[0].size(); ++i) {
    for (int k = 0; k < state[0][i][1].size(); ++k) {
      const std::string topic = state[0][i][0], node = state[0][i][1][k];
      publishers[topic].insert(node);
    }
  }
  return publishers;
}

std::map<std::string, std::string> types_by_topic(const std::string& prefix) {
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  std::map<std::string, std::string> types;
  for (const auto& topic : topics) {
    if (topic.name.rfind(prefix, 0) == 0) types[topic.name.substr(prefix.size())] = topic.datatype;
  }
  return types;
}

bool all_links_are_up() {
  XmlRpcValue caller, answer, state;
  caller[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", caller, answer, state, false)) return false;
  const std::map<std::string, Nodes> publishers = others_by_topic(state[0]);
  const std::map<std::string, Nodes> subscribers = others_by_topic(state[1]);

  std::vector<std::string> topics;
  ros::this_node::getSubscribedTopics(topics);
  std::map<std::string, std::set<std::string>> sent;
  for (const std::string& topic : topics) {
    const auto nodes = publishers.find(topic);
    if (nodes == publishers.end()) continue;
    for (const std::string& node : nodes->second) {
      if (sent.count(node) == 0) sent[node] = topics_sent_by(node);
      if (sent[node].count(topic) == 0) return false;
    }
  }
  ros::this_node::getAdvertisedTopics(topics);
  for (const std::string& topic : topics) {
    const auto nodes = subscribers.find(topic);
    if (nodes == subscribers.end() || topic == "/rosout") continue;
    if (ros::TopicManager::instance()->getNumSubscribers(topic) < nodes->second.size())
      return false;
  }
  return true;
}

}  // namespace fpga_stereo::test
