// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_chain.h"

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"
#include "encoders/gist_video.h"

namespace engram::encoders {

namespace {

constexpr std::string_view kChain = "chain of latents";
constexpr int64_t kRefined = 8;
constexpr int64_t kHasResidual = 16;

/// Whether images of a form may have residuals. What has no loss needs none, and a gist keeps no
/// bound.
bool may_have_residuals(ImageForm form) {
  return form != ImageForm::kFfv1 && form != ImageForm::kGist;
}

/// The head of one image member. All heads precede the codes.
struct ImageHead {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;
  int64_t bytes = 0;
  std::optional<int64_t> residual_bytes;
};

Result<ImageHead> read_image_head(ByteReader& reader) {
  ImageHead head;
  const int64_t form = reader.get_varint();
  const int64_t codec = form & (kRefined - 1);
  constexpr auto kMaxForm = static_cast<int64_t>(ImageForm::kPackedAv1);
  const bool is_known = form >= 0 && form < 2 * kHasResidual && codec <= kMaxForm;
  head.form = static_cast<ImageForm>(codec);
  // Only latents are refined.
  if (!is_known || (codec != 0 && (form & kRefined) != 0) ||
      ((form & kHasResidual) != 0 && !may_have_residuals(head.form)))
    return data_loss(
        "{}: found form {}, needs 0 to {}, {} more for refined latents, {} more for "
        "residuals of latents and videos with loss",
        kChain, form, kMaxForm, kRefined, kHasResidual);
  head.is_refined = (form & kRefined) != 0;
  head.bytes = reader.get_varint();
  if ((form & kHasResidual) != 0) head.residual_bytes = reader.get_varint();
  return head;
}

Result<std::vector<ImageHead>> read_heads(ByteReader& reader, size_t images) {
  std::vector<ImageHead> heads;
  for (size_t i = 0; i < images; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(heads.emplace_back(), read_image_head(reader));
  }
  if (reader.failed()) return data_loss("{}: ends within its head", kChain);
  return heads;
}

}  // namespace

std::vector<std::byte> LatentChainCodec::encode(const LatentRows& rows, size_t count) const {
  ENGRAM_CHECK(rows.images.size() == frames.size(), "{} images of {}", rows.images.size(),
               frames.size());
  std::vector<std::vector<std::byte>> parts;
  ByteWriter writer;
  for (size_t i = 0; i < frames.size(); ++i) {
    const ImageRows& image = rows.images[i];
    const bool is_video = image.form != ImageForm::kLatents;
    ENGRAM_CHECK(is_video || (i < images.size() &&
                              image.latents.size() == count * images[i].model().latents()),
                 "{} latents for {} rows", image.latents.size(), count);
    const bool has_residual = !image.residual.empty();
    ENGRAM_CHECK(!has_residual || may_have_residuals(image.form), "residuals of form {}",
                 static_cast<int>(image.form));
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
  std::vector<std::byte> chain = writer.take();
  for (const auto& part : parts) chain.insert(chain.end(), part.begin(), part.end());
  return chain;
}

Status LatentChainCodec::decode_image(size_t image, std::span<const std::byte> bytes, size_t count,
                                      size_t wanted, ImageRows& rows) const {
  if (rows.form == ImageForm::kGist) {
    ENGRAM_ASSIGN_OR_RETURN(rows.frames, decode_gist(bytes, frames[image], count, wanted));
    return {};
  }
  if (rows.form != ImageForm::kLatents) {
    ENGRAM_ASSIGN_OR_RETURN(rows.frames, decode_stored_video(rows.form, bytes, frames[image], count,
                                                             wanted, references_of(image)));
    return {};
  }
  if (image >= images.size())
    return data_loss("{}: found latents of image {}, its model has none", kChain, image);
  ENGRAM_ASSIGN_OR_RETURN(rows.latents, images[image].decode(bytes, count, wanted));
  return {};
}

Status LatentChainCodec::decode_residual(size_t image, std::span<const std::byte> bytes,
                                         size_t count, size_t wanted, ImageRows& rows) const {
  if (frames[image].type != idf::ElementType::kUInt8)
    return data_loss("{}: found residuals of image {}, which has {} elements", kChain, image,
                     idf::to_string(frames[image].type));
  ENGRAM_ASSIGN_OR_RETURN(rows.residuals,
                          decode_residuals(bytes, frames[image].pixels(), count, wanted));
  return {};
}

Result<std::vector<ImageCode>> describe_chain(std::span<const std::byte> chain, size_t count,
                                              size_t images) {
  ByteReader reader(chain);
  ENGRAM_ASSIGN_OR_RETURN(const auto heads, read_heads(reader, images));
  std::span<const std::byte> bytes = reader.rest();
  std::vector<ImageCode> codes;
  for (const ImageHead& head : heads) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take_part(bytes, head.bytes, kChain));
    ImageCode& code = codes.emplace_back();
    code.form = head.form;
    code.is_refined = head.is_refined;
    code.bytes = part.size();
    code.code = part;
    if (!head.residual_bytes) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto residual, take_part(bytes, *head.residual_bytes, kChain));
    code.residual = residual;
    ENGRAM_ASSIGN_OR_RETURN(code.residual_bytes, residual_bytes(residual, count));
  }
  return codes;
}

Result<LatentRows> LatentChainCodec::decode(std::span<const std::byte> chain, size_t count,
                                            size_t wanted) const {
  ByteReader reader(chain);
  ENGRAM_ASSIGN_OR_RETURN(const auto heads, read_heads(reader, frames.size()));
  std::span<const std::byte> bytes = reader.rest();
  LatentRows rows;
  for (size_t i = 0; i < frames.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, take_part(bytes, heads[i].bytes, kChain));
    ImageRows& decoded = rows.images.emplace_back();
    decoded.form = heads[i].form;
    decoded.is_refined = heads[i].is_refined;
    ENGRAM_RETURN_IF_ERROR(decode_image(i, part, count, wanted, decoded));
    if (!heads[i].residual_bytes) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto residual,
                            take_part(bytes, *heads[i].residual_bytes, kChain));
    ENGRAM_RETURN_IF_ERROR(decode_residual(i, residual, count, wanted, decoded));
  }
  if (!numbers) return rows;
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, numbers->decode(bytes, count));
  // The code of the numbers ends in a checksum over all rows, so they are decoded whole and cut.
  rows.numbers.resize(wanted * numbers->model().count());
  return rows;
}

}  // namespace engram::encoders
