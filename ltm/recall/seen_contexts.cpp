// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/seen_contexts.h"

#include <algorithm>
#include <cmath>

#include "ltm/context/read_context.h"

namespace engram::ltm {

namespace {

/// How far something may be before the middle of a thing and still be its own surface. Unit: m.
constexpr double kOwnDepth = 0.15;
constexpr double kMetresPerMillimetre = 1e-3;

bool is_depth(const idf::Type& type) {
  if (const auto* image = type.get_if<idf::types::Image>())
    return image->pixel == idf::PixelType::kDepth16 || image->pixel == idf::PixelType::kDepth32;
  return std::ranges::any_of(type.parts(),
                             [](const idf::Member& part) { return is_depth(part.type); });
}

/// The first depth image in a value.
const idf::NdArray* find_depth(const idf::Data& value) {
  if (const auto* array = value.get_if<idf::NdArray>()) {
    const bool has_depths =
        array->type() == idf::ElementType::kUInt16 || array->type() == idf::ElementType::kFloat32;
    return has_depths && array->rank() >= 2 && array->shape()[0] > 0 && array->shape()[1] > 0 &&
                   array->count() == array->shape()[0] * array->shape()[1]
               ? array
               : nullptr;
  }
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return nullptr;
  for (const idf::DictEntry& entry : *dict)
    if (const auto* found = find_depth(entry.value)) return found;
  return nullptr;
}

/// The distance at a place of the image, whose sides are 1. Nothing where it was not measured.
std::optional<double> depth_at(const idf::NdArray& image, double x, double y) {
  const int64_t height = image.shape()[0];
  const int64_t width = image.shape()[1];
  const auto column =
      std::clamp<int64_t>(std::llround(std::floor(x * static_cast<double>(width))), 0, width - 1);
  const auto row =
      std::clamp<int64_t>(std::llround(std::floor(y * static_cast<double>(height))), 0, height - 1);
  const auto pixel = static_cast<size_t>(row * width + column);
  const double metres = image.type() == idf::ElementType::kUInt16
                            ? image.values<uint16_t>()[pixel] * kMetresPerMillimetre
                            : image.values<float>()[pixel];
  if (!std::isfinite(metres) || metres <= 0) return std::nullopt;
  return metres;
}

}  // namespace

Result<std::shared_ptr<const EntityContext>> SeenContexts::of(const MemoryId& entity) {
  if (const auto known = contexts_.find(entity); known != contexts_.end()) return known->second;
  SharedContext context;
  ENGRAM_ASSIGN_OR_RETURN(const auto past, seen_(entity));
  if (past) {
    ENGRAM_ASSIGN_OR_RETURN(context, past->context(past_.type_of(entity)));
  } else if (others_) {
    if (const auto other = others_->find(entity); other != others_->end()) context = other->second;
  }
  contexts_[entity] = context;
  return context;
}

Status SeenContexts::gather(const MemoryId& entity, EntityPast& own) {
  ENGRAM_ASSIGN_OR_RETURN(contexts_[entity], own.context(past_.type_of(entity)));
  return {};
}

Result<std::optional<Intrinsics>> SeenContexts::intrinsics(const MemoryId& link) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, seen_(link.entity()));
  if (!past) return std::optional<Intrinsics>();
  std::optional<Time> time = link.time();
  if (time) {
    ENGRAM_ASSIGN_OR_RETURN(const auto there, past->at_or_after(*time));
    if (there != time) return std::optional<Intrinsics>();
  } else {
    ENGRAM_ASSIGN_OR_RETURN(time, past->last());
  }
  if (!time) return std::optional<Intrinsics>();
  ENGRAM_ASSIGN_OR_RETURN(const RecalledSnapshot snapshot, past->read(*time, Prefer::kRecorded));
  for (const InstanceResult& instance : snapshot.answer.instances)
    if (!link.index() || *link.index() == instance.index)
      if (const auto found = intrinsics_in(instance.data)) return found;
  return std::optional<Intrinsics>();
}

