// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_block.h"

#include <algorithm>

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"

namespace engram::encoders {

namespace {

constexpr std::string_view kBlock = "block of latents";

/// The head of a background that the block carries.
struct BackgroundHead {
  ImageForm form = ImageForm::kLatents;
  std::span<const std::byte> bytes;
};

/// The parts of a block.
struct BlockParts {
  int64_t scene = 0;
  std::vector<BackgroundHead> own;  ///< Per image member, or empty.
  size_t chain_rows = 0;
  std::vector<std::span<const std::byte>> chains;
};

Result<ImageForm> read_form(ByteReader& reader) {
  const int64_t form = reader.get_varint();
  if (form < 0 || form > static_cast<int64_t>(ImageForm::kFfv1))
    return data_loss("{}: found form {} of a background, needs 1 to {}", kBlock, form,
                     static_cast<int>(ImageForm::kFfv1));
  return static_cast<ImageForm>(form);
}

Result<BlockParts> read_parts(std::span<const std::byte> block, size_t count, size_t images) {
  if (count < 1 || count > kMaxBlockRows)
    return data_loss("{}: found {} rows, needs 1 to {}", kBlock, count, kMaxBlockRows);
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, without_checksum(block, kBlock, count));
  ByteReader reader(bytes);
  BlockParts parts;
  std::vector<int64_t> sizes;
  const int64_t first = reader.get_varint();
  parts.scene = first < 0 ? first : first / 2;
  if (first > 0 && first % 2 == 1)
    for (size_t i = 0; i < images; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(parts.own.emplace_back().form, read_form(reader));
      sizes.push_back(reader.get_varint());
    }
  const int64_t rows = reader.get_varint();
  if (reader.failed() || rows < 1 || rows > static_cast<int64_t>(kMaxBlockRows))
    return data_loss("{}: found chains of {} rows, needs 1 to {}", kBlock, rows, kMaxBlockRows);
  parts.chain_rows = static_cast<size_t>(rows);
  parts.chains.resize((count + parts.chain_rows - 1) / parts.chain_rows);
  for (size_t i = 0; i < parts.chains.size(); ++i) sizes.push_back(reader.get_varint());
  if (reader.failed()) return data_loss("{}: ends within its head", kBlock);
  bytes = reader.rest();
  size_t at = 0;
  for (BackgroundHead& background : parts.own) {
    ENGRAM_ASSIGN_OR_RETURN(background.bytes, take_part(bytes, sizes[at++], kBlock));
  }
  for (auto& chain : parts.chains) {
    ENGRAM_ASSIGN_OR_RETURN(chain, take_part(bytes, sizes[at++], kBlock));
  }
  return parts;
}

/// Copies rows `first` to `end` of `values`, which hold `count` rows.
template <typename T>
std::vector<T> some_rows(const std::vector<T>& values, size_t count, size_t first, size_t end) {
  const size_t each = values.size() / count;
  const auto begin = values.begin();
  return {begin + static_cast<ptrdiff_t>(first * each), begin + static_cast<ptrdiff_t>(end * each)};
}

}  // namespace

Result<BlockDescription> describe_block(std::span<const std::byte> block, size_t count,
                                        size_t images) {
  ENGRAM_ASSIGN_OR_RETURN(const BlockParts parts, read_parts(block, count, images));
  BlockDescription description{parts.chain_rows, std::vector<uint64_t>(images), {}};
  for (size_t i = 0; i < parts.own.size(); ++i)
    description.background_bytes[i] = parts.own[i].bytes.size();
  for (size_t i = 0; i < parts.chains.size(); ++i) {
    const size_t rows = std::min(parts.chain_rows, count - i * parts.chain_rows);
    ENGRAM_ASSIGN_OR_RETURN(description.chains.emplace_back(),
                            describe_chain(parts.chains[i], rows, images));
  }
  return description;
}

