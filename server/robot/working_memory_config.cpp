// SPDX-License-Identifier: Apache-2.0
#include "server/robot/working_memory_config.h"

#include <algorithm>
#include <optional>

namespace engram::server {

namespace {

constexpr DeprecatedWord kMinBytesKey{"least", "min_bytes", "0.3"};

Status read_limits(ConfigMap& map, ltm::MemoryLimits& limits) {
  ENGRAM_RETURN_IF_ERROR(read_count(map, "snapshots", limits.snapshots));
  ENGRAM_RETURN_IF_ERROR(map.read("bytes", limits.bytes, &ConfigValue::bytes));
  ENGRAM_RETURN_IF_ERROR(map.read("age", limits.age, &ConfigValue::duration));
  const Status status = limits.validate();
  return status.ok() ? status : map.value().error(status);
}

/// Reads how long a segment is held, where the entry says it.
Status read_hold(ConfigMap& entry, const ltm::MemoryId& match,
                 memory::SensoryMemory::Options& sensory) {
  const auto value = entry.find("sensory");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const Duration hold, value->duration());
  memory::SensoryMemory::Options with = sensory;
  with.segments.push_back({match, hold});
  if (const Status status = with.validate(); !status.ok()) return value->error(status);
  sensory = std::move(with);
  return {};
}

/// Reads what holds for all sensory segments.
Status read_sensory_memory(ConfigMap& map, memory::SensoryMemory::Options& sensory) {
  const auto value = map.find("sensory_memory");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap entry, value->map());
  if (sensory.segments.empty())
    return value->error("needs an entry of 'segments' that is sensory beside it");
  std::optional<size_t> bytes;
  ENGRAM_RETURN_IF_ERROR(entry.read("ring", bytes, &ConfigValue::bytes));
  sensory.ring_bytes = bytes.value_or(sensory.ring_bytes);
  ENGRAM_RETURN_IF_ERROR(
      entry.read("queries_attend", sensory.query_attention, &ConfigValue::duration));
  ENGRAM_RETURN_IF_ERROR(entry.finish());
  const Status status = sensory.validate();
  return status.ok() ? status : value->error(status);
}

Status read_segments(ConfigMap& map, ltm::WorkingMemory::Options& memory,
                     memory::SensoryMemory::Options& sensory) {
  const auto value = map.find("segments");
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto values, value->list());
  for (const ConfigValue& each : values) {
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap entry, each.map());
    ENGRAM_ASSIGN_OR_RETURN(const ConfigValue match, entry.require("match"));
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, match.text());
    auto id = ltm::MemoryId::parse(text);
    if (!id.ok()) return match.error(id.status());
    if (id->names().empty() || id->time())
      return match.error(fmt::format("found '{}', needs a memory, segment or entity", text));
    ltm::SegmentLimits segment{*std::move(id), {}};
    ENGRAM_RETURN_IF_ERROR(read_limits(entry, segment.limits));
    const auto ahead = entry.find("max_ahead");
    if (ahead) {
      ENGRAM_ASSIGN_OR_RETURN(const Duration max, ahead->duration_or_never());
      memory.ahead.parts.emplace_back(segment.segment, max);
    }
    const size_t sensory_before = sensory.segments.size();
    ENGRAM_RETURN_IF_ERROR(read_hold(entry, segment.segment, sensory));
    ENGRAM_RETURN_IF_ERROR(entry.finish());
    const bool has_limit = segment.limits.snapshots || segment.limits.bytes || segment.limits.age;
    if (!has_limit && !ahead && sensory.segments.size() == sensory_before)
      return each.error("has no limit, needs bytes, snapshots, age, max_ahead or sensory");
    if (has_limit) memory.segments.push_back(std::move(segment));
  }
  return {};
}

}  // namespace

Status read_count(ConfigMap& map, std::string_view key, std::optional<size_t>& out) {
  const auto value = map.find(key);
  if (!value) return {};
  ENGRAM_ASSIGN_OR_RETURN(const int64_t count, value->integer());
  if (count < 1) return value->error(fmt::format("found {}, needs at least 1", count));
  out = static_cast<size_t>(count);
  return {};
}

Status read_working_memory(ConfigMap& map, ltm::WorkingMemory::Options& memory,
                           memory::SensoryMemory::Options& sensory, uint64_t& min_bytes) {
  ENGRAM_RETURN_IF_ERROR(read_segments(map, memory, sensory));
  ENGRAM_RETURN_IF_ERROR(read_sensory_memory(map, sensory));
  const auto value = map.find("working_memory");
  if (value) {
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap entry, value->map());
    ENGRAM_RETURN_IF_ERROR(read_limits(entry, memory.all));
    ENGRAM_ASSIGN_OR_RETURN(const auto min, entry.find(kMinBytesKey));
    if (min) {
      ENGRAM_ASSIGN_OR_RETURN(min_bytes, min->bytes());
    }
    ENGRAM_RETURN_IF_ERROR(
        entry.read("max_ahead", memory.ahead.all, &ConfigValue::duration_or_never));
    ENGRAM_RETURN_IF_ERROR(entry.read("waiting", memory.max_waiting_bytes, &ConfigValue::bytes));
    ENGRAM_RETURN_IF_ERROR(
        entry.read("read_half_life", memory.read_half_life, &ConfigValue::duration));
    if (min && (min_bytes == 0 || min_bytes > *memory.all.bytes))
      return min->error(
          fmt::format("found {} bytes, needs more than 0 and at most the {} of 'bytes'", min_bytes,
                      *memory.all.bytes));
    ENGRAM_RETURN_IF_ERROR(entry.finish());
  }
  // The default of min_bytes must not exceed a small limit that was configured.
  min_bytes = std::min<uint64_t>(min_bytes, *memory.all.bytes);
  return {};
}

}  // namespace engram::server
