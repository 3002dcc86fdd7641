// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/stored_context.h"

#include <algorithm>
#include <cmath>

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"

namespace engram::ltm {

namespace {

constexpr uint32_t kContextVersion = 1;
using Bytes = std::vector<std::byte>;
using Writer = FieldWriter<Bytes>;

template <typename T>
void write_column(Writer& fields, const std::vector<T>& column) {
  fields.number(static_cast<uint64_t>(column.size()));
  fields.bytes(std::as_bytes(std::span(column)));
}

/// Differences of neighbours: those of times and indices repeat, and compress well.
template <typename T>
void write_steps(Writer& fields, const std::vector<T>& column) {
  std::vector<T> steps(column.size());
  using Unsigned = std::make_unsigned_t<T>;
  Unsigned last = 0;
  for (size_t i = 0; i < column.size(); ++i) {
    steps[i] = static_cast<T>(static_cast<Unsigned>(column[i]) - last);
    last = static_cast<Unsigned>(column[i]);
  }
  write_column(fields, steps);
}

template <typename T>
std::vector<T> read_column(FieldReader& fields) {
  const auto count = fields.number<uint64_t>();
  std::vector<T> column;
  if (count > fields.rest() / sizeof(T)) {
    fields.bytes(UINT64_MAX);  // Nothing more can be read.
    return column;
  }
  column.resize(count);
  fields.fill(std::as_writable_bytes(std::span(column)));
  return column;
}

template <typename T>
std::vector<T> read_steps(FieldReader& fields) {
  std::vector<T> column = read_column<T>(fields);
  using Unsigned = std::make_unsigned_t<T>;
  Unsigned last = 0;
  for (T& value : column) {
    last += static_cast<Unsigned>(value);
    value = static_cast<T>(last);
  }
  return column;
}

Bytes pack_one(const EntityContext& context) {
  Bytes bytes;
  Writer fields(bytes);
  std::vector<int64_t> times;
  times.reserve(context.times.size());
  for (const Time time : context.times) times.push_back(to_ns(time));
  write_steps(fields, times);
  write_column(fields, context.visibility);
  fields.number(static_cast<uint32_t>(context.frames.size()));
  for (const std::string& frame : context.frames) fields.text(frame);
  fields.number(static_cast<uint32_t>(context.intrinsics.size()));
  for (const Intrinsics& own : context.intrinsics) fields.bytes(std::as_bytes(std::span(&own, 1)));
  fields.number(static_cast<uint32_t>(context.targets.size()));
  for (const MemoryId& target : context.targets) fields.text(target.to_string());
  write_steps(fields, context.places.snapshot);
  write_column(fields, context.places.frame);
  write_column(fields, context.places.position);
  write_steps(fields, context.cameras.snapshot);
  write_column(fields, context.cameras.instance);
  write_column(fields, context.cameras.frame);
  write_column(fields, context.cameras.position);
  write_column(fields, context.cameras.orientation);
  write_steps(fields, context.cameras.calibration);
  write_steps(fields, context.links.snapshot);
  write_column(fields, context.links.instance);
  write_column(fields, context.links.target);
  write_steps(fields, context.links.time);
  write_column(fields, context.links.index);
  write_steps(fields, context.spans.snapshot);
  write_steps(fields, context.spans.started);
  write_steps(fields, context.spans.ended);
  return bytes;
}

bool is_increasing(const std::vector<Time>& times) {
  return std::ranges::adjacent_find(times, std::greater_equal<>{}) == times.end();
}

/// Whether the rows of a table are of snapshots that are there, in their order.
bool are_rows(const std::vector<uint32_t>& snapshots, size_t count) {
  return std::ranges::is_sorted(snapshots) && (snapshots.empty() || snapshots.back() < count);
}

bool are_below(const std::vector<uint32_t>& indices, size_t count) {
  return std::ranges::all_of(indices, [count](uint32_t index) { return index < count; });
}

bool are_finite(const std::vector<double>& numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

bool are_finite(const std::vector<Intrinsics>& intrinsics) {
  return std::ranges::all_of(intrinsics, [](const Intrinsics& own) {
    for (const double number : {own.fx, own.fy, own.cx, own.cy, own.width, own.height})
      if (!std::isfinite(number)) return false;
    return true;
  });
}

bool are_instances(const std::vector<int32_t>& instances) {
  return std::ranges::all_of(instances, [](int32_t instance) { return instance >= 0; });
}

bool are_calibrations(const EntityContext& context) {
  return std::ranges::all_of(context.cameras.calibration, [&](int32_t calibration) {
    return calibration >= 0 ? static_cast<size_t>(calibration) < context.links.size()
                            : static_cast<size_t>(-1 - calibration) < context.intrinsics.size();
  });
}

bool is_consistent(const EntityContext& context) {
  const size_t count = context.times.size();
  const auto& [times, visibility, places, cameras, links, spans, frames, intrinsics, targets,
               runs] = context;
  return is_increasing(times) && (visibility.empty() || visibility.size() == count) &&
         std::ranges::all_of(
             visibility,
             [](auto v) { return static_cast<int8_t>(v) >= -1 && static_cast<int8_t>(v) <= 1; }) &&
         are_rows(places.snapshot, count) && places.frame.size() == places.size() &&
         are_below(places.frame, frames.size()) && places.position.size() == 3 * places.size() &&
         are_finite(places.position) && are_rows(cameras.snapshot, count) &&
         cameras.instance.size() == cameras.size() && are_instances(cameras.instance) &&
         cameras.frame.size() == cameras.size() && are_below(cameras.frame, frames.size()) &&
         cameras.position.size() == 3 * cameras.size() && are_finite(cameras.position) &&
         cameras.orientation.size() == 4 * cameras.size() && are_finite(cameras.orientation) &&
         cameras.calibration.size() == cameras.size() && are_calibrations(context) &&
         are_finite(intrinsics) && are_rows(links.snapshot, count) &&
         links.instance.size() == links.size() && are_instances(links.instance) &&
         links.target.size() == links.size() && are_below(links.target, targets.size()) &&
         links.time.size() == links.size() && links.index.size() == links.size() &&
         are_rows(spans.snapshot, count) && spans.started.size() == spans.size() &&
         spans.ended.size() == spans.size();
}

Status context_damaged() {
  return data_loss("an index of places and links is damaged");
}

/// Calls `visit` with the ID and the packed bytes of each entity.
template <typename Visit>
Status walk_packed(std::span<const std::byte> bytes, const Visit& visit) {
  FieldReader fields(bytes);
  const auto version = fields.number<uint32_t>();
  if (!fields.is_whole() || version != kContextVersion)
    return data_loss("an index of places and links has version {}, and {} was needed", version,
                     kContextVersion);
  for (auto left = fields.number<uint32_t>(); left > 0; --left) {
    const std::string_view id = fields.text();
    const auto packed = fields.bytes(fields.number<uint64_t>());
    if (!fields.is_whole()) return context_damaged();
    ENGRAM_RETURN_IF_ERROR(visit(id, packed));
  }
  return fields.is_whole() ? Status() : context_damaged();
}

}  // namespace

std::vector<std::byte> pack_contexts(const SegmentContexts& contexts) {
  Bytes bytes;
  Writer fields(bytes);
  fields.number(kContextVersion);
  fields.number(static_cast<uint32_t>(contexts.size()));
  for (const auto& [entity, context] : contexts) {
    fields.text(entity.to_string());
    const Bytes packed = compress_zstd(pack_one(context));
    fields.number(static_cast<uint64_t>(packed.size()));
    fields.bytes(packed);
  }
  return bytes;
}

Result<EntityContext> unpack_listed(std::span<const std::byte> packed, size_t max_bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto plain, decompress_zstd(packed, max_bytes));
  FieldReader fields(plain);
  EntityContext context;
  for (const int64_t time : read_steps<int64_t>(fields))
    context.times.push_back(time_from_ns(time));
  context.visibility = read_column<EntityContext::Visibility>(fields);
  for (auto left = fields.number<uint32_t>(); left > 0 && fields.is_whole(); --left)
    context.frames.emplace_back(fields.text());
  for (auto left = fields.number<uint32_t>(); left > 0 && fields.is_whole(); --left)
    fields.fill(std::as_writable_bytes(std::span(&context.intrinsics.emplace_back(), 1)));
  for (auto left = fields.number<uint32_t>(); left > 0 && fields.is_whole(); --left) {
    auto target = MemoryId::parse(fields.text());
    if (!target.ok() || !target->is_entity()) return context_damaged();
    context.targets.push_back(*std::move(target));
  }
  context.places.snapshot = read_steps<uint32_t>(fields);
  context.places.frame = read_column<uint32_t>(fields);
  context.places.position = read_column<double>(fields);
  context.cameras.snapshot = read_steps<uint32_t>(fields);
  context.cameras.instance = read_column<int32_t>(fields);
  context.cameras.frame = read_column<uint32_t>(fields);
  context.cameras.position = read_column<double>(fields);
  context.cameras.orientation = read_column<double>(fields);
  context.cameras.calibration = read_steps<int32_t>(fields);
  context.links.snapshot = read_steps<uint32_t>(fields);
  context.links.instance = read_column<int32_t>(fields);
  context.links.target = read_column<uint32_t>(fields);
  context.links.time = read_steps<int64_t>(fields);
  context.links.index = read_column<int32_t>(fields);
  context.spans.snapshot = read_steps<uint32_t>(fields);
  context.spans.started = read_steps<int64_t>(fields);
  context.spans.ended = read_steps<int64_t>(fields);
  if (!fields.is_whole() || fields.rest() != 0 || !is_consistent(context)) return context_damaged();
  return context;
}

Result<PackedContexts> list_contexts(std::span<const std::byte> bytes) {
  PackedContexts found;
  ENGRAM_RETURN_IF_ERROR(
      walk_packed(bytes, [&](std::string_view name, std::span<const std::byte> packed) -> Status {
        found.emplace(name, packed);
        return {};
      }));
  return found;
}

Result<std::optional<EntityContext>> unpack_context(std::span<const std::byte> bytes,
                                                    const MemoryId& entity, size_t max_bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const PackedContexts all, list_contexts(bytes));
  const auto found = all.find(entity.to_string());
  if (found == all.end()) return std::optional<EntityContext>();
  ENGRAM_ASSIGN_OR_RETURN(EntityContext context, unpack_listed(found->second, max_bytes));
  return std::optional(std::move(context));
}

Result<SegmentContexts> unpack_contexts(std::span<const std::byte> bytes) {
  SegmentContexts contexts;
  ENGRAM_RETURN_IF_ERROR(
      walk_packed(bytes, [&](std::string_view name, std::span<const std::byte> packed) -> Status {
        auto entity = MemoryId::parse(name);
        if (!entity.ok() || !entity->is_entity()) return context_damaged();
        ENGRAM_ASSIGN_OR_RETURN(EntityContext context, unpack_listed(packed));
        contexts.emplace_back(*std::move(entity), std::move(context));
        return {};
      }));
  return contexts;
}

}  // namespace engram::ltm
