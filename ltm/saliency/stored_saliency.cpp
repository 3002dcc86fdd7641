// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/stored_saliency.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"

namespace engram::ltm {

namespace {

/// Version 1 had neither how many a snapshot stands for nor a state.
constexpr uint32_t kSaliencyVersion = 2;
constexpr uint32_t kMinSaliencyVersion = 1;
constexpr uint32_t kWeightsVersion = 1;
constexpr size_t kMaxSaliencyBytes = size_t{1} << 30;
constexpr double kStoredOne = 65535;

size_t bytes_of_row(uint32_t version) {
  const size_t parts = sizeof(int64_t) + sizeof(StoredParts);
  return version == 1 ? parts : parts + sizeof(uint32_t) + sizeof(uint8_t);
}

Status read_row_states(FieldReader& fields, EntitySaliency& one) {
  for (SaliencyRow& row : one.rows) row.stands_for = fields.number<uint32_t>();
  for (SaliencyRow& row : one.rows) {
    const auto state = fields.number<uint8_t>();
    if (state > static_cast<uint8_t>(RowState::kStale) || row.stands_for == 0)
      return data_loss("the saliency of '{}' has a snapshot of state {} that stands for {}",
                       one.entity.to_string(), state, row.stands_for);
    row.state = static_cast<RowState>(state);
  }
  return {};
}

Result<EntitySaliency> read_saliency_section(FieldReader& fields, uint32_t version) {
  EntitySaliency one;
  auto entity = MemoryId::parse(fields.text());
  const auto rows = fields.number<uint64_t>();
  if (!fields.is_whole() || !entity.ok() || !entity->is_entity() ||
      rows > fields.rest() / bytes_of_row(version))
    return data_loss("the saliency of a segment is damaged");
  one.entity = *std::move(entity);
  one.times.reserve(rows);
  for (uint64_t i = 0; i < rows; ++i) {
    const Time time = time_from_ns(fields.number<int64_t>());
    if (!one.times.empty() && time <= one.times.back())
      return data_loss("the saliency of '{}' runs backwards in time", one.entity.to_string());
    one.times.push_back(time);
  }
  one.rows.resize(rows);
  for (size_t part = 0; part < StoredParts().size(); ++part)
    for (SaliencyRow& row : one.rows) row.parts[part] = fields.number<uint16_t>();
  if (version > 1) ENGRAM_RETURN_IF_ERROR(read_row_states(fields, one));
  return one;
}

}  // namespace

StoredParts stored_parts(const SaliencyParts& parts) {
  StoredParts stored{};
  for (size_t i = 0; i < stored.size(); ++i)
    stored[i] =
        static_cast<uint16_t>(std::lround(std::clamp(parts.values()[i], 0.0, 1.0) * kStoredOne));
  return stored;
}

SaliencyParts parts_of(const StoredParts& stored, uint64_t reads) {
  SaliencyParts parts;
  for (size_t i = 0; i < stored.size(); ++i)
    parts[static_cast<SaliencyPart>(i)] = stored[i] / kStoredOne;
  parts[SaliencyPart::kReads] = reads_part(reads);
  return parts;
}

void EntitySaliency::append(const EntitySaliency& other) {
  times.insert(times.end(), other.times.begin(), other.times.end());
  rows.insert(rows.end(), other.rows.begin(), other.rows.end());
}

EntitySaliency EntitySaliency::known_rows() const {
  EntitySaliency known{entity, {}, {}};
  for (size_t i = 0; i < times.size(); ++i)
    if (rows[i].state == RowState::kKnown) known.append(times[i], rows[i]);
  return known;
}

std::optional<size_t> EntitySaliency::find(Time time) const {
  const auto at = std::ranges::lower_bound(times, time);
  if (at == times.end() || *at != time) return std::nullopt;
  return static_cast<size_t>(at - times.begin());
}

MemoryId weights_entity() {
  return *MemoryId::from_names({"Engram", "Saliency", "weights", "all"});
}

std::vector<std::byte> pack_saliency(const SegmentSaliency& saliency) {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(kSaliencyVersion);
  fields.number(static_cast<uint32_t>(saliency.size()));
  for (const EntitySaliency& one : saliency) {
    fields.text(one.entity.to_string());
    fields.number(static_cast<uint64_t>(one.times.size()));
    for (const Time time : one.times) fields.number(to_ns(time));
    for (size_t part = 0; part < StoredParts().size(); ++part)
      for (const SaliencyRow& row : one.rows) fields.number(row.parts[part]);
    for (const SaliencyRow& row : one.rows) fields.number(row.stands_for);
    for (const SaliencyRow& row : one.rows) fields.number(static_cast<uint8_t>(row.state));
  }
  return compress_zstd(bytes);
}

Result<SegmentSaliency> unpack_saliency(std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto plain, decompress_zstd(bytes, kMaxSaliencyBytes));
  FieldReader fields(plain);
  const auto version = fields.number<uint32_t>();
  const auto entities = fields.number<uint32_t>();
  if (!fields.is_whole() || version < kMinSaliencyVersion || version > kSaliencyVersion)
    return data_loss("the saliency of a segment has version {}, and {} to {} was needed", version,
                     kMinSaliencyVersion, kSaliencyVersion);
  SegmentSaliency saliency;
  for (uint32_t i = 0; i < entities; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(EntitySaliency one, read_saliency_section(fields, version));
    saliency.push_back(std::move(one));
  }
  return saliency;
}

std::vector<std::byte> pack_weights(const SaliencyWeights& weights) {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(kWeightsVersion);
  fields.number(weights.learned_from);
  for (const double weight : weights.parts.values()) fields.number(std::bit_cast<uint64_t>(weight));
  return bytes;
}

Result<SaliencyWeights> unpack_weights(std::span<const std::byte> bytes) {
  FieldReader fields(bytes);
  SaliencyWeights weights;
  const auto version = fields.number<uint32_t>();
  weights.learned_from = fields.number<uint64_t>();
  for (size_t i = 0; i < kSaliencyParts; ++i)
    weights.parts[static_cast<SaliencyPart>(i)] = std::bit_cast<double>(fields.number<uint64_t>());
  if (!fields.is_whole() || version != kWeightsVersion || !weights.validate().ok())
    return data_loss("the weights of saliency are damaged");
  return weights;
}

}  // namespace engram::ltm
