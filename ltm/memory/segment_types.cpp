// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/segment_types.h"

#include <algorithm>

#include "ltm/idf/extends.h"
#include "ltm/idf/type_check.h"

namespace engram::ltm {

namespace {

constexpr size_t kCoreLevel = 2;
constexpr size_t kProviderLevel = 3;

bool is_segment(const MemoryId& id) {
  return !id.time() && (id.names().size() == kCoreLevel || id.names().size() == kProviderLevel);
}

bool is_provider_segment(const MemoryId& id) {
  return id.names().size() == kProviderLevel;
}

Status check_extension(const MemoryId& provider, const idf::Type& type, const MemoryId& core,
                       const idf::Type& core_type) {
  const Status status = idf::check_extends(type, core_type);
  if (status.ok()) return status;
  return status.with_context(fmt::format("provider segment '{}' must extend core segment '{}'",
                                         provider.to_string(), core.to_string()));
}

bool is_harmless(const idf::CastNote& note) {
  return note.kind == idf::CastNote::Kind::kUnknown || note.kind == idf::CastNote::Kind::kNarrowed;
}

}  // namespace

Status SegmentTypes::declare(const MemoryId& segment, const idf::Type& type) {
  if (!is_segment(segment))
    return invalid_argument(
        "type of '{}': needs a core segment (two names) or a provider segment "
        "(three)",
        segment.to_string());
  if (is_provider_segment(segment)) {
    if (const idf::Type* core = find(segment.parent()))
      ENGRAM_RETURN_IF_ERROR(check_extension(segment, type, segment.parent(), *core));
  } else {
    // A new core type may not break the types that already extend the old one.
    for (const auto& [id, provider] : types_)
      if (is_provider_segment(id) && segment.is_prefix_of(id))
        ENGRAM_RETURN_IF_ERROR(check_extension(id, provider, segment, type));
  }
  // Producers declare their types again whenever they start. An equal declaration keeps the old
  // type object, because types of one declaration are compared at once.
  const auto [known, is_new] = types_.try_emplace(segment, type);
  if (!is_new && known->second != type) known->second = type;
  return {};
}

const idf::Type* SegmentTypes::find(const MemoryId& segment) const {
  const auto found = types_.find(segment);
  return found == types_.end() ? nullptr : &found->second;
}

const idf::Type* SegmentTypes::of_entity(const MemoryId& entity) const {
  if (types_.empty() || entity.names().size() < kProviderLevel) return nullptr;
  MemoryId provider = entity;
  while (provider.depth() > kProviderLevel) provider = provider.parent();
  const idf::Type* type = find(provider);
  return type != nullptr ? type : find(provider.parent());
}

SegmentTypes SegmentTypes::of_entities(const std::vector<MemoryId>& entities) const {
  SegmentTypes some;
  for (const auto& known : types_)
    if (std::ranges::any_of(entities, [&known](const MemoryId& entity) {
          return known.first.is_prefix_of(entity);
        }))
      some.types_.insert(known);
  return some;
}

Result<ReinterpretedValue> SegmentTypes::reinterpret(const MemoryId& entity,
                                                     const idf::Data& value) const {
  ENGRAM_ASSIGN_OR_RETURN(auto cast, cast_misfit(entity, value));
  if (!cast) return ReinterpretedValue{value, {}, false};
  return ReinterpretedValue{std::move(cast->value), std::move(cast->notes), true};
}

Result<std::optional<idf::CastResult>> SegmentTypes::cast_misfit(const MemoryId& entity,
                                                                 const idf::Data& value) const {
  const idf::Type* type = of_entity(entity);
  if (type == nullptr || idf::check(value, *type).empty()) return std::optional<idf::CastResult>();
  idf::CastResult cast = idf::cast(value, *type);
  std::vector<idf::Mismatch> mismatches;
  for (const idf::CastNote& note : cast.notes)
    if (!is_harmless(note)) mismatches.push_back(note.what);
  if (const Status status = idf::to_status(mismatches); !status.ok())
    return status.with_context(
        fmt::format("'{}' is not of its segment's type", entity.to_string()));
  return std::optional(std::move(cast));
}

idf::Data SegmentTypes::to_data() const {
  idf::Dict dict;
  for (const auto& [segment, type] : types_) dict.set(segment.to_string(), idf::to_data(type));
  return dict;
}

Result<SegmentTypes> SegmentTypes::from_data(const idf::Data& data) {
  const auto* dict = data.get_if<idf::Dict>();
  if (dict == nullptr) return data_loss("types of segments: found {}", idf::describe(data));
  SegmentTypes types;
  const auto declare = [&types](const std::string& name, const idf::Data& value) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const MemoryId segment, MemoryId::parse(name));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Type type, idf::type_from_data(value));
    return types.declare(segment, type);
  };
  for (const auto& [name, value] : *dict)
    if (const Status status = declare(name, value); !status.ok())
      return data_loss("type of segment '{}': {}", name, status.message());
  return types;
}

}  // namespace engram::ltm
