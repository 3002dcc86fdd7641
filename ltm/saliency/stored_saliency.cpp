// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/stored_saliency.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"

namespace engram::ltm {

namespace {

constexpr uint32_t kSaliencyVersion = 1;
constexpr size_t kMaxSaliencyBytes = size_t{1} << 30;
constexpr double kStoredOne = 65535;

Result<EntitySaliency> read_saliency_section(FieldReader& fields) {
  EntitySaliency one;
  auto entity = MemoryId::parse(fields.text());
  const auto rows = fields.number<uint64_t>();
  if (!fields.is_whole() || !entity.ok() || !entity->is_entity() ||
      rows > fields.rest() / (sizeof(int64_t) + sizeof(StoredParts)))
    return data_loss("the saliency of a segment is damaged");
  one.entity = *std::move(entity);
  one.times.reserve(rows);
  for (uint64_t i = 0; i < rows; ++i) {
    const Time time = time_from_ns(fields.number<int64_t>());
    if (!one.times.empty() && time <= one.times.back())
      return data_loss("the saliency of '{}' runs backwards in time", one.entity.to_string());
    one.times.push_back(time);
  }
  one.parts.resize(rows);
  for (size_t part = 0; part < StoredParts().size(); ++part)
    for (StoredParts& parts : one.parts) parts[part] = fields.number<uint16_t>();
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
      for (const StoredParts& parts : one.parts) fields.number(parts[part]);
  }
  return compress_zstd(bytes);
}

Result<SegmentSaliency> unpack_saliency(std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto plain, decompress_zstd(bytes, kMaxSaliencyBytes));
  FieldReader fields(plain);
  const auto version = fields.number<uint32_t>();
  const auto entities = fields.number<uint32_t>();
  if (!fields.is_whole() || version != kSaliencyVersion)
    return data_loss("the saliency of a segment has version {}, and {} was needed", version,
                     kSaliencyVersion);
  SegmentSaliency saliency;
  for (uint32_t i = 0; i < entities; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(EntitySaliency one, read_saliency_section(fields));
    saliency.push_back(std::move(one));
  }
  return saliency;
}

std::vector<std::byte> pack_weights(const SaliencyWeights& weights) {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(kSaliencyVersion);
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
  if (!fields.is_whole() || version != kSaliencyVersion || !weights.validate().ok())
    return data_loss("the weights of saliency are damaged");
  return weights;
}

}  // namespace engram::ltm
