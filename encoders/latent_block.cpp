// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"
#include "ltm/codec/group_codec.h"

namespace engram::encoders {

namespace {

/// The next `size` bytes.
Result<std::span<const std::byte>> take(std::span<const std::byte>& bytes, int64_t size) {
  if (size < 0 || static_cast<uint64_t>(size) > bytes.size())
    return data_loss("block of latents: found a part of {} bytes, needs at most {}", size,
                     bytes.size());
  const auto part = bytes.first(static_cast<size_t>(size));
  bytes = bytes.subspan(part.size());
  return part;
}

constexpr int64_t kRefined = 8;
constexpr int64_t kHasResidual = 16;

/// Of one image member, before the codes.
struct ImageHead {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;
  int64_t bytes = 0;
  std::optional<int64_t> residual_bytes;
};

/// Of a background that the block carries.
struct BackgroundHead {
  ImageForm form = ImageForm::kLatents;
  int64_t bytes = 0;
};

struct BlockHead {
  int64_t scene = 0;
  std::vector<BackgroundHead> own;  ///< Per image member, or none.
  std::vector<ImageHead> images;
};

Result<BackgroundHead> read_background_head(ByteReader& reader) {
  const int64_t form = reader.get_varint();
  if (form < 0 || form > static_cast<int64_t>(ImageForm::kFfv1))
    return data_loss("block of latents: found form {} of a background, needs 1 to {}", form,
                     static_cast<int>(ImageForm::kFfv1));
  return BackgroundHead{static_cast<ImageForm>(form), reader.get_varint()};
}

Result<ImageHead> read_image_head(ByteReader& reader) {
  ImageHead head;
  const int64_t form = reader.get_varint();
  const int64_t codec = form & (kRefined - 1);
  constexpr auto kMostCodec = static_cast<int64_t>(ImageForm::kFfv1);
  const bool is_known = form >= 0 && form < 2 * kHasResidual && codec <= kMostCodec;
  if (!is_known || (codec != 0 && form != codec))
    return data_loss("block of latents: found form {}, needs 0 to {}, or {}, {} or {}", form,
                     kMostCodec, kRefined, kHasResidual, kRefined + kHasResidual);
  head.form = static_cast<ImageForm>(codec);
  head.is_refined = (form & kRefined) != 0;
  head.bytes = reader.get_varint();
  if ((form & kHasResidual) != 0) head.residual_bytes = reader.get_varint();
  return head;
}

Result<BlockHead> read_head(ByteReader& reader, size_t images) {
  BlockHead head;
  const int64_t first = reader.get_varint();
  head.scene = first < 0 ? first : first / 2;
  if (first > 0 && first % 2 == 1)
    for (size_t i = 0; i < images; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(head.own.emplace_back(), read_background_head(reader));
    }
  for (size_t i = 0; i < images; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(head.images.emplace_back(), read_image_head(reader));
  }
  if (reader.failed()) return data_loss("block of latents: ends within its head");
  return head;
}

}  // namespace

std::vector<std::byte> LatentBlockCodec::encode(const LatentRows& rows, size_t count) const {
  ENGRAM_CHECK(rows.images.size() == frames.size(), "{} images of {}", rows.images.size(),
               frames.size());
  ENGRAM_CHECK(rows.own.empty() || rows.own.size() == frames.size(), "{} backgrounds of {}",
               rows.own.size(), frames.size());
  std::vector<std::vector<std::byte>> parts;
  ByteWriter writer;
  writer.put_varint(int64_t{2} * rows.scene + (rows.own.empty() ? 0 : 1));
  for (const CodedBackground& background : rows.own) {
    parts.push_back(background.bytes);
    writer.put_varint(static_cast<int64_t>(background.form));
    writer.put_varint(static_cast<int64_t>(background.bytes.size()));
  }
  for (size_t i = 0; i < frames.size(); ++i) {
    const ImageRows& image = rows.images[i];
    const bool is_video = image.form != ImageForm::kLatents;
    ENGRAM_CHECK(is_video || (i < images.size() &&
                              image.latents.size() == count * images[i].model().latents()),
                 "{} latents for {} rows", image.latents.size(), count);
    const bool has_residual = !is_video && !image.residual.empty();
    parts.push_back(is_video ? image.video : images[i].encode(image.latents));
    writer.put_varint(static_cast<int64_t>(image.form) +
                      (!is_video && image.is_refined ? kRefined : 0) +
                      (has_residual ? kHasResidual : 0));
    writer.put_varint(static_cast<int64_t>(parts.back().size()));
    if (!has_residual) continue;
    parts.push_back(image.residual);
    writer.put_varint(static_cast<int64_t>(image.residual.size()));
  }
  if (numbers) parts.push_back(numbers->encode(rows.numbers));
  std::vector<std::byte> block = writer.take();
  for (const auto& part : parts) block.insert(block.end(), part.begin(), part.end());
  return with_checksum(std::move(block), count);
}

Status LatentBlockCodec::decode_image(size_t image, std::span<const std::byte> bytes, size_t count,
                                      size_t wanted, ImageRows& rows) const {
  if (rows.form != ImageForm::kLatents) {
    const ltm::GroupCodec* codec = ltm::find_group_codec(codec_name(rows.form));
    ENGRAM_ASSIGN_OR_RETURN(rows.frames,
                            codec->decode(bytes, frames[image].type, frames[image].shape, count));
    return {};
  }
  if (image >= images.size())
    return data_loss("block of latents: found latents of image {}, its model has none", image);
  ENGRAM_ASSIGN_OR_RETURN(rows.latents, images[image].decode(bytes, count, wanted));
  return {};
}

Status LatentBlockCodec::decode_residual(size_t image, std::span<const std::byte> bytes,
                                         size_t count, size_t wanted, ImageRows& rows) const {
  if (frames[image].type != idf::ElementType::kUInt8)
    return data_loss("block of latents: found residuals of image {}, which has {} elements", image,
                     idf::to_string(frames[image].type));
  ENGRAM_ASSIGN_OR_RETURN(rows.residuals,
                          decode_residuals(bytes, frames[image].pixels(), count, wanted));
  return {};
}

Result<std::vector<ImageCode>> describe_block(std::span<const std::byte> block, size_t count,
                                              size_t images) {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, without_checksum(block, "block of latents", count));
  ByteReader reader(bytes);
  ENGRAM_ASSIGN_OR_RETURN(const BlockHead head, read_head(reader, images));
  bytes = reader.rest();
  std::vector<ImageCode> codes(images);
  for (size_t i = 0; i < head.own.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, head.own[i].bytes));
    codes[i].background_bytes = part.size();
  }
  for (size_t i = 0; i < images; ++i) {
    const ImageHead& image = head.images[i];
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, image.bytes));
    ImageCode& code = codes[i];
    code.form = image.form;
    code.is_refined = image.is_refined;
    code.bytes = part.size();
    if (!image.residual_bytes) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto residual, take(bytes, *image.residual_bytes));
    ENGRAM_ASSIGN_OR_RETURN(code.residual_bytes, residual_bytes(residual, count));
  }
  return codes;
}

