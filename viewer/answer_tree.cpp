// SPDX-License-Identifier: Apache-2.0
// What there is: the tree of names, sizes and forms.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>

#include "ltm/core/ascii.h"
#include "reports/plain/shown_value.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using TreeJson = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kLevels{"memory", "core", "provider", "entity"};

/// Sums over entities below a name.
struct TreeNode {
  uint64_t entities = 0;
  uint64_t snapshots = 0;
  std::optional<Time> first;
  std::optional<Time> last;

  void add(const ltm::EntityTimes& times) {
    ++entities;
    snapshots += times.all.size();
    if (times.all.empty()) return;
    first = std::min(first.value_or(times.all.front()), times.all.front());
    last = std::max(last.value_or(times.all.back()), times.all.back());
  }

  void write(TreeJson& json) const {
    json["entities"] = entities;
    json["snapshots"] = snapshots;
    json["first"] = first ? TreeJson(time_text(*first)) : TreeJson();
    json["last"] = last ? TreeJson(time_text(*last)) : TreeJson();
  }
};

/// The ID of `levels` names of another.
ltm::MemoryId prefix_of(const ltm::MemoryId& id, size_t levels) {
  ltm::MemoryId prefix = id;
  while (prefix.depth() > levels) prefix = prefix.parent();
  return prefix;
}

void add_kinds(const idf::Type& type, std::set<std::string>& kinds) {
  switch (type.kind()) {
    case idf::TypeKind::kImage: {
      const idf::PixelType pixel = type.get<idf::types::Image>().pixel;
      const bool is_depth = pixel == idf::PixelType::kDepth32 || pixel == idf::PixelType::kDepth16;
      kinds.insert(is_depth ? "depth" : "image");
      return;
    }
    case idf::TypeKind::kPointCloud:
      kinds.insert("cloud");
      return;
    case idf::TypeKind::kPose:
      kinds.insert("pose");
      return;
    case idf::TypeKind::kString:
      kinds.insert("text");
      return;
    case idf::TypeKind::kMemoryLink:
      kinds.insert("link");
      return;
    default:
      break;
  }
  const std::vector<idf::Member> parts = type.parts();
  if (parts.empty()) kinds.insert("number");
  for (const idf::Member& part : parts) add_kinds(part.type, kinds);
}

/// What panels can show of an entity: as its type says, else as its last snapshot has it. Images
/// are not read for it: how they are stored tells that they are there.
Result<std::set<std::string>> kinds_of(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  std::set<std::string> kinds;
  if (const idf::Type* type = reader.manifest().types.of_entity(entity); type != nullptr) {
    add_kinds(*type, kinds);
    return kinds;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::StoredForms forms, reader.newest_forms(entity));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader.timeline(entity));
  if (!timeline->last()) return kinds;
  ENGRAM_ASSIGN_OR_RETURN(const auto last, timeline->at_or_before(*timeline->last()));
  if (!last || !last->recorded) {
    if (!forms.media_codecs.empty()) kinds.insert("image");
    return kinds;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::PackedSnapshot packed, reader.read_values(entity, *last));
  for (const ltm::PackedInstance& instance : packed.instances) {
    for (const reports::ShownMember& member : reports::shown_members(instance.value.rest, {}))
      kinds.insert(member.kind);
    for (const ltm::PackedMedium& medium : instance.value.media) {
      const ltm::MediumKind kind = ltm::medium_kind(medium.type, medium.shape);
      if (kind == ltm::MediumKind::kImage) kinds.insert("image");
      if (kind == ltm::MediumKind::kDepth) kinds.insert("depth");
    }
  }
  return kinds;
}

Status write_entity(ViewedMemory& viewed, const StoreView& view, const ltm::MemoryId& entity,
                    TreeJson& json) {
  ENGRAM_ASSIGN_OR_RETURN(const auto kinds, kinds_of(view.reader, entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, entity));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::EntitySummary summary, view.reader.summary(entity));
  json["kinds"] = kinds;
  json["forms"] = {{"recorded", times->all.size() - times->latent.size() - times->augmented.size()},
                   {"latent", times->latent.size()},
                   {"augmented", times->augmented.size()}};
  json["raw_bytes"] = summary.raw_bytes;
  json["stored_bytes"] = summary.stored_bytes;
  json["latent_bytes"] = summary.latent_bytes;
  json["model_bytes"] = summary.model_bytes;
  json["models"] = summary.models.size();
  return {};
}

/// The entities of a memory, and what is known of each. Sorted.
using TreeLeaves = std::vector<std::pair<ltm::MemoryId, ViewedMemory::SharedTimes>>;

