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

/// A part that follows, as the head announces it.
struct BlockPart {
  ImageForm form = ImageForm::kLatents;
  int64_t size = 0;
};

/// What stands before the codes.
struct BlockHead {
  uint32_t scene = 0;
  std::vector<BlockPart> own;     ///< Backgrounds, per image member; or none.
  std::vector<BlockPart> images;  ///< Per image member.
};

Result<std::vector<BlockPart>> read_parts(ByteReader& reader, size_t count) {
  std::vector<BlockPart> parts;
  for (size_t i = 0; i < count; ++i) {
    const int64_t form = reader.get_varint();
    if (form < 0 || form > static_cast<int64_t>(ImageForm::kFfv1))
      return data_loss("block of latents: found form {}, needs 0 to {}", form,
                       static_cast<int>(ImageForm::kFfv1));
    parts.push_back({static_cast<ImageForm>(form), reader.get_varint()});
  }
  return parts;
}

Result<BlockHead> read_head(ByteReader& reader, size_t images, uint32_t scenes) {
  BlockHead head;
  const int64_t first = reader.get_varint();
  if (first < 0 || first >= int64_t{2} * scenes)
    return data_loss("block of latents: found scene {}, needs 0 to {}", first / 2, scenes - 1);
  head.scene = static_cast<uint32_t>(first / 2);
  if (first % 2 == 1) {
    ENGRAM_ASSIGN_OR_RETURN(head.own, read_parts(reader, images));
  }
  ENGRAM_ASSIGN_OR_RETURN(head.images, read_parts(reader, images));
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
    parts.push_back(is_video ? image.video : images[i].encode(image.latents));
    writer.put_varint(static_cast<int64_t>(image.form));
    writer.put_varint(static_cast<int64_t>(parts.back().size()));
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

Result<LatentRows> LatentBlockCodec::decode(std::span<const std::byte> block, size_t count,
                                            size_t wanted) const {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, without_checksum(block, "block of latents", count));
  ByteReader reader(bytes);
  ENGRAM_ASSIGN_OR_RETURN(const BlockHead head, read_head(reader, frames.size(), scenes));
  bytes = reader.rest();
  LatentRows rows;
  rows.scene = head.scene;
  for (size_t i = 0; i < head.own.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, head.own[i].size));
    ENGRAM_ASSIGN_OR_RETURN(
        rows.own.emplace_back(),
        decode_background(head.own[i].form, {part.begin(), part.end()}, frames[i]));
  }
  for (size_t i = 0; i < frames.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, head.images[i].size));
    rows.images.emplace_back().form = head.images[i].form;
    ENGRAM_RETURN_IF_ERROR(decode_image(i, part, count, wanted, rows.images.back()));
  }
  if (!numbers) return rows;
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, numbers->decode(bytes, count));
  rows.numbers.resize(wanted * numbers->model().count());
  return rows;
}

}  // namespace engram::encoders
