// SPDX-License-Identifier: Apache-2.0
#include "encoders/gist_video.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>

#include "encoders/coding/binary_coder.h"
#include "encoders/coding/byte_stream.h"
#include "encoders/coding/packet_coder.h"
#include "encoders/gist_rows.h"
#include "ltm/codec/av1_packets.h"
#include "ltm/codec/group_codec.h"
#include "ltm/codec/packed_value.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

constexpr std::string_view kGist = "gist";
constexpr int64_t kGistVersion = 1;
/// Images with a longer side than this are made smaller. At the rates of a gist, fewer pixels show
/// no less of them.
constexpr int64_t kMaxGistSide = 160;
/// Longer side of the images in which the kept rows are chosen.
constexpr int64_t kMaxThumbnailSide = 64;
/// AV1 encoders refuse smaller pictures.
constexpr int64_t kMinGistSide = 16;
constexpr int64_t kMaxFactor = 1024;
/// Maximum number of pixels, because a few bytes may announce any size.
constexpr int64_t kMaxGistPixels = 1 << 26;

idf::Shape divided(const idf::Shape& shape, int64_t factor) {
  return {(shape[0] + factor - 1) / factor, (shape[1] + factor - 1) / factor, shape[2]};
}

/// The smallest whole factor that keeps the longer side within `max_side` and the shorter one
/// codable.
int64_t factor_for(const idf::Shape& shape, int64_t max_side) {
  const int64_t factor = (std::max(shape[0], shape[1]) + max_side - 1) / max_side;
  return std::clamp<int64_t>(factor, 1, std::min(shape[0], shape[1]) / kMinGistSide);
}

/// The image in another size.
idf::NdArray resized(const idf::NdArray& image, const idf::Shape& shape, int how) {
  if (image.shape() == shape) return image;
  const int type = CV_MAKETYPE(CV_8U, static_cast<int>(shape[2]));
  // cv::Mat has no const view, but the image is only read.
  const cv::Mat from(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]), type,
                     const_cast<std::byte*>(image.bytes().data()));
  std::vector<uint8_t> pixels(static_cast<size_t>(shape[0] * shape[1] * shape[2]));
  cv::Mat to(static_cast<int>(shape[0]), static_cast<int>(shape[1]), type, pixels.data());
  cv::resize(from, to, to.size(), 0, 0, how);
  return idf::NdArray::take<uint8_t>(shape, std::move(pixels));
}

/// An image between two others, `at` of `gap` steps after the first one. Integers alone, so that it
/// is the same everywhere.
idf::NdArray between(const idf::NdArray& a, const idf::NdArray& b, size_t at, size_t gap) {
  const auto from = a.values<uint8_t>();
  const auto to = b.values<uint8_t>();
  std::vector<uint8_t> pixels(from.size());
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<uint8_t>(((gap - at) * from[i] + at * to[i] + gap / 2) / gap);
  return idf::NdArray::take<uint8_t>(a.shape(), std::move(pixels));
}

Status check_gist_images(std::span<const idf::NdArray> images) {
  if (images.empty() || images.size() > ltm::kMaxGroupImages)
    return invalid_argument("{}: found {} images, needs 1 to {}", kGist, images.size(),
                            ltm::kMaxGroupImages);
  const idf::NdArray& first = images.front();
  for (const idf::NdArray& image : images)
    if (!can_be_gist({image.type(), image.shape()}) || image.shape() != first.shape())
      return invalid_argument(
          "{}: found an image {} {}, needs uint8 [H, W, 1] or [H, W, 3] with sides of {} at least "
          "and 2^26 pixels at most, "
          "all alike",
          kGist, idf::to_string(image.type()), idf::to_string(image.shape()), kMinGistSide);
  return {};
}

