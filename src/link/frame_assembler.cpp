#include "link/frame_assembler.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::link {
namespace {

using Verdict = FrameVerdict;

std::size_t pixel_bytes(PixelFormat format) { return format == PixelFormat::kDisparity ? 2 : 1; }

/// Unpacks a leader; nullopt if no board makes such a frame.
std::optional<Leader> unpack_leader(const Packet& packet) {
  if (packet.header.length != Leader::kBytes) return std::nullopt;
  Leader leader;
  leader.width = get_u16(packet.payload + kLinkLeaderWidthAt);
  leader.height = get_u16(packet.payload + kLinkLeaderHeightAt);
  leader.format = static_cast<PixelFormat>(packet.payload[kLinkLeaderFormatAt]);
  leader.configuration = get_u32(packet.payload + kLinkLeaderConfigurationAt);
  const auto expected =
      packet.header.stream == Stream::kDisparity ? PixelFormat::kDisparity : PixelFormat::kGrey;
  if (leader.format != expected) return std::nullopt;
  if (leader.width < kGatewareMinWidth || leader.width > kGatewareMaxWidth) return std::nullopt;
  if (leader.height < 1 || leader.height > kGatewareMaxHeight) return std::nullopt;
  return leader;
}

void set_row(const std::uint8_t* bytes, cv::Mat row) {
  if (row.depth() == CV_8U) {
    std::memcpy(row.data, bytes, static_cast<std::size_t>(row.cols));
    return;
  }
  for (int x = 0; x < row.cols; ++x, bytes += 2) row.at<std::uint16_t>(x) = get_u16(bytes);
}

std::string flag_names(std::uint32_t flags) {
  const std::pair<std::uint32_t, const char*> names[] = {
      {kCutFrame, "the camera's frame was cut"},
      {kLongFrame, "the camera's frame was too long"},
      {kBufferError, "the rectification read outside the line buffer, or a mesh was being written"},
      {kOverrun, "the link was too slow"},
  };
  std::string text;
  for (const auto& [flag, name] : names) {
    if ((flags & flag) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
    flags &= ~flag;
  }
  if (flags != 0) text += (text.empty() ? "" : ", ") + ("flags " + std::to_string(flags));
  return text;
}

}  // namespace

std::size_t Leader::row_bytes(Stream stream) const {
  return (static_cast<std::size_t>(columns(stream)) * pixel_bytes(format) + 3) / 4 * 4;
}

std::array<std::uint8_t, Leader::kBytes> pack(const Leader& leader) {
  std::array<std::uint8_t, Leader::kBytes> bytes{};
  put_u16(&bytes[kLinkLeaderWidthAt], leader.width);
  put_u16(&bytes[kLinkLeaderHeightAt], leader.height);
  bytes[kLinkLeaderFormatAt] = static_cast<std::uint8_t>(leader.format);
  put_u32(&bytes[kLinkLeaderConfigurationAt], leader.configuration);
  return bytes;
}

std::array<std::uint8_t, Trailer::kBytes> pack(const Trailer& trailer) {
  std::array<std::uint8_t, Trailer::kBytes> bytes{};
  put_u32(&bytes[kLinkTrailerRowsAt], trailer.rows);
  put_u32(&bytes[kLinkTrailerFlagsAt], trailer.flags);
  put_u32(&bytes[kLinkTrailerSignatureAt], trailer.signature);
  return bytes;
}

void append_row(const cv::Mat& row, std::vector<std::uint8_t>& bytes) {
  const std::size_t first = bytes.size();
  const auto size = static_cast<std::size_t>(row.cols) * row.elemSize();
  bytes.resize((first + size + 3) / 4 * 4, 0);
  std::uint8_t* to = &bytes[first];
  if (row.depth() == CV_8U) {
    std::memcpy(to, row.data, size);
    return;
  }
  for (int x = 0; x < row.cols; ++x, to += 2) put_u16(to, row.at<std::uint16_t>(x));
}

void append_frame(const Header& frame, const cv::Mat& image, std::uint32_t configuration,
                  std::uint32_t flags, std::size_t payload, std::uint32_t& sequence,
                  std::vector<std::uint8_t>& bytes) {
  Header header = frame;
  const auto packet = [&](PacketType type, const std::uint8_t* data, std::size_t size) {
    header.type = type;
    header.sequence = sequence++;
    append_packet(header, data, size, bytes);
  };
  Leader leader;
  leader.width =
      static_cast<std::uint16_t>(frame.stream == Stream::kInput ? image.cols / 2 : image.cols);
  leader.height = static_cast<std::uint16_t>(image.rows);
  leader.format = image.depth() == CV_16U ? PixelFormat::kDisparity : PixelFormat::kGrey;
  leader.configuration = configuration;
  const auto first = pack(leader);
  packet(PacketType::kLeader, first.data(), first.size());

  const std::size_t fit = payload / leader.row_bytes(frame.stream);
  const int rows = frame.stream == Stream::kInput || fit == 0 ? 1 : static_cast<int>(fit);
  std::vector<std::uint8_t> row_bytes;
  for (int y = 0; y < image.rows; y += rows) {
    row_bytes.clear();
    for (int k = y; k < std::min(y + rows, image.rows); ++k) append_row(image.row(k), row_bytes);
    header.index = static_cast<std::uint16_t>(y);
    packet(PacketType::kRows, row_bytes.data(), row_bytes.size());
  }
  header.index = 0;
  const auto last =
      pack(Trailer{static_cast<std::uint32_t>(image.rows), flags, image_signature(image)});
  packet(PacketType::kTrailer, last.data(), last.size());
}

std::string AssembledFrame::text() const {
  std::string frame = fmt::format("{} frame {}", name(stream), frame_id);
  const std::string rows = fmt::format("{} of {} rows are missing", missing_rows, height);
  switch (verdict) {
    case Verdict::kGood:
      return frame + " is good";
    case Verdict::kIncomplete:
      return frame + " is incomplete: " + rows;
    case Verdict::kRowsMissing:
      return frame + " dropped: " + rows;
    case Verdict::kNoTrailer:
      return frame + " dropped: it did not end";
    case Verdict::kFlagged:
      return frame + " dropped: " + flag_names(flags);
    case Verdict::kBadSignature:
      return frame + " dropped: its signature does not match";
    case Verdict::kBadStamp:
      return frame + " dropped: its time stamp is impossible";
  }
  return frame;
}

void FrameAssembler::add(const Packet& packet, std::vector<AssembledFrame>& out) {
  const PacketType type = packet.header.type;
  if (type != PacketType::kLeader && type != PacketType::kRows && type != PacketType::kTrailer) {
    return;
  }
  const auto stream = static_cast<std::size_t>(packet.header.stream);
  if (stream == 0 || stream >= frames_.size()) {
    ++counters_.refused_packets;
    return;
  }
  Frame& frame = frames_[stream];
  if (type == PacketType::kLeader) {
    if (frame.is_open) {
      // A repeated leader begins nothing.
      if (frame.assembled.frame_id == packet.header.frame_id) return;
      finish(frame, Verdict::kNoTrailer, out);
    }
    begin(packet, frame);
    return;
  }
  if (!frame.is_open || frame.assembled.frame_id != packet.header.frame_id) {
    ++counters_.refused_packets;
    return;
  }
  if (type == PacketType::kRows) {
    take_rows(packet, frame);
  } else {
    end(packet, frame, out);
  }
}

void FrameAssembler::begin(const Packet& packet, Frame& frame) {
  const auto leader = unpack_leader(packet);
  if (!leader) {
    ++counters_.refused_packets;
    return;
  }
  frame.is_open = true;
  frame.leader = *leader;
  frame.assembled = {};
  frame.assembled.stream = packet.header.stream;
  frame.assembled.frame_id = packet.header.frame_id;
  frame.assembled.timestamp = packet.header.timestamp;
  frame.assembled.configuration = leader->configuration;
  frame.assembled.height = leader->height;
  frame.has_row.assign(leader->height, false);
}

void FrameAssembler::take_rows(const Packet& packet, Frame& frame) {
  const std::size_t row_bytes = frame.leader.row_bytes(packet.header.stream);
  const std::size_t rows = packet.header.length / row_bytes;
  const std::size_t first = packet.header.index;
  if (packet.header.length % row_bytes != 0 || first + rows > frame.leader.height) {
    ++counters_.refused_packets;
    return;
  }
  // Not earlier: leaders alone would have memory allocated at the rate at which they come.
  const bool is_disparity = frame.leader.format == PixelFormat::kDisparity;
  frame.assembled.image.create(frame.leader.height, frame.leader.columns(packet.header.stream),
                               is_disparity ? CV_16UC1 : CV_8UC1);
  for (std::size_t i = 0; i < rows; ++i) {
    set_row(packet.payload + i * row_bytes, frame.assembled.image.row(static_cast<int>(first + i)));
    frame.has_row[first + i] = true;
  }
}

void FrameAssembler::end(const Packet& packet, Frame& frame, std::vector<AssembledFrame>& out) {
  if (packet.header.length != Trailer::kBytes) {
    ++counters_.refused_packets;
    return;
  }
  AssembledFrame& assembled = frame.assembled;
  assembled.flags = get_u32(packet.payload + kLinkTrailerFlagsAt);
  assembled.missing_rows =
      static_cast<int>(std::count(frame.has_row.begin(), frame.has_row.end(), false));
  if (assembled.flags != 0) return finish(frame, Verdict::kFlagged, out);
  if (assembled.missing_rows == 0) {
    const bool same =
        image_signature(assembled.image) == get_u32(packet.payload + kLinkTrailerSignatureAt);
    return finish(frame, same ? Verdict::kGood : Verdict::kBadSignature, out);
  }
  const bool is_kept = options_.keep_incomplete && assembled.stream == Stream::kDisparity &&
                       2 * assembled.missing_rows <= assembled.height;
  if (!is_kept) {
    return finish(frame, Verdict::kRowsMissing, out);
  }
  for (int y = 0; y < assembled.height; ++y) {
    if (!frame.has_row[static_cast<std::size_t>(y)]) assembled.image.row(y).setTo(kNoDisparity);
  }
  finish(frame, Verdict::kIncomplete, out);
}

void FrameAssembler::finish(Frame& frame, Verdict verdict, std::vector<AssembledFrame>& out) {
  frame.is_open = false;
  frame.assembled.verdict = verdict;
  if (verdict == Verdict::kGood) {
    ++counters_.good;
  } else if (verdict == Verdict::kIncomplete) {
    ++counters_.incomplete;
  } else {
    ++counters_.dropped;
    frame.assembled.image.release();
  }
  out.push_back(std::move(frame.assembled));
}

void FrameAssembler::reset(std::vector<AssembledFrame>& out) {
  for (Frame& frame : frames_) {
    if (frame.is_open) finish(frame, Verdict::kNoTrailer, out);
  }
}

std::optional<std::uint64_t> FrameAssembler::frame_in_flight(Stream stream) const {
  const auto number = static_cast<std::size_t>(stream);
  if (number >= frames_.size() || !frames_[number].is_open) return std::nullopt;
  return frames_[number].assembled.frame_id;
}

}  // namespace fpga_stereo::link
