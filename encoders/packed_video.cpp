// SPDX-License-Identifier: Apache-2.0
#include "encoders/packed_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "encoders/coding/binary_coder.h"
#include "encoders/coding/byte_stream.h"
#include "encoders/coding/packet_coder.h"
#include "ltm/codec/av1_packets.h"
#include "ltm/codec/group_codec.h"

namespace engram::encoders {

namespace {

constexpr std::string_view kPacked = "packed video";
constexpr std::string_view kAv1Codec = "av1";
constexpr int64_t kDeepFlag = 1, kReferenceFlag = 2;
/// The picture of a reference is coded so much better than its key frame, which is made of it: a
/// key frame of the same quality would add as much error again.
constexpr int kPictureBetter = 8;
/// A usual distance of crf from the key, to make the key frame with.
constexpr int kUsualAbove = 5;
constexpr int kThumbnailSide = 32;

std::string codec_text(int crf, std::string_view settings) {
  return fmt::format("{}:crf={},{}", kAv1Codec, crf, settings);
}

std::string codec_text(int crf, int key, std::string_view settings) {
  return fmt::format("{},key={}", codec_text(crf, settings), key);
}

struct PackedHead {
  bool is_deep = false;
  std::optional<uint64_t> reference;
};

Result<PackedHead> read_packed_head(ByteReader& reader) {
  const int64_t flags = reader.get_varint();
  if (flags < 0 || flags > (kDeepFlag | kReferenceFlag))
    return data_loss("{}: found flags {}, needs 0 to {}", kPacked, flags,
                     kDeepFlag | kReferenceFlag);
  PackedHead head{.is_deep = (flags & kDeepFlag) != 0, .reference = {}};
  if ((flags & kReferenceFlag) != 0) head.reference = reader.get<uint64_t>();
  if (reader.failed()) return data_loss("{}: ends within its head", kPacked);
  return head;
}

/// The image in small.
cv::Mat thumbnail_of(const idf::NdArray& image) {
  const auto& shape = image.shape();
  const auto side = [](int64_t length) {
    return static_cast<int>(std::min<int64_t>(length, kThumbnailSide));
  };
  const int type = CV_MAKETYPE(CV_8U, static_cast<int>(shape[2]));
  // cv::Mat has no const view, but the image is only read.
  const cv::Mat from(static_cast<int>(shape[0]), static_cast<int>(shape[1]), type,
                     const_cast<std::byte*>(image.bytes().data()));
  cv::Mat small;
  cv::resize(from, small, cv::Size(side(shape[1]), side(shape[0])), 0, 0, cv::INTER_AREA);
  return small;
}

}  // namespace

double reference_distance(const idf::NdArray& a, const idf::NdArray& b) {
  ENGRAM_CHECK(a.shape() == b.shape() && a.shape().size() == 3, "shapes {} and {}",
               idf::to_string(a.shape()), idf::to_string(b.shape()));
  const cv::Mat small = thumbnail_of(a), other = thumbnail_of(b);
  const double norm = cv::norm(small, other, cv::NORM_L2);
  return norm * norm / static_cast<double>(small.total() * small.channels());
}

Result<std::vector<std::byte>> pack_video(std::span<const std::byte> group,
                                          const VideoReference* reference) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Av1Packets video, ltm::av1_packets(group));
  std::span packets(video.packets);
  if (reference != nullptr) {
    if (packets.empty() || packets.front() != reference->key_frame ||
        video.is_deep != reference->is_deep)
      return invalid_argument("{}: begins otherwise than its reference", kPacked);
    packets = packets.subspan(1);
  }
  ByteWriter writer;
  writer.put_varint((video.is_deep ? kDeepFlag : 0) + (reference != nullptr ? kReferenceFlag : 0));
  if (reference != nullptr) writer.put(reference->hash());
  BinaryEncoder encoder;
  PacketCoder coder;
  for (const auto& packet : packets) {
    ENGRAM_ASSIGN_OR_RETURN(auto units, split_units(packet));
    ENGRAM_RETURN_IF_ERROR(coder.code(encoder, units));
  }
  std::vector<std::byte> packed = writer.take();
  const std::vector<std::byte> coded = encoder.finish();
  packed.insert(packed.end(), coded.begin(), coded.end());
  return packed;
}

