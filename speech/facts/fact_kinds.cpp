// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/fact_kinds.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace engram::speech {

namespace {

bool has_all(const idf::Dict& value, std::initializer_list<std::string_view> members) {
  return std::all_of(members.begin(), members.end(), [&](std::string_view member) {
    const idf::Data* found = value.find(member);
    return found != nullptr;
  });
}

bool has_text(const idf::Dict& value, std::string_view member) {
  const idf::Data* found = value.find(member);
  return found != nullptr && found->is<std::string>();
}

/// A member that says where something is in the world.
bool has_spot(const idf::Dict& value) {
  return std::any_of(value.begin(), value.end(), [](const idf::DictEntry& member) {
    return member.key.starts_with("pose_world_");
  });
}

}  // namespace

FactKind fact_kind(const idf::Data& value) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return FactKind::kNothing;
  if (has_text(*dict, "skill") && has_all(*dict, {"outcome"})) return FactKind::kExecution;
  if (has_text(*dict, "skill") && has_text(*dict, "reason") && has_all(*dict, {"unmet"}))
    return FactKind::kRefusal;
  if (has_text(*dict, "speaker") && has_text(*dict, "text")) return FactKind::kWords;
  if (has_text(*dict, "goal") && has_all(*dict, {"steps"})) return FactKind::kPlan;
  if (has_text(*dict, "spoken_name")) return FactKind::kThingClass;
  if (has_text(*dict, "name") && has_all(*dict, {"aliases"})) return FactKind::kLocation;
  if (has_text(*dict, "goal") && has_all(*dict, {"kind", "request"})) return FactKind::kDriveNote;
  if (!has_spot(*dict)) return FactKind::kNothing;
  if (has_all(*dict, {"depth", "width"}) && has_text(*dict, "name")) return FactKind::kSurface;
  if (has_all(*dict, {"object_class"}) || has_all(*dict, {"held_by"})) return FactKind::kThing;
  // A camera has a pose, too, but does not say how fast it moves.
  if (has_all(*dict, {"velocity"})) return FactKind::kRobot;
  return FactKind::kNothing;
}

}  // namespace engram::speech
