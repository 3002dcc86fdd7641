// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/packed_entities.h"

#include <algorithm>
#include <cstring>

#include "ltm/codec/zstd.h"
#include "ltm/idf/base64.h"
#include "ltm/idf/binary.h"

namespace engram::ltm {

namespace {

/// Hostile manifests claim any size.
constexpr size_t kMaxBytes = size_t{1} << 30;
constexpr int kLevel = 6;

using Numbers = std::vector<int64_t>;

idf::NdArray to_array(Numbers numbers) {
  const auto count = static_cast<int64_t>(numbers.size());
  return idf::NdArray::take<int64_t>({count}, std::move(numbers));
}

Result<Numbers> numbers_of(const idf::Data& table, const char* key, size_t count) {
  const idf::Data* found = table.at(key);
  const auto* array = found == nullptr ? nullptr : found->get_if<idf::NdArray>();
  if (array == nullptr || array->type() != idf::ElementType::kInt64 ||
      array->shape() != idf::Shape{static_cast<int64_t>(count)})
    return data_loss("packed entities: '{}' is no column of {} numbers", key, count);
  Numbers numbers(count);
  std::memcpy(numbers.data(), array->bytes().data(), array->bytes().size());
  return numbers;
}

/// The columns of unsigned numbers, in the order of the text.
struct Column {
  const char* key;
  uint64_t SegmentEntity::*member;
};
constexpr Column kColumns[] = {
    {"snapshots", &SegmentEntity::snapshots}, {"rows", &SegmentEntity::rows},
    {"raw_bytes", &SegmentEntity::raw_bytes}, {"stored_bytes", &SegmentEntity::stored_bytes},
    {"dropped", &SegmentEntity::dropped},     {"dropped_bytes", &SegmentEntity::dropped_bytes},
    {"augmented", &SegmentEntity::augmented}};
struct TimeColumn {
  const char* key;
  Time SegmentEntity::*member;
};
constexpr TimeColumn kTimes[] = {{"first", &SegmentEntity::first}, {"last", &SegmentEntity::last}};

}  // namespace

Result<std::string> pack_entities(std::span<const SegmentEntity> entities) {
  idf::List names;
  names.reserve(entities.size());
  for (const SegmentEntity& entity : entities) names.emplace_back(entity.id.to_string());
  idf::Dict table{{"id", std::move(names)}};
  for (const Column& column : kColumns) {
    Numbers numbers;
    for (const SegmentEntity& entity : entities)
      numbers.push_back(static_cast<int64_t>(entity.*column.member));
    table.set(column.key, to_array(std::move(numbers)));
  }
  for (const TimeColumn& column : kTimes) {
    Numbers numbers;
    for (const SegmentEntity& entity : entities) numbers.push_back(to_ns(entity.*column.member));
    table.set(column.key, to_array(std::move(numbers)));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(std::move(table)));
  return idf::to_base64(compress_zstd(bytes, kLevel));
}

Result<std::vector<SegmentEntity>> unpack_entities(std::string_view text) {
  const auto packed = idf::from_base64(text);
  if (!packed) return data_loss("packed entities: are no base64");
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, decompress_zstd(*packed, kMaxBytes));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data table, idf::decode(Buffer::take(std::move(bytes))));
  const idf::Data* names = table.at("id");
  const auto* list = names == nullptr ? nullptr : names->get_if<idf::List>();
  if (list == nullptr) return data_loss("packed entities: have no 'id'");
  std::vector<SegmentEntity> entities(list->size());
  for (size_t i = 0; i < entities.size(); ++i) {
    const auto* name = (*list)[i].get_if<std::string>();
    if (name == nullptr) return data_loss("packed entities: ID {} is no text", i);
    ENGRAM_ASSIGN_OR_RETURN(entities[i].id, MemoryId::parse(*name));
    if (!entities[i].id.is_entity()) return data_loss("packed entities: '{}' is no entity", *name);
  }
  for (const Column& column : kColumns) {
    ENGRAM_ASSIGN_OR_RETURN(const Numbers numbers, numbers_of(table, column.key, entities.size()));
    for (size_t i = 0; i < entities.size(); ++i) {
      if (numbers[i] < 0)
        return data_loss("packed entities: '{}' of '{}' is {}, needs at least 0", column.key,
                         entities[i].id.to_string(), numbers[i]);
      entities[i].*column.member = static_cast<uint64_t>(numbers[i]);
    }
  }
  for (const TimeColumn& column : kTimes) {
    ENGRAM_ASSIGN_OR_RETURN(const Numbers numbers, numbers_of(table, column.key, entities.size()));
    for (size_t i = 0; i < entities.size(); ++i)
      entities[i].*column.member = time_from_ns(numbers[i]);
  }
  return entities;
}

}  // namespace engram::ltm
