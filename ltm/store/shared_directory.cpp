// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/shared_directory.h"

#include <algorithm>

#include "ltm/codec/zstd.h"
#include "ltm/idf/binary.h"
#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

namespace {

constexpr const char* kShared = "/#shared";
constexpr const char* kNames = "/#shared/entities";
constexpr const char* kBegins = "/#shared/first_names";
constexpr const char* kPerBlock = "names_per_block";
/// Finding an entity decodes one block.
constexpr size_t kNamesPerBlock = 128;
constexpr size_t kKeptNameBlocks = 4;
constexpr int kNamesLevel = 12;
/// Names may be long; hostile files claim any size.
constexpr size_t kMaxNamesBytes = size_t{64} << 20;

Result<std::vector<std::byte>> encode_names(std::span<const SharedEntity> entities, size_t step) {
  idf::List names;
  for (size_t i = 0; i < entities.size(); i += step) names.emplace_back(entities[i].id.to_string());
  return idf::encode(std::move(names));
}

Result<std::vector<MemoryId>> decode_names(std::vector<std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::take(std::move(bytes))));
  const auto* list = data.get_if<idf::List>();
  if (list == nullptr) return data_loss("is no list of names");
  std::vector<MemoryId> names;
  names.reserve(list->size());
  for (const idf::Data& each : *list) {
    const auto* text = each.get_if<std::string>();
    if (text == nullptr) return data_loss("is no list of names");
    ENGRAM_ASSIGN_OR_RETURN(MemoryId id, MemoryId::parse(*text));
    if (!id.is_entity()) return data_loss("has '{}', which is no entity", *text);
    names.push_back(std::move(id));
  }
  return names;
}

}  // namespace

std::string shared_group(size_t number) {
  return fmt::format("{}/{}", kShared, number);
}

uint64_t share_of(uint64_t bytes, uint64_t rows, uint64_t all_rows) {
  // A file has less than 2^53 bytes, which a double tells apart.
  return all_rows == 0
             ? 0
             : static_cast<uint64_t>(static_cast<double>(bytes) * static_cast<double>(rows) /
                                     static_cast<double>(all_rows));
}

Status write_shared_directory(h5::File& file, const std::vector<SharedEntity>& entities) {
  BlobColumn blocks;
  for (size_t first = 0; first < entities.size(); first += kNamesPerBlock) {
    const size_t count = std::min(kNamesPerBlock, entities.size() - first);
    ENGRAM_ASSIGN_OR_RETURN(const auto names,
                            encode_names(std::span(entities).subspan(first, count), 1));
    blocks.append(compress_zstd(names, kNamesLevel));
  }
  ENGRAM_RETURN_IF_ERROR(blocks.write(file, kNames));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kNames, kPerBlock, int64_t{kNamesPerBlock}));
  ENGRAM_ASSIGN_OR_RETURN(const auto begins, encode_names(entities, kNamesPerBlock));
  const uint64_t size = begins.size();
  ENGRAM_RETURN_IF_ERROR(
      file.write(kBegins, h5::Type::kUInt8, {&size, 1}, begins, h5::Storage::kCompressed));
  std::vector<int32_t> groups;
  std::vector<uint64_t> firsts, rows;
  for (const SharedEntity& entity : entities) {
    groups.push_back(entity.group);
    firsts.push_back(entity.first);
    rows.push_back(entity.rows);
  }
  const std::string base = kShared;
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, base + "/group", groups));
  ENGRAM_RETURN_IF_ERROR(write_column(file, base + "/first_row", firsts));
  return write_row_column(file, base + "/rows", rows);
}

Status SharedDirectory::load() {
  if (is_there_) return {};
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, source_.file().exists(kShared));
  if (is_there) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t per_block,
                            source_.file().int_attribute(kNames, kPerBlock));
    if (per_block < 1) return source_.broken(kNames, "has no names per block");
    per_block_ = static_cast<uint64_t>(per_block);
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * offsets,
                            source_.column(std::string(kNames) + "/offset"));
    blocks_ = std::max<uint64_t>(offsets->rows(), 1) - 1;
    if (!load_begins(blocks_).ok()) find_begins(blocks_);
  }
  is_there_ = is_there;
  return {};
}

