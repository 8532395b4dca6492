// The whole gateware (fs_system) over its link: requests, counters, heartbeats.
#include <gtest/gtest.h>

#include <random>

#include "link/faults.hpp"
#include "system_rig.hpp"

namespace fpga_stereo::test {
namespace {

/// Returns the expected refusal of a request, apart from its sequence number and time.
Received refusal(std::uint32_t reason) {
  Received answer;
  answer.header.type = PacketType::kRefused;
  answer.payload = {reason};
  return answer;
}

/// Sends a request and compares its answer, apart from its sequence number and time.
void expect_answer(SystemRig& rig, PacketType type, const Words& payload,
                   const Received& expected) {
  const Received answer = rig.request(type, payload);
  EXPECT_EQ(answer.header.version, kLinkVersion);
  EXPECT_EQ(answer.header.type, expected.header.type);
  EXPECT_EQ(answer.header.flags, 0);
  EXPECT_EQ(answer.header.stream, Stream::kNone);
  EXPECT_EQ(answer.header.frame_id, 0U);
  EXPECT_EQ(answer.payload, expected.payload);
}

TEST(RtlSystem, ReportsItsBuildAndResetValues) {
  SystemRig rig;
  EXPECT_EQ(rig.read(spec::kRegIdentity), spec::kRegIdentityReset);
  EXPECT_EQ(rig.read(spec::kRegSpecHash), kSpecHash);
  EXPECT_EQ(rig.read(spec::kRegBuildStreams), 126U);
  EXPECT_EQ(rig.read(spec::kRegBuildClock), 100000U);
  EXPECT_EQ(spec::kBuildMaxWidth.get(rig.read(spec::kRegBuild)), 64U);
  for (const spec::Register& r : spec::register_table()) {
    if (!r.reset) continue;
    EXPECT_EQ(rig.read(r.address), r.access == spec::Access::kWriteOnly ? 0 : *r.reset) << r.name;
  }
}

TEST(RtlSystem, ReadsAndWritesRegistersInOrder) {
  SystemRig rig;
  Words addresses, expected;
  for (std::uint32_t i = 0; i < 64; ++i) {
    addresses.push_back(i % 3 == 0 ? spec::kRegStreams : spec::kRegSpeckleSize);
    expected.insert(expected.end(), {addresses.back(), i % 3 == 0 ? 0x14U : 123U});
  }
  Received written;
  written.header.type = PacketType::kWritten;
  expect_answer(rig, PacketType::kWriteRegisters,
                {spec::kRegStreams, 0xFF, spec::kRegSpeckleSize, 9, spec::kRegStreams, 0x14,
                 spec::kRegSpeckleSize, 123},
                written);
  Received values;
  values.header.type = PacketType::kRegisters;
  values.payload = expected;
  expect_answer(rig, PacketType::kReadRegisters, addresses, values);
  // Addresses without a register read 0 and ignore writes, also if their low bits match a register.
  values.payload = {0x6F, 0, 0xFF, 0, 0x162, 0, 0xFFFFFF62, 0};
  expect_answer(rig, PacketType::kWriteRegisters, {0x6F, 1, 0x162, 1}, written);
  expect_answer(rig, PacketType::kReadRegisters, {0x6F, 0xFF, 0x162, 0xFFFFFF62}, values);
  EXPECT_EQ(rig.read(spec::kRegStreams), 0x14U);
}

TEST(RtlSystem, ReadsBackTheWritableBitsOfLinkRegisters) {
  SystemRig rig;
  rig.write(spec::kRegStreams, 0xFFFFFFFF);
  rig.write(spec::kRegFrameInterval, 0x00030007);
  rig.write(spec::kRegInput, 0xFFFFFFFE);
  rig.write(spec::kRegMidExposure, 0xFF123456);
  rig.write(spec::kRegConfiguration, 5);
  EXPECT_EQ(rig.read(spec::kRegStreams), kAllStreams);
  EXPECT_EQ(rig.read(spec::kRegFrameInterval), 0x00030007U);
  EXPECT_EQ(rig.read(spec::kRegInput), 0U);
  EXPECT_EQ(rig.read(spec::kRegMidExposure), 0x123456U);
  EXPECT_EQ(rig.read(spec::kRegConfiguration), 0U);
}

TEST(RtlSystem, SignsAMeshUpload) {
  SystemRig rig;
  Signature signature;
  Words mesh{spec::kMeshAddressCamera.put(1) | spec::kMeshAddressNode.put(3)};
  for (std::uint32_t i = 0; i < 255; ++i) {
    mesh.push_back(0x10203 * i);
    signature.add(mesh.back());
  }
  EXPECT_EQ(rig.request(PacketType::kWriteMesh, mesh).header.type, PacketType::kWritten);
  EXPECT_EQ(rig.read(spec::kRegMeshSignature), signature.value());
  EXPECT_EQ(rig.read(spec::kRegMeshAddress),
            spec::kMeshAddressCamera.put(1) | spec::kMeshAddressNode.put(3 + 255));
}

TEST(RtlSystem, RefusesInvalidRequestsWithTheReason) {
  SystemRig rig;
  expect_answer(rig, PacketType::kReadRegisters, {}, refusal(kRefusedLength));
  expect_answer(rig, PacketType::kReadRegisters, Words(65, 0), refusal(kRefusedLength));
  expect_answer(rig, PacketType::kWriteRegisters, {}, refusal(kRefusedLength));
  expect_answer(rig, PacketType::kWriteRegisters, Words(3, 0x62), refusal(kRefusedLength));
  expect_answer(rig, PacketType::kWriteRegisters, Words(130, 0x62), refusal(kRefusedLength));
  expect_answer(rig, PacketType::kWriteMesh, {0}, refusal(kRefusedLength));
  expect_answer(rig, PacketType::kWriteMesh, Words(257, 0), refusal(kRefusedLength));
  expect_answer(rig, PacketType::kHeartbeat, {}, refusal(kRefusedType));
  expect_answer(rig, static_cast<PacketType>(0), Words(1024, 0), refusal(kRefusedType));
  expect_answer(rig, PacketType::kRegisters, {1, 2}, refusal(kRefusedType));
  Header other;
  other.version = kLinkVersion + 1;
  other.type = PacketType::kLeader;
  other.index = 77;
  rig.send(other, bytes_of({1, 2, 3}));
  rig.run_until([&] { return !rig.answers.empty(); });
  EXPECT_EQ(rig.answers[0].header.index, 77);
  EXPECT_EQ(rig.answers[0].payload, Words{kRefusedVersion});
  rig.answers.clear();
  // Refused requests have no effect; requests of the maximum length are accepted.
  EXPECT_EQ(rig.read(spec::kRegStreams), 0U);
  EXPECT_EQ(rig.request(PacketType::kWriteMesh, Words(256, 0)).header.type, PacketType::kWritten);
  EXPECT_EQ(rig.request(PacketType::kWriteRegisters, Words(128, 0x62)).header.type,
            PacketType::kWritten);
}

TEST(RtlSystem, SendsPacketsWithTheBytesOfTheHostsEncoder) {
  SystemRig rig;
  rig.send_request(PacketType::kReadRegisters, {spec::kRegBuildClock});
  std::vector<std::uint8_t> bytes(200);
  for (int i = 0; i < 20; ++i) rig.system().run(100);
  bytes.resize(rig.system().transmit(bytes.data(), bytes.size()));
  // A heartbeat and the answer, in either order.
  std::vector<std::uint8_t> expected;
  link::Decoder decoder;
  decoder.push(bytes.data(), bytes.size());
  std::uint32_t sequence = kLinkFirstSequence;
  while (const auto packet = decoder.next()) {
    EXPECT_EQ(packet->header.sequence, sequence++);
    link::append_packet(packet->header, packet->payload, packet->header.length, expected);
  }
  EXPECT_EQ(bytes, expected);
  EXPECT_EQ(decoder.counters().skipped_bytes, 0U);
}

TEST(RtlSystem, CountsDamagedRequestsAndAnswersIntactOnes) {
  SystemRig rig;
  std::mt19937 random(5);
  std::uint32_t sent = 0;
  link::Decoder decoder;
  Bytes stream;
  for (int i = 0; i < 40; ++i) {
    Header header;
    header.type = PacketType::kReadRegisters;
    header.index = static_cast<std::uint16_t>(i);
    header.sequence = sent++;
    Bytes request;
    const Bytes payload = bytes_of({spec::kRegIdentity, spec::kRegStreams});
    link::append_packet(header, payload.data(), payload.size(), request);
    if (i % 2 == 1)
      damage(request, 0, request.size(), static_cast<Fault>(i / 2 % kNumFaults), random);
    stream.insert(stream.end(), request.begin(), request.end());
  }
  // A silence ends the wait for a packet that a damaged header announced.
  rig.system().receive(stream.data(), stream.size());
  rig.run(40000);
  decoder.push(stream.data(), stream.size());
  std::size_t intact = 0;
  std::uint64_t before = 0;
  do {
    before = decoder.counters().skipped_bytes;
    while (decoder.next()) ++intact;
    decoder.discard_partial_packet();
  } while (decoder.counters().skipped_bytes != before);
  EXPECT_GE(rig.answers.size(), 20U);
  EXPECT_EQ(rig.answers.size(), intact);
  for (const Received& answer : rig.answers) {
    EXPECT_EQ(answer.payload,
              (Words{spec::kRegIdentity, spec::kRegIdentityReset, spec::kRegStreams, 0}));
  }
  rig.answers.clear();
  EXPECT_EQ(rig.read(spec::kRegBadPackets),
            decoder.counters().bad_headers + decoder.counters().bad_payloads);
  EXPECT_GT(decoder.counters().bad_headers, 5U);
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  EXPECT_EQ(rig.read(spec::kRegBadPackets), 0U);
  EXPECT_EQ(rig.read(spec::kRegLostPackets), 0U);
}

TEST(RtlSystem, CountsLostRequests) {
  SystemRig rig;
  // The sequence number wraps within these requests.
  for (int i = 0; i < 20; ++i) rig.read(spec::kRegIdentity);
  EXPECT_EQ(rig.read(spec::kRegLostPackets), 0U);
  rig.skip_sequence_numbers(5);
  EXPECT_EQ(rig.read(spec::kRegLostPackets), 5U);
  rig.skip_sequence_numbers(2);
  EXPECT_EQ(rig.read(spec::kRegLostPackets), 7U);
  rig.write(spec::kRegControl, spec::kControlClear.put(1));
  EXPECT_EQ(rig.read(spec::kRegLostPackets), 0U);
}

TEST(RtlSystem, StampsAnswersWithItsClock) {
  SystemRig rig;
  const Received first = rig.request(PacketType::kReadRegisters, {0});
  const std::int64_t us = rig.system().microseconds();
  EXPECT_LE(first.header.timestamp, static_cast<std::uint64_t>(us));
  rig.run(100000);
  const Received second = rig.request(PacketType::kReadRegisters, {0});
  const auto passed = static_cast<double>(second.header.timestamp - first.header.timestamp);
  EXPECT_NEAR(passed, 1e6, 3e3);
}

TEST(RtlSystem, SendsHeartbeatsOnlyAfterHearingAHost) {
  SystemRig rig;
  rig.run(1000);
  EXPECT_TRUE(rig.packets.empty()) << "no host has been heard";
  rig.read(spec::kRegIdentity);
  rig.run(100000);  // 1 s
  EXPECT_EQ(rig.heartbeats, 2);
  for (const Received& packet : rig.packets) {
    if (packet.header.type != PacketType::kHeartbeat) continue;
    EXPECT_EQ(packet.header.version, kLinkVersion);
    EXPECT_TRUE(packet.payload.empty());
    EXPECT_EQ(packet.header.frame_id, 0U);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
