// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/stored_codes.h"

#include <algorithm>

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"
#include "ltm/core/log.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

constexpr uint32_t kCodesVersion = 1;
constexpr size_t kMaxCodesBytes = size_t{1} << 30;

/// Codes by numbers and not by moments: what lies beside each other is then of one kind, which
/// saves a tenth of the bytes.
void write_columns(FieldWriter<std::vector<std::byte>>& fields, const EntityCodes& codes) {
  std::vector<int8_t> column(codes.times.size());
  for (size_t i = 0; i < kCodeSize; ++i) {
    for (size_t row = 0; row < column.size(); ++row) column[row] = codes.codes[row * kCodeSize + i];
    fields.bytes(std::as_bytes(std::span(column)));
  }
}

void read_columns(FieldReader& fields, size_t rows, EntityCodes& codes) {
  codes.codes.resize(rows * kCodeSize);
  std::vector<int8_t> column(rows);
  for (size_t i = 0; i < kCodeSize; ++i) {
    fields.fill(std::as_writable_bytes(std::span(column)));
    for (size_t row = 0; row < rows; ++row) codes.codes[row * kCodeSize + i] = column[row];
  }
}

Result<EntityCodes> read_section(FieldReader& fields) {
  EntityCodes codes;
  auto entity = MemoryId::parse(fields.text());
  codes.space = fields.number<uint64_t>();
  const auto rows = fields.number<uint64_t>();
  if (!fields.is_whole() || !entity.ok() || !entity->is_entity() ||
      rows > fields.rest() / (sizeof(int64_t) + kCodeSize))
    return data_loss("codes of likeness are damaged");
  codes.entity = *std::move(entity);
  codes.times.reserve(rows);
  for (uint64_t i = 0; i < rows; ++i) {
    const Time time = time_from_ns(fields.number<int64_t>());
    if (!codes.times.empty() && time <= codes.times.back())
      return data_loss("codes of '{}' run backwards in time", codes.entity.to_string());
    codes.times.push_back(time);
  }
  read_columns(fields, rows, codes);
  return codes;
}

}  // namespace

std::span<const int8_t> EntityCodes::find(Time time) const {
  const auto at = std::ranges::lower_bound(times, time);
  if (at == times.end() || *at != time) return {};
  return std::span(codes).subspan(static_cast<size_t>(at - times.begin()) * kCodeSize, kCodeSize);
}

void EntityCodes::append(Time time, std::span<const int8_t> code) {
  times.push_back(time);
  codes.insert(codes.end(), code.begin(), code.end());
}

std::vector<std::byte> pack_codes(const SegmentCodes& codes) {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(kCodesVersion);
  fields.number(static_cast<uint32_t>(codes.size()));
  for (const EntityCodes& entity : codes) {
    fields.text(entity.entity.to_string());
    fields.number(entity.space);
    fields.number(static_cast<uint64_t>(entity.times.size()));
    for (const Time time : entity.times) fields.number(to_ns(time));
    write_columns(fields, entity);
  }
  return compress_zstd(bytes);
}

Result<SegmentCodes> unpack_codes(std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto plain, decompress_zstd(bytes, kMaxCodesBytes));
  FieldReader fields(plain);
  const auto version = fields.number<uint32_t>();
  const auto entities = fields.number<uint32_t>();
  if (!fields.is_whole() || version != kCodesVersion)
    return data_loss("codes of likeness have version {}, and {} was needed", version,
                     kCodesVersion);
  SegmentCodes codes;
  for (uint32_t i = 0; i < entities; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(EntityCodes entity, read_section(fields));
    codes.push_back(std::move(entity));
  }
  return codes;
}

std::optional<LikenessSpace> read_space(const StoreReader& store, const MemoryId& entity) {
  const auto bytes = read_entity_index(store.path(), entity, kSpaceIndex);
  if (!bytes.ok()) return std::nullopt;
  auto space = LikenessSpace::unpack(bytes->bytes());
  return space.ok() ? std::optional(*std::move(space)) : std::nullopt;
}

StoredCodes StoredCodes::read(StoreReader& store, const MemoryId& entity, uint64_t space) {
  StoredCodes stored;
  const auto& segments = store.manifest().segments;
  for (uint32_t i = 0; i < segments.size(); ++i) {
    if (segments[i].find(entity) == nullptr) continue;
    const auto bytes = read_segment_index(store.path(), segments[i], kCodesIndex);
    if (!bytes.ok()) continue;
    auto codes = unpack_codes(bytes->bytes());
    if (!codes.ok()) {
      log::warning("store '{}': index of '{}': {}", store.path().string(), segments[i].file,
                   codes.status().message());
      continue;
    }
    for (EntityCodes& one : *codes)
      if (one.entity == entity && one.space == space) stored.by_segment_[i] = std::move(one);
  }
  return stored;
}

std::span<const int8_t> StoredCodes::find_in(uint32_t segment, Time time) const {
  const auto found = by_segment_.find(segment);
  return found == by_segment_.end() ? std::span<const int8_t>() : found->second.find(time);
}

std::span<const int8_t> StoredCodes::find(const SnapshotEntry& entry) const {
  for (const auto& form : {entry.latent, entry.recorded}) {
    if (!form || form->rows == 0) continue;
    if (const auto code = find_in(form->source, entry.time); !code.empty()) return code;
  }
  return {};
}

size_t StoredCodes::count_in(uint32_t segment) const {
  const auto found = by_segment_.find(segment);
  return found == by_segment_.end() ? 0 : found->second.times.size();
}

std::optional<uint32_t> segment_of_code(const SnapshotEntry& entry) {
  if (entry.latent) return entry.latent->source;
  if (entry.recorded && entry.recorded->rows > 0) return entry.recorded->source;
  return std::nullopt;
}

}  // namespace engram::ltm