std::vector<size_t> rows_to_keep(std::span<const idf::NdArray> images, const GistOptions& options) {
  const idf::Shape shape =
      divided(images.front().shape(), factor_for(images.front().shape(), kMaxThumbnailSide));
  std::vector<std::vector<uint8_t>> rows;
  for (const idf::NdArray& image : images) {
    const idf::NdArray small = resized(image, shape, cv::INTER_AREA);
    rows.emplace_back(small.values<uint8_t>().begin(), small.values<uint8_t>().end());
  }
  return choose_gist_rows(rows, {.gain_db = options.gain_db, .max_gap = options.max_gap});
}

Result<std::vector<std::vector<std::byte>>> code_kept(std::span<const idf::NdArray> kept,
                                                      const GistOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto codec,
                          ltm::make_group_codec("av1:depth=10,crf=" + std::to_string(options.crf) +
                                                ",effort=" + std::to_string(options.effort)));
  ENGRAM_ASSIGN_OR_RETURN(const auto video, codec->encode(kept));
  ENGRAM_ASSIGN_OR_RETURN(auto packets, ltm::av1_packets(video));
  return std::move(packets.packets);
}

/// The part of a gist that is needed for some of its images.
struct GistPart {
  int64_t factor = 1;
  std::vector<size_t> rows;  ///< Kept rows, ascending, from 0 on.
  std::vector<std::vector<std::byte>> packets;
};

/// Reads the kept rows up to the first one that is `last` or follows it.
Status read_kept(BinaryDecoder& decoder, size_t kept, size_t count, size_t last, GistPart& part) {
  PacketCoder packets;
  IntegerModel gaps;
  for (size_t i = 0; i < kept && (part.rows.empty() || part.rows.back() < last); ++i) {
    size_t row = 0;
    if (i > 0) {
      const int64_t skipped = gaps.code(decoder, 0);
      row = part.rows.back() + 1;
      if (skipped < 0 || row >= count || static_cast<uint64_t>(skipped) >= count - row)
        return data_loss("{}: found a kept row {} rows behind row {} of {}", kGist, skipped, row,
                         count);
      row += static_cast<size_t>(skipped);
    }
    part.rows.push_back(row);
    std::vector<PacketUnit> units;
    ENGRAM_RETURN_IF_ERROR(packets.code(decoder, units));
    part.packets.push_back(join_units(units));
  }
  return {};
}

Result<GistPart> read_part(std::span<const std::byte> gist, const FrameShape& frame, size_t count,
                           size_t wanted) {
  ByteReader reader(gist);
  if (const int64_t version = reader.get_varint(); version != kGistVersion)
    return data_loss("{}: found version {}, needs {}", kGist, version, kGistVersion);
  GistPart part;
  part.factor = reader.get_varint();
  const int64_t kept = reader.get_varint();
  if (reader.failed()) return data_loss("{}: ends within its head", kGist);
  if (part.factor < 1 || part.factor > kMaxFactor ||
      !can_be_gist({frame.type, divided(frame.shape, part.factor)}))
    return data_loss("{}: found images {} made {} times smaller, needs sides of {} at least", kGist,
                     idf::to_string(frame.shape), part.factor, kMinGistSide);
  if (kept < 1 || static_cast<uint64_t>(kept) > count)
    return data_loss("{}: found {} kept of {} images", kGist, kept, count);
  BinaryDecoder decoder(reader.rest());
  ENGRAM_RETURN_IF_ERROR(read_kept(decoder, static_cast<size_t>(kept), count, wanted - 1, part));
  return part;
}

/// The rows from kept ones. Those after the last kept one repeat it.
std::vector<idf::NdArray> spread(const std::vector<size_t>& rows,
                                 const std::vector<idf::NdArray>& kept, size_t wanted,
                                 const idf::Shape& shape) {
  std::vector<idf::NdArray> images;
  for (size_t row = 0, next = 0; row < wanted; ++row) {
    while (next < rows.size() && rows[next] < row) ++next;
    const bool is_kept = next < rows.size() && rows[next] == row;
    const idf::NdArray small = is_kept ? kept[next]
                               : next == rows.size()
                                   ? kept.back()
                                   : between(kept[next - 1], kept[next], row - rows[next - 1],
                                             rows[next] - rows[next - 1]);
    images.push_back(resized(small, shape, cv::INTER_LINEAR_EXACT));
  }
  return images;
}

}  // namespace