Result<std::vector<idf::NdArray>> unpack_video(std::span<const std::byte> packed,
                                               const FrameShape& frame, size_t count, size_t wanted,
                                               std::span<const VideoReference> references) {
  ENGRAM_CHECK(wanted <= count, "{} of {} images", wanted, count);
  if (frame.type != idf::ElementType::kUInt8 || frame.shape.size() != 3)
    return data_loss("{}: found images {} {}, needs uint8 [H, W, C]", kPacked,
                     idf::to_string(frame.type), idf::to_string(frame.shape));
  const ltm::GroupCodec* codec = ltm::find_group_codec(kAv1Codec);
  if (!codec->accepts(frame.type, frame.shape))
    return data_loss("{}: no video has images {}", kPacked, idf::to_string(frame.shape));
  if (wanted == 0) return std::vector<idf::NdArray>();
  ByteReader reader(packed);
  ENGRAM_ASSIGN_OR_RETURN(const PackedHead head, read_packed_head(reader));
  ltm::Av1Packets video{.is_deep = head.is_deep, .packets = {}};
  if (head.reference) {
    const auto found = std::ranges::find(references, *head.reference, &VideoReference::hash);
    if (found == references.end())
      return data_loss("{}: needs reference {:016x}, which its model does not have", kPacked,
                       *head.reference);
    video.packets.push_back(found->key_frame);
  }
  BinaryDecoder decoder(reader.rest());
  PacketCoder packets;
  for (size_t i = 0; i < wanted; ++i) {
    std::vector<PacketUnit> units;
    ENGRAM_RETURN_IF_ERROR(packets.code(decoder, units));
    video.packets.push_back(join_units(units));
  }
  const size_t pictures = video.packets.size();
  auto images = codec->decode(ltm::av1_group(std::move(video), frame.shape), frame.type,
                              frame.shape, pictures);
  if (!images.ok()) return images.status().with_context(kPacked);
  if (head.reference) images->erase(images->begin());
  return images;
}

StoredVideo to_stored_video(std::string_view codec, std::vector<std::byte> group) {
  if (codec == kAv1Codec)
    if (auto packed = pack_video(group, nullptr); packed.ok())
      return {ImageForm::kPackedAv1, *std::move(packed)};
  const auto form = form_of_codec(codec);
  ENGRAM_CHECK(form.has_value(), "no form of '{}'", codec);
  return {*form, std::move(group)};
}

Result<std::vector<idf::NdArray>> decode_stored_video(ImageForm form,
                                                      std::span<const std::byte> bytes,
                                                      const FrameShape& frame, size_t count,
                                                      size_t wanted,
                                                      std::span<const VideoReference> references) {
  if (form == ImageForm::kPackedAv1) return unpack_video(bytes, frame, count, wanted, references);
  const ltm::GroupCodec* codec = ltm::find_group_codec(codec_name(form));
  if (codec == nullptr)
    return data_loss("video: found form {}, which is none", static_cast<int>(form));
  return codec->decode_first(bytes, frame.type, frame.shape, count, wanted);
}

Result<std::optional<uint64_t>> reference_of_video(std::span<const std::byte> packed) {
  ByteReader reader(packed);
  ENGRAM_ASSIGN_OR_RETURN(const PackedHead head, read_packed_head(reader));
  return head.reference;
}

Result<OpenReference> make_reference(const idf::NdArray& image, int key,
                                     std::string_view settings) {
  ENGRAM_ASSIGN_OR_RETURN(
      const auto picture_codec,
      ltm::make_group_codec(codec_text(std::max(key - kPictureBetter, 1), settings)));
  ENGRAM_ASSIGN_OR_RETURN(const auto group, picture_codec->encode({&image, 1}));
  OpenReference open;
  ENGRAM_ASSIGN_OR_RETURN(open.reference.picture, pack_video(group, nullptr));
  ENGRAM_ASSIGN_OR_RETURN(auto shown, picture_codec->decode(group, image.type(), image.shape(), 1));
  open.picture = std::move(shown.front());
  const int crf = std::min(key + kUsualAbove, 63);
  ENGRAM_ASSIGN_OR_RETURN(const auto codec, ltm::make_group_codec(codec_text(crf, key, settings)));
  const std::vector twice{open.picture, open.picture}, changed{open.picture, image};
  ENGRAM_ASSIGN_OR_RETURN(const auto video, codec->encode(twice));
  ENGRAM_ASSIGN_OR_RETURN(const auto other, codec->encode(changed));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Av1Packets packets, ltm::av1_packets(video));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Av1Packets others, ltm::av1_packets(other));
  if (packets.packets.front() != others.packets.front())
    return failed_precondition("{}: key frames of this encoder depend on what follows", kAv1Codec);
  open.reference.is_deep = packets.is_deep;
  open.reference.key_frame = std::move(packets.packets.front());
  open.reference.key = key;
  return open;
}

Result<OpenReference> open_reference(const VideoReference& reference, const FrameShape& frame) {
  ENGRAM_ASSIGN_OR_RETURN(auto images, unpack_video(reference.picture, frame, 1, 1, {}));
  return OpenReference{reference, std::move(images.front())};
}

Result<std::optional<std::vector<std::byte>>> encode_from(const OpenReference& reference,
                                                          std::span<const idf::NdArray> images,
                                                          int crf, std::string_view settings) {
  using Packed = std::optional<std::vector<std::byte>>;
  ENGRAM_ASSIGN_OR_RETURN(
      const auto codec, ltm::make_group_codec(codec_text(crf, reference.reference.key, settings)));
  std::vector<idf::NdArray> all{reference.picture};
  all.insert(all.end(), images.begin(), images.end());
  ENGRAM_ASSIGN_OR_RETURN(const auto group, codec->encode(all));
  auto packed = pack_video(group, &reference.reference);
  if (packed.status().code() == StatusCode::kInvalidArgument) return Packed();
  ENGRAM_RETURN_IF_ERROR(packed.status());
  return Packed(*std::move(packed));
}

}  // namespace engram::encoders