Result<LatentRows> LatentBlockCodec::decode(std::span<const std::byte> block, size_t count,
                                            size_t wanted) const {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, without_checksum(block, "block of latents", count));
  ByteReader reader(bytes);
  ENGRAM_ASSIGN_OR_RETURN(const BlockHead head, read_head(reader, frames.size()));
  if (head.scene < 0 || head.scene >= static_cast<int64_t>(scenes))
    return data_loss("block of latents: found scene {}, needs 0 to {}", head.scene, scenes - 1);
  bytes = reader.rest();
  LatentRows rows;
  rows.scene = static_cast<uint32_t>(head.scene);
  for (size_t i = 0; i < head.own.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, head.own[i].bytes));
    ENGRAM_ASSIGN_OR_RETURN(
        rows.own.emplace_back(),
        decode_background(head.own[i].form, {part.begin(), part.end()}, frames[i]));
  }
  for (size_t i = 0; i < frames.size(); ++i) {
    const ImageHead& image = head.images[i];
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, image.bytes));
    ImageRows& decoded = rows.images.emplace_back();
    decoded.form = image.form;
    decoded.is_refined = image.is_refined;
    ENGRAM_RETURN_IF_ERROR(decode_image(i, part, count, wanted, decoded));
    if (!image.residual_bytes) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto residual, take(bytes, *image.residual_bytes));
    ENGRAM_RETURN_IF_ERROR(decode_residual(i, residual, count, wanted, decoded));
  }
  if (!numbers) return rows;
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, numbers->decode(bytes, count));
  rows.numbers.resize(wanted * numbers->model().count());
  return rows;
}

}  // namespace engram::encoders