bool can_be_gist(const FrameShape& frame) {
  return frame.type == idf::ElementType::kUInt8 && frame.shape.size() == 3 &&
         std::min(frame.shape[0], frame.shape[1]) >= kMinGistSide &&
         frame.shape[0] <= kMaxGistPixels / frame.shape[1] &&
         (frame.shape[2] == 1 || frame.shape[2] == 3);
}

Status GistOptions::validate() const {
  if (crf < 0 || crf > 63) return invalid_argument("gist: crf {}, needs 0 to 63", crf);
  if (effort < 0 || effort > 9) return invalid_argument("gist: effort {}, needs 0 to 9", effort);
  if (!(gain_db >= 0)) return invalid_argument("gist: gain of {} dB, needs 0 at least", gain_db);
  if (max_gap < 1 || max_gap > ltm::kMaxGroupImages)
    return invalid_argument("gist: gap of {} rows, needs 1 to {}", max_gap, ltm::kMaxGroupImages);
  return {};
}

Result<std::vector<std::byte>> encode_gist(std::span<const idf::NdArray> images,
                                           const GistOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_RETURN_IF_ERROR(check_gist_images(images));
  const std::vector<size_t> rows = rows_to_keep(images, options);
  const int64_t factor = factor_for(images.front().shape(), kMaxGistSide);
  std::vector<idf::NdArray> kept;
  for (const size_t row : rows)
    kept.push_back(resized(images[row], divided(images.front().shape(), factor), cv::INTER_AREA));
  ENGRAM_ASSIGN_OR_RETURN(const auto packets, code_kept(kept, options));
  ByteWriter writer;
  for (const int64_t number : {kGistVersion, factor, static_cast<int64_t>(rows.size())})
    writer.put_varint(number);
  BinaryEncoder encoder;
  PacketCoder coder;
  IntegerModel gaps;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) gaps.code(encoder, static_cast<int64_t>(rows[i] - rows[i - 1] - 1));
    ENGRAM_ASSIGN_OR_RETURN(auto units, split_units(packets[i]));
    ENGRAM_RETURN_IF_ERROR(coder.code(encoder, units));
  }
  std::vector<std::byte> gist = writer.take();
  const std::vector<std::byte> coded = encoder.finish();
  gist.insert(gist.end(), coded.begin(), coded.end());
  return gist;
}

Result<std::vector<size_t>> kept_rows_of_gist(std::span<const std::byte> gist,
                                              const FrameShape& frame, size_t count) {
  if (!can_be_gist(frame) || count == 0)
    return data_loss("{}: found {} images {}", kGist, count, idf::to_string(frame.shape));
  ENGRAM_ASSIGN_OR_RETURN(GistPart part, read_part(gist, frame, count, count));
  return std::move(part.rows);
}

Result<std::vector<idf::NdArray>> decode_gist(std::span<const std::byte> gist,
                                              const FrameShape& frame, size_t count,
                                              size_t wanted) {
  ENGRAM_CHECK(wanted <= count, "{} of {} images", wanted, count);
  if (!can_be_gist(frame))
    return data_loss("{}: found images {} {}, needs uint8 [H, W, 1] or [H, W, 3]", kGist,
                     idf::to_string(frame.type), idf::to_string(frame.shape));
  if (wanted == 0) return std::vector<idf::NdArray>();
  ENGRAM_ASSIGN_OR_RETURN(GistPart part, read_part(gist, frame, count, wanted));
  const idf::Shape small = divided(frame.shape, part.factor);
  const ltm::GroupCodec* codec = ltm::find_group_codec("av1");
  auto kept =
      codec->decode(ltm::av1_group({.is_deep = true, .packets = std::move(part.packets)}, small),
                    frame.type, small, part.rows.size());
  if (!kept.ok()) return kept.status().with_context(kGist);
  return spread(part.rows, *kept, wanted, frame.shape);
}

}  // namespace engram::encoders