Status SharedDirectory::load_begins(uint64_t blocks) {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes,
                          source_.file().read(kBegins, h5::Type::kUInt8, kMaxNamesBytes));
  ENGRAM_ASSIGN_OR_RETURN(auto names, decode_names(std::move(bytes)));
  if (names.size() != blocks) return source_.broken(kBegins, "has not one name for each block");
  for (uint64_t i = 0; i < blocks; ++i) begins_.push_back({std::move(names[i]), i});
  return {};
}

void SharedDirectory::find_begins(uint64_t blocks) {
  for (uint64_t i = 0; i < blocks; ++i) {
    auto names = read_names(i);
    if (names.ok() && !names->empty()) begins_.push_back({std::move(names->front()), i});
  }
}

Result<std::vector<MemoryId>> SharedDirectory::read_names(uint64_t number) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer packed, source_.blob(kNames, number));
  auto plain = source_.located(decompress_zstd(packed.bytes(), kMaxNamesBytes));
  ENGRAM_RETURN_IF_ERROR(plain.status());
  auto names = decode_names(*std::move(plain));
  if (!names.ok())
    return source_.broken(kNames, fmt::format("block {}: {}", number, names.status().message()));
  if (names->size() > per_block_)
    return source_.broken(kNames, fmt::format("block {} has {} names, needs at most {}", number,
                                              names->size(), per_block_));
  return names;
}

Result<const SharedDirectory::Block*> SharedDirectory::block(uint64_t number) {
  auto known = std::ranges::find(kept_, number, &Block::number);
  if (known == kept_.end()) {
    ENGRAM_ASSIGN_OR_RETURN(auto names, read_names(number));
    if (kept_.size() < kKeptNameBlocks)
      known = kept_.insert(kept_.end(), Block{});
    else
      known = std::ranges::min_element(kept_, {}, &Block::last_use);
    *known = {number, 0, std::move(names)};
  }
  known->last_use = ++uses_;
  return &*known;
}

Result<EntityPlace> SharedDirectory::place(uint64_t index) {
  constexpr int32_t kMaxGroups = 1 << 20;
  const std::string base = kShared;
  ENGRAM_ASSIGN_OR_RETURN(const auto group, source_.row_number<int32_t>(base + "/group", index));
  ENGRAM_ASSIGN_OR_RETURN(const auto first, source_.number<uint64_t>(base + "/first_row", index));
  ENGRAM_ASSIGN_OR_RETURN(const auto rows, source_.row_number<uint64_t>(base + "/rows", index));
  if (group < 0 || group > kMaxGroups)
    return source_.broken(base + "/group", fmt::format("row {} names no group", index));
  EntityPlace place{shared_group(static_cast<size_t>(group)), first, rows};
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * times, source_.column(place.group + "/timestamp"));
  if (first > times->rows() || rows > times->rows() - first)
    return source_.broken(base + "/rows",
                          fmt::format("rows {} to {} are not in '{}', which has {}", first,
                                      first + rows, place.group, times->rows()));
  return place;
}

Result<std::optional<EntityPlace>> SharedDirectory::find(const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(load());
  const auto above = std::ranges::upper_bound(begins_, entity, {}, &Begin::name);
  if (above == begins_.begin()) return std::optional<EntityPlace>();
  const uint64_t number = std::prev(above)->block;
  ENGRAM_ASSIGN_OR_RETURN(const Block* found, block(number));
  const auto name = std::ranges::lower_bound(found->names, entity);
  if (name == found->names.end() || *name != entity) return std::optional<EntityPlace>();
  const auto index = static_cast<uint64_t>(name - found->names.begin());
  ENGRAM_ASSIGN_OR_RETURN(EntityPlace at, place(number * per_block_ + index));
  return std::optional(std::move(at));
}

Result<std::vector<Status>> SharedDirectory::for_each(
    const std::function<void(const MemoryId&)>& visit) {
  ENGRAM_RETURN_IF_ERROR(load());
  std::vector<Status> damaged;
  for (uint64_t i = 0; i < blocks_; ++i) {
    const auto names = read_names(i);
    if (!names.ok()) {
      damaged.push_back(names.status());
      continue;
    }
    for (const MemoryId& name : *names) visit(name);
  }
  return damaged;
}

}  // namespace engram::ltm
