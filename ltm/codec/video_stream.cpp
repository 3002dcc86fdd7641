// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/video_stream.h"

#include <cstring>

namespace engram::ltm {

namespace {

constexpr uint32_t kStreamVersion = 1;

void put(std::vector<std::byte>& out, uint32_t value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void put(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  put(out, static_cast<uint32_t>(bytes.size()));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Reads numbers and byte strings from the front. After one read past the end all reads fail, so
/// the caller checks once, at the end.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) : rest_(bytes) {}

  uint32_t number() {
    uint32_t value = 0;
    const auto bytes = take(sizeof(value));
    if (is_ok_) std::memcpy(&value, bytes.data(), sizeof(value));
    return value;
  }
  std::vector<std::byte> string() {
    const auto bytes = take(number());
    return {bytes.begin(), bytes.end()};
  }
  [[nodiscard]] bool is_ok() const { return is_ok_; }
  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> take(size_t size) {
    is_ok_ = is_ok_ && size <= rest_.size();
    if (!is_ok_) return {};
    const auto bytes = rest_.first(size);
    rest_ = rest_.subspan(size);
    return bytes;
  }

  std::span<const std::byte> rest_;
  bool is_ok_ = true;
};

/// Collects the packets that the encoder has ready.
Status drain_encoder(AVCodecContext& encoder, AVPacket& packet, VideoGroup& group) {
  while (true) {
    const int code = avcodec_receive_packet(&encoder, &packet);
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
    if (code < 0) return invalid_argument("cannot encode: {}", libav::describe(code));
    const auto* bytes = reinterpret_cast<const std::byte*>(packet.data);
    group.packets.push_back({static_cast<int32_t>(packet.pts), {bytes, bytes + packet.size}});
    av_packet_unref(&packet);
  }
}

class Decoding {
 public:
  Decoding(AVCodecContext& decoder, const VideoGroup& group, idf::ElementType type,
           const idf::Shape& shape)
      : decoder_(decoder), group_(group), type_(type), shape_(shape) {}

  Result<std::vector<idf::NdArray>> run(size_t wanted) {
    if (!picture_ || !packet_) return resource_exhausted("no memory for a picture");
    for (const VideoPacket& packet : group_.packets) {
      ENGRAM_RETURN_IF_ERROR(feed(packet));
      if (wanted == group_.count || arrays_.size() < wanted) continue;
      arrays_.resize(wanted);
      return std::move(arrays_);
    }
    avcodec_send_packet(&decoder_, nullptr);
    ENGRAM_RETURN_IF_ERROR(drain());
    if (arrays_.size() != group_.count)
      return data_loss("{} pictures, announced {}", arrays_.size(), group_.count);
    arrays_.resize(wanted);
    return std::move(arrays_);
  }

 private:
  Status feed(const VideoPacket& packet) {
    // Decoders read beyond the end of a packet; av_new_packet adds zeros there.
    if (av_new_packet(packet_.get(), static_cast<int>(packet.bytes.size())) < 0)
      return resource_exhausted("no memory for a packet");
    if (!packet.bytes.empty()) std::memcpy(packet_->data, packet.bytes.data(), packet.bytes.size());
    packet_->pts = packet.order;
    while (true) {
      const int code = avcodec_send_packet(&decoder_, packet_.get());
      if (code == AVERROR(EAGAIN)) {
        const size_t before = arrays_.size();
        ENGRAM_RETURN_IF_ERROR(drain());
        // A decoder that accepts no packet and gives no picture would loop forever on hostile
        // bytes.
        if (arrays_.size() == before) return data_loss("the decoder is stuck");
        continue;
      }
      av_packet_unref(packet_.get());
      if (code < 0) return data_loss("cannot decode: {}", libav::describe(code));
      return drain();
    }
  }

  Status drain() {
    while (true) {
      const int code = avcodec_receive_frame(&decoder_, picture_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
      if (code < 0) return data_loss("cannot decode: {}", libav::describe(code));
      if (arrays_.size() == group_.count)
        return data_loss("more pictures than the announced {}", group_.count);
      if ((picture_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || picture_->decode_error_flags != 0)
        return data_loss("picture {} is damaged", arrays_.size());
      ENGRAM_ASSIGN_OR_RETURN(auto array, read_picture(*picture_, group_.layout, type_, shape_));
      arrays_.push_back(std::move(array));
      av_frame_unref(picture_.get());
    }
  }

  AVCodecContext& decoder_;
  const VideoGroup& group_;
  const idf::ElementType type_;
  const idf::Shape& shape_;
  const libav::Owned<AVFrame> picture_{av_frame_alloc()};
  const libav::Owned<AVPacket> packet_{av_packet_alloc()};
  std::vector<idf::NdArray> arrays_;
};

}  // namespace

std::vector<std::byte> VideoGroup::to_bytes() const {
  std::vector<std::byte> out;
  for (const uint32_t number :
       {kStreamVersion, static_cast<uint32_t>(layout), count, height, width})
    put(out, number);
  put(out, setup);
  put(out, static_cast<uint32_t>(packets.size()));
  for (const VideoPacket& packet : packets) {
    put(out, static_cast<uint32_t>(packet.order));
    put(out, packet.bytes);
  }
  return out;
}

Result<VideoGroup> VideoGroup::from_bytes(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  if (const uint32_t version = cursor.number(); version != kStreamVersion)
    return data_loss("group of version {}, needs {}", version, kStreamVersion);
  VideoGroup group;
  const uint32_t layout = cursor.number();
  if (layout > static_cast<uint32_t>(PictureLayout::kGray8Deep))
    return data_loss("group of unknown picture layout {}", layout);
  group.layout = static_cast<PictureLayout>(layout);
  group.count = cursor.number();
  group.height = cursor.number();
  group.width = cursor.number();
  group.setup = cursor.string();
  for (uint32_t left = cursor.number(); left > 0 && cursor.is_ok(); --left) {
    VideoPacket packet;
    packet.order = static_cast<int32_t>(cursor.number());
    packet.bytes = cursor.string();
    group.packets.push_back(std::move(packet));
  }
  if (!cursor.is_ok() || !cursor.is_at_end())
    return data_loss("group of {} bytes ends elsewhere than its {} pictures", bytes.size(),
                     group.count);
  return group;
}

Result<VideoGroup> encode_group(AVCodecContext& encoder, PictureLayout layout,
                                std::span<const idf::NdArray> arrays) {
  const idf::Shape& shape = arrays[0].shape();
  VideoGroup group{.layout = layout,
                   .count = static_cast<uint32_t>(arrays.size()),
                   .height = static_cast<uint32_t>(shape[0]),
                   .width = static_cast<uint32_t>(shape[1])};
  const libav::Owned<AVPacket> packet(av_packet_alloc());
  ENGRAM_ASSIGN_OR_RETURN(const auto picture, make_picture(layout, shape));
  if (!packet) return resource_exhausted("no memory for a packet");
  for (size_t i = 0; i <= arrays.size(); ++i) {
    const bool is_end = i == arrays.size();
    if (!is_end) {
      // The encoder may still use the previous pictures.
      if (av_frame_make_writable(picture.get()) < 0)
        return resource_exhausted("no memory for a picture");
      write_picture(arrays[i], layout, *picture);
      picture->pts = static_cast<int64_t>(i);
    }
    if (const int code = avcodec_send_frame(&encoder, is_end ? nullptr : picture.get()); code < 0)
      return invalid_argument("cannot encode: {}", libav::describe(code));
    ENGRAM_RETURN_IF_ERROR(drain_encoder(encoder, *packet, group));
  }
  const auto* setup = reinterpret_cast<const std::byte*>(encoder.extradata);
  if (setup != nullptr) group.setup.assign(setup, setup + encoder.extradata_size);
  return group;
}

Result<std::vector<idf::NdArray>> decode_group(AVCodecContext& decoder, const VideoGroup& group,
                                               idf::ElementType type, const idf::Shape& shape,
                                               size_t wanted) {
  return Decoding(decoder, group, type, shape).run(wanted);
}

}  // namespace engram::ltm