Result<SharedContext> context_for_others(KnownPast& past, const SeenPastOf& seen,
                                         const MemoryId& entity) {
  SeenContexts contexts(past, seen);
  ENGRAM_ASSIGN_OR_RETURN(const SharedContext known, contexts.of(entity));
  if (!known || known->cameras.size() == 0) return known;
  EntityContext context = *known;
  std::map<MemoryId, std::optional<Intrinsics>> read;
  for (int32_t& calibration : context.cameras.calibration) {
    if (calibration < 0) continue;
    const MemoryId link = context.link(static_cast<size_t>(calibration));
    auto found = read.find(link);
    if (found == read.end()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto intrinsics, contexts.intrinsics(link));
      found = read.emplace(link, intrinsics).first;
    }
    // A camera of no size sees nothing, as one without intrinsics.
    const Intrinsics own = found->second.value_or(Intrinsics{});
    calibration = -1 - static_cast<int32_t>(index_of_lens(context.intrinsics, own));
  }
  return SharedContext(std::make_shared<const EntityContext>(std::move(context)));
}

ListMoments list_moments(KnownPast& past, SeenPastOf seen, const MemoryId& entity, bool is_named,
                         std::shared_ptr<const OtherContexts> others) {
  return [&past, seen = std::move(seen), entity, is_named,
          others = std::move(others)](std::span<const Condition> conditions) {
    SeenContexts contexts(past, seen, others);
    return moments_meeting(entity, conditions, is_named, contexts);
  };
}

ListMoments list_moments(KnownPast& past, SeenPastOf seen, const MemoryId& entity, EntityPast& own,
                         bool is_named, std::shared_ptr<const OtherContexts> others) {
  return [&past, seen = std::move(seen), entity, &own, is_named, others = std::move(others)](
             std::span<const Condition> conditions) -> Result<std::vector<Time>> {
    SeenContexts contexts(past, seen, others);
    ENGRAM_RETURN_IF_ERROR(contexts.gather(entity, own));
    return moments_meeting(entity, conditions, is_named, contexts);
  };
}

ListMoments list_moments(KnownPast& past, const MemoryId& entity, bool is_named) {
  return list_moments(
      past, [&past](const MemoryId& other) { return past.of(other); }, entity, is_named);
}

Result<const std::vector<MemoryId>*> SeenContexts::depths_of(const MemoryId& camera) {
  if (const auto known = depths_.find(camera); known != depths_.end()) return &known->second;
  std::vector<MemoryId> depths;
  ENGRAM_ASSIGN_OR_RETURN(const Query all, Query::parse(".*"));
  for (const MemoryId& entity : past_.matching(all)) {
    const auto type = past_.type_of(entity);
    if (!type || !is_depth(*type)) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto context, of(entity));
    if (context && std::ranges::find(context->targets, camera) != context->targets.end())
      depths.push_back(entity);
  }
  return &depths_.emplace(camera, std::move(depths)).first->second;
}

Result<bool> SeenContexts::has_depths(const MemoryId& camera) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* const depths, depths_of(camera));
  return !depths->empty();
}

Result<std::optional<bool>> SeenContexts::is_hidden(const MemoryId& image, double x, double y,
                                                    double z) {
  const MemoryId camera = image.entity();
  ENGRAM_ASSIGN_OR_RETURN(const auto* const depths, depths_of(camera));
  std::optional<bool> hidden;
  for (const MemoryId& depth : *depths) {
    ENGRAM_ASSIGN_OR_RETURN(const auto context, of(depth));
    const auto& links = context->links;
    // A depth image is taken with the image that it links to.
    const auto snapshot = context->find(*image.time());
    if (!snapshot) continue;
    for (size_t i = first_row(links.snapshot, *snapshot);
         i < links.size() && links.snapshot[i] == *snapshot; ++i) {
      if (context->targets[links.target[i]] != camera || links.time[i] != to_ns(*image.time()) ||
          (links.index[i] != EntityContext::Links::kNoInstance && links.index[i] != *image.index()))
        continue;
      ENGRAM_ASSIGN_OR_RETURN(const auto past, seen_(depth));
      if (!past) continue;
      ENGRAM_ASSIGN_OR_RETURN(const RecalledSnapshot read,
                              past->read(*image.time(), Prefer::kRecorded));
      for (const InstanceResult& instance : read.answer.instances) {
        if (instance.index != links.instance[i]) continue;
        const idf::NdArray* found = find_depth(instance.data);
        const auto metres = found == nullptr ? std::nullopt : depth_at(*found, x, y);
        if (metres) hidden = hidden.value_or(false) || *metres < z - kOwnDepth;
      }
    }
  }
  return hidden;
}

}  // namespace engram::ltm
