// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include <algorithm>
#include <array>

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

constexpr std::array<std::string_view, 5> kCodecNames{"", "h264", "h265", "av1", "ffv1"};

/// What stands before the codes.
struct BlockHead {
  uint32_t scene = 0;
  std::vector<ImageForm> forms;
  std::vector<int64_t> sizes;
};

Result<BlockHead> read_head(ByteReader& reader, size_t images, uint32_t scenes) {
  BlockHead head;
  const int64_t scene = reader.get_varint();
  if (scene < 0 || scene >= static_cast<int64_t>(scenes))
    return data_loss("block of latents: found scene {}, needs 0 to {}", scene, scenes - 1);
  head.scene = static_cast<uint32_t>(scene);
  for (size_t i = 0; i < images; ++i) {
    const int64_t form = reader.get_varint();
    if (form < 0 || form >= static_cast<int64_t>(kCodecNames.size()))
      return data_loss("block of latents: found form {}, needs 0 to {}", form,
                       kCodecNames.size() - 1);
    head.forms.push_back(static_cast<ImageForm>(form));
    head.sizes.push_back(reader.get_varint());
  }
  if (reader.failed()) return data_loss("block of latents: ends within its head");
  return head;
}

}  // namespace

std::string_view codec_name(ImageForm form) {
  return kCodecNames[static_cast<size_t>(form)];
}

std::optional<ImageForm> form_of_codec(std::string_view name) {
  const auto found = std::ranges::find(kCodecNames, name);
  if (name.empty() || found == kCodecNames.end()) return std::nullopt;
  return static_cast<ImageForm>(found - kCodecNames.begin());
}

std::vector<std::byte> LatentBlockCodec::encode(const LatentRows& rows, size_t count) const {
  ENGRAM_CHECK(rows.images.size() == frames.size(), "{} images of {}", rows.images.size(),
               frames.size());
  std::vector<std::vector<std::byte>> parts;
  ByteWriter writer;
  writer.put_varint(rows.scene);
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
  for (size_t i = 0; i < frames.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take(bytes, head.sizes[i]));
    rows.images.emplace_back().form = head.forms[i];
    ENGRAM_RETURN_IF_ERROR(decode_image(i, part, count, wanted, rows.images.back()));
  }
  if (!numbers) return rows;
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, numbers->decode(bytes, count));
  rows.numbers.resize(wanted * numbers->model().count());
  return rows;
}

}  // namespace engram::encoders