/// What lies below an ID, and below that, `depth` levels of it. `leaves` are those below it; of a
/// store, `view` is its state.
Result<TreeJson> children_of(ViewedMemory& viewed, const StoreView* view,
                             std::span<const TreeLeaves::value_type> leaves, size_t level,
                             int64_t depth) {
  TreeJson children = TreeJson::array();
  while (!leaves.empty()) {
    const ltm::MemoryId id = prefix_of(leaves.front().first, level + 1);
    size_t count = 0;
    TreeNode node;
    for (; count < leaves.size() && id.is_prefix_of(leaves[count].first); ++count)
      if (view != nullptr) node.add(*leaves[count].second);
    TreeJson child{{"name", id.names().back()}, {"id", id.to_string()}, {"level", kLevels[level]}};
    child["entities"] = count;
    if (view != nullptr) node.write(child);
    if (view != nullptr && id.is_entity())
      ENGRAM_RETURN_IF_ERROR(write_entity(viewed, *view, id, child));
    if (depth > 1 && !id.is_entity()) {
      ENGRAM_ASSIGN_OR_RETURN(child["children"],
                              children_of(viewed, view, leaves.first(count), level + 1, depth - 1));
    }
    children.push_back(std::move(child));
    leaves = leaves.subspan(count);
  }
  return children;
}

Result<TreeJson> children_in_store(ViewedMemory& viewed, const ltm::MemoryId& under,
                                   int64_t depth) {
  TreeJson children;
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
    TreeLeaves leaves;
    for (const ltm::MemoryId& entity : view.reader.entities()) {
      if (!under.is_prefix_of(entity)) continue;
      ENGRAM_ASSIGN_OR_RETURN(auto times, viewed.times(view, entity));
      leaves.emplace_back(entity, std::move(times));
    }
    ENGRAM_ASSIGN_OR_RETURN(children, children_of(viewed, &view, leaves, under.depth(), depth));
    return {};
  }));
  return children;
}

/// A server tells names; all else would have to be asked of each entity.
Result<TreeJson> children_on_server(ViewedMemory& viewed, const ltm::MemoryId& under,
                                    int64_t depth) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, viewed.entities());
  TreeLeaves leaves;
  for (const ltm::MemoryId& entity : entities)
    if (under.is_prefix_of(entity)) leaves.emplace_back(entity, nullptr);
  return children_of(viewed, nullptr, leaves, under.depth(), depth);
}

/// The entities of a server, and when the first of their snapshots was and the last. It would have
/// to list all snapshots to count them.
Result<TreeNode> look_at_server(ViewedMemory& viewed) {
  TreeNode node;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse("?ids @ 0..0, latest"));
  const Status looked =
      viewed.memory().query_parts(query, [&node](const ltm::QueryResult& part) -> Status {
        for (const ltm::EntityResult* entity : part.entities())
          for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
            node.first = std::min(node.first.value_or(snapshot.time), snapshot.time);
            node.last = std::max(node.last.value_or(snapshot.time), snapshot.time);
          }
        return {};
      });
  if (!looked.ok() && looked.code() != StatusCode::kNotFound) return looked;
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, viewed.entities());
  node.entities = entities.size();
  return node;
}

}  // namespace

ViewAnswer answer_info(ViewedMemory& viewed, const RequestTarget& /*target*/) {
  const ViewedMemory::Options& options = viewed.options();
  TreeJson store{{"name", options.name}};
  if (viewed.is_store()) store["path"] = options.store.string();
  TreeJson json{{"name", options.name},
                {"version", ENGRAM_VERSION},
                {"stores", TreeJson::array({std::move(store)})}};
  if (viewed.is_store()) {
    TreeNode all;
    ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
      all = {};
      for (const ltm::MemoryId& entity : view.reader.entities()) {
        ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, entity));
        all.add(*times);
      }
      return {};
    }));
    all.write(json);
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const TreeNode all, look_at_server(viewed));
    all.write(json);
    json["snapshots"] = nullptr;
  }
  json["is_live"] = !viewed.is_store();
  json["max_horizon_ns"] = std::to_string(OpenOptions{}.max_horizon.count());
  return json_response(json);
}

ViewAnswer answer_tree(ViewedMemory& viewed, const RequestTarget& target) {
  ltm::MemoryId under;
  if (const auto text = target.find("under"); text && !text->empty()) {
    ENGRAM_ASSIGN_OR_RETURN(under, ltm::MemoryId::parse(*text));
  }
  if (under.depth() >= ltm::MemoryId::kNameLevels)
    return invalid_argument("parameter 'under': found '{}', needs a memory or a segment",
                            under.printable());
  ENGRAM_ASSIGN_OR_RETURN(const int64_t depth,
                          target.integer("depth", 1, ltm::MemoryId::kNameLevels, 1));
  ENGRAM_ASSIGN_OR_RETURN(TreeJson children, viewed.is_store()
                                                 ? children_in_store(viewed, under, depth)
                                                 : children_on_server(viewed, under, depth));
  if (children.empty() && under.depth() > 0)
    return not_found("'{}': there is nothing below it", under.to_string());
  return bounded_json({{"under", under.to_string()}, {"children", std::move(children)}});
}

ViewAnswer answer_find(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxFound = 1000;
  const std::string text = lower_ascii(target.find("text").value_or(""));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t max, target.integer("max", 1, kMaxFound, 100));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, viewed.entities());
  TreeJson found = TreeJson::array();
  bool has_more = false;
  for (const ltm::MemoryId& entity : entities) {
    std::string id = entity.to_string();
    if (lower_ascii(id).find(text) == std::string::npos) continue;
    has_more = found.size() == static_cast<size_t>(max);
    if (has_more) break;
    found.push_back(std::move(id));
  }
  return json_response({{"found", std::move(found)}, {"more", has_more}});
}

}  // namespace engram::viewer
