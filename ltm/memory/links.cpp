// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/links.h"

#include <algorithm>
#include <map>

#include "ltm/idf/place.h"

namespace engram::ltm {

namespace {

/// An ID has four names before its time.
constexpr int64_t kSlashesBeforeTime = 4;
/// Longer texts are taken for prose, not for an ID.
constexpr size_t kMaxGuessedBytes = 4096;

/// Calls `visit(text, place)` for each string that may be a link.
template <typename Visit>
void walk(const idf::Data& value, const idf::Place& place, Visit& visit) {
  if (const auto* text = value.get_if<std::string>()) {
    visit(*text, place);
  } else if (const auto* list = value.get_if<idf::List>()) {
    for (size_t i = 0; i < list->size(); ++i) walk((*list)[i], idf::Place(place, i), visit);
  } else if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const auto& [key, part] : *dict) walk(part, idf::Place(place, key), visit);
  }
}

/// Calls `visit(text, place)` for each MemoryLink of `type` that is in its place.
template <typename Visit>
void walk(const idf::Data& value, const idf::Type& type, const idf::Place& place, Visit& visit) {
  if (type.kind() == idf::TypeKind::kMemoryLink) {
    if (const auto* text = value.get_if<std::string>()) visit(*text, place);
    return;
  }
  const auto* list = value.get_if<idf::List>();
  const auto* dict = value.get_if<idf::Dict>();
  if (const auto* object = type.get_if<idf::types::Object>()) {
    for (const idf::Member& member : object->members) {
      const idf::Data* part = dict == nullptr ? nullptr : dict->find(member.name);
      if (part != nullptr) walk(*part, member.type, idf::Place(place, member.name), visit);
    }
    return;
  }
  const std::vector<idf::Member> parts = type.parts();
  switch (type.kind()) {
    case idf::TypeKind::kList:
      for (size_t i = 0; list != nullptr && i < list->size(); ++i)
        walk((*list)[i], parts[0].type, idf::Place(place, i), visit);
      return;
    case idf::TypeKind::kDict:
      if (dict == nullptr) return;
      for (const auto& [key, part] : *dict)
        walk(part, parts[0].type, idf::Place(place, key), visit);
      return;
    case idf::TypeKind::kTuple:
    case idf::TypeKind::kPair:
      for (size_t i = 0; list != nullptr && i < std::min(parts.size(), list->size()); ++i)
        walk((*list)[i], parts[i].type, idf::Place(place, i), visit);
      return;
    default:
      return;
  }
}

idf::Data rewritten(idf::Data value, const std::vector<Link>& links, const Rewrite& rewrite) {
  for (const Link& link : links) {
    const auto id = rewrite(link.id);
    if (!id) continue;
    idf::Data* text = value.at(link.path);
    ENGRAM_CHECK(text != nullptr, "no value at '{}'", link.path);
    *text = id->to_string();
  }
  return value;
}

}  // namespace

std::vector<Link> find_links(const idf::Data& value, const idf::Type& type) {
  std::vector<Link> links;
  auto visit = [&links](const std::string& text, const idf::Place& place) {
    if (text.empty()) return;
    if (auto id = MemoryId::parse(text); id.ok()) links.push_back({place.path(), *std::move(id)});
  };
  walk(value, type, idf::Place(), visit);
  return links;
}

std::vector<Link> find_links(const idf::Data& value) {
  std::vector<Link> links;
  auto visit = [&links](const std::string& text, const idf::Place& place) {
    if (text.size() > kMaxGuessedBytes || std::ranges::count(text, '/') < kSlashesBeforeTime)
      return;
    auto id = MemoryId::parse(text);
    if (id.ok() && id->time()) links.push_back({place.path(), *std::move(id)});
  };
  walk(value, idf::Place(), visit);
  return links;
}

std::vector<idf::Mismatch> check_links(const idf::Data& value, const idf::Type& type) {
  std::vector<idf::Mismatch> mismatches;
  auto visit = [&mismatches](const std::string& text, const idf::Place& place) {
    const auto id = MemoryId::parse(text);
    if (!id.ok())
      mismatches.push_back(
          {place.path(), idf::describe(text), "a memory ID: " + id.status().message()});
  };
  walk(value, type, idf::Place(), visit);
  return mismatches;
}

idf::Data rewrite_links(idf::Data value, const idf::Type& type, const Rewrite& rewrite) {
  const std::vector<Link> links = find_links(value, type);
  return rewritten(std::move(value), links, rewrite);
}

idf::Data rewrite_links(idf::Data value, const Rewrite& rewrite) {
  const std::vector<Link> links = find_links(value);
  return rewritten(std::move(value), links, rewrite);
}

std::vector<ResolvedLink> resolve_links(const std::vector<Link>& links, const Lookup& lookup) {
  std::map<MemoryId, Result<idf::Data>> known;
  std::vector<ResolvedLink> resolved;
  resolved.reserve(links.size());
  for (const Link& link : links) {
    auto target = known.find(link.id);
    if (target == known.end()) target = known.emplace(link.id, lookup(link.id)).first;
    resolved.push_back({link, target->second});
  }
  return resolved;
}

}  // namespace engram::ltm