std::vector<LatentRows> cut_chains(const LatentRows& rows, size_t count, size_t chain_rows) {
  std::vector<LatentRows> chains;
  for (size_t first = 0; first < count; first += chain_rows) {
    const size_t end = std::min(count, first + chain_rows);
    LatentRows& chain = chains.emplace_back();
    chain.scene = rows.scene;
    chain.own = rows.own;
    chain.numbers = some_rows(rows.numbers, count, first, end);
    for (const ImageRows& image : rows.images) {
      // Videos and residuals are coded per chain and depend on their first row, so they cannot be
      // cut.
      ENGRAM_CHECK(image.video.empty() && image.residual.empty(), "only latents can be cut");
      ImageRows& part = chain.images.emplace_back();
      part.is_refined = image.is_refined;
      part.latents = some_rows(image.latents, count, first, end);
    }
  }
  return chains;
}

std::vector<std::byte> LatentBlockCodec::encode(std::span<const LatentRows> chains,
                                                size_t count) const {
  ENGRAM_CHECK(!chains.empty() && chains.size() == (count + chain_rows - 1) / chain_rows,
               "{} chains for {} rows", chains.size(), count);
  const LatentRows& first = chains.front();
  ENGRAM_CHECK(first.own.empty() || first.own.size() == chain.frames.size(), "{} backgrounds of {}",
               first.own.size(), chain.frames.size());
  std::vector<std::vector<std::byte>> parts;
  ByteWriter writer;
  writer.put_varint(int64_t{2} * first.scene + (first.own.empty() ? 0 : 1));
  for (const CodedBackground& background : first.own) {
    parts.push_back(background.bytes);
    writer.put_varint(static_cast<int64_t>(background.form));
    writer.put_varint(static_cast<int64_t>(background.bytes.size()));
  }
  writer.put_varint(static_cast<int64_t>(chain_rows));
  for (size_t i = 0; i < chains.size(); ++i) {
    // The block keeps the scene and the backgrounds once, so its chains must share them.
    ENGRAM_CHECK(chains[i].scene == first.scene && chains[i].own.size() == first.own.size(),
                 "chains of one block with several views");
    parts.push_back(chain.encode(chains[i], std::min(chain_rows, count - i * chain_rows)));
    writer.put_varint(static_cast<int64_t>(parts.back().size()));
  }
  std::vector<std::byte> block = writer.take();
  for (const auto& part : parts) block.insert(block.end(), part.begin(), part.end());
  return with_checksum(std::move(block), count);
}

Result<OpenBlock> LatentBlockCodec::open(std::span<const std::byte> block, size_t count) const {
  ENGRAM_ASSIGN_OR_RETURN(BlockParts parts, read_parts(block, count, chain.frames.size()));
  if (parts.scene < 0 || parts.scene >= static_cast<int64_t>(scenes))
    return data_loss("{}: found scene {}, needs 0 to {}", kBlock, parts.scene, scenes - 1);
  OpenBlock open{
      count, parts.chain_rows, static_cast<uint32_t>(parts.scene), {}, std::move(parts.chains)};
  for (size_t i = 0; i < parts.own.size(); ++i) {
    const auto bytes = parts.own[i].bytes;
    ENGRAM_ASSIGN_OR_RETURN(
        open.own.emplace_back(),
        decode_background(parts.own[i].form, {bytes.begin(), bytes.end()}, chain.frames[i]));
  }
  return open;
}

Result<LatentRows> LatentBlockCodec::decode(const OpenBlock& block, size_t chain_index,
                                            size_t wanted) const {
  ENGRAM_ASSIGN_OR_RETURN(
      LatentRows rows, chain.decode(block.chains[chain_index], block.rows_of(chain_index), wanted));
  rows.scene = block.scene;
  rows.own = block.own;
  return rows;
}

Result<std::vector<LatentRows>> LatentBlockCodec::decode_all(std::span<const std::byte> block,
                                                             size_t count) const {
  ENGRAM_ASSIGN_OR_RETURN(const OpenBlock opened, open(block, count));
  std::vector<LatentRows> chains;
  for (size_t i = 0; i < opened.chains.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(chains.emplace_back(), decode(opened, i, opened.rows_of(i)));
  }
  return chains;
}

}  // namespace engram::encoders
