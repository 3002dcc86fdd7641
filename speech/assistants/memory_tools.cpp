// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/memory_tools.h"

#include <utility>

#include "ltm/core/buffer.h"
#include "ltm/idf/base64.h"
#include "reports/plain/shown_image.h"
#include "reports/plain/shown_value.h"
#include "reports/plain/similar_text.h"
#include "server/navigation/why.h"
#include "speech/assistants/tool_arguments.h"

namespace engram::speech {

namespace {

/// An assistant reads all of an answer, and pays for each word.
constexpr size_t kMaxCharacters = 200'000;
constexpr size_t kMaxListed = 1000;

const char* const kTimeText =
    "'2022-02-18 13:06:56.492182', RFC 3339, or integer nanoseconds since 1970, UTC";

ToolJson text_schema(std::string description) {
  return {{"type", "string"}, {"description", std::move(description)}};
}

ToolJson number_schema(std::string description) {
  return {{"type", "number"}, {"description", std::move(description)}};
}

ToolJson count_schema(std::string description, size_t otherwise) {
  return {{"type", "integer"},
          {"minimum", 1},
          {"maximum", kMaxListed},
          {"default", otherwise},
          {"description", std::move(description)}};
}

ToolJson schema_of(ToolJson properties, ToolJson required) {
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"required", std::move(required)},
          {"additionalProperties", false}};
}

/// Ends an answer that comes in parts, without an error.
class Enough {
 public:
  Status stop() {
    is_enough_ = true;
    return cancelled("the assistant has enough");
  }
  [[nodiscard]] Status unless(const Status& status) const { return is_enough_ ? Status() : status; }
  [[nodiscard]] bool is_enough() const { return is_enough_; }

 private:
  bool is_enough_ = false;
};

ToolJson named(const ltm::MemoryId& id) {
  return id.to_string();
}

Result<ToolJson> snapshot_value(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
  ToolJson value{{"id", entity.at(snapshot.time).to_string()},
                 {"source", std::string(to_string(snapshot.source))}};
  ToolJson instances = ToolJson::array();
  for (const ltm::InstanceResult& instance : snapshot.instances) {
    ENGRAM_ASSIGN_OR_RETURN(ToolJson shown, reports::shown_value(instance.data, std::nullopt));
    instances.push_back(std::move(shown));
  }
  value["instances"] = std::move(instances);
  return value;
}

// ---- entities

Result<ToolAnswer> list_entities(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const std::string names, arguments.text_or("names", ""));
  ENGRAM_ASSIGN_OR_RETURN(const size_t max, arguments.count_or("max", 200, kMaxListed));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query,
                          ltm::Query::parse("?ids " + names + " @ 0..0, latest"));
  ToolJson entities = ToolJson::array();
  Enough enough;
  const Status status = memory.query_parts(query, [&](const ltm::QueryResult& part) -> Status {
    for (const ltm::EntityResult* entity : part.entities()) {
      if (entity->snapshots.empty()) continue;
      if (entities.size() >= max) return enough.stop();
      entities.push_back({{"id", named(entity->id)},
                          {"first", to_string(entity->snapshots.front().time)},
                          {"last", to_string(entity->snapshots.back().time)}});
    }
    return {};
  });
  ENGRAM_RETURN_IF_ERROR(enough.unless(status));
  return ToolAnswer{{{"entities", std::move(entities)}, {"has_more", enough.is_enough()}}};
}

// ---- query

Result<ToolAnswer> query(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, arguments.text("query"));
  ENGRAM_ASSIGN_OR_RETURN(const size_t max, arguments.count_or("max_snapshots", 50, kMaxListed));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked, ltm::Query::parse(text));
  ToolJson entities = ToolJson::array();
  size_t snapshots = 0;
  size_t characters = 0;
  Enough enough;
  const Status status = memory.query_parts(asked, [&](const ltm::QueryResult& part) -> Status {
    for (const ltm::EntityResult* entity : part.entities()) {
      const ToolJson id = named(entity->id);
      if (entities.empty() || entities.back()["id"] != id)
        entities.push_back({{"id", id}, {"snapshots", ToolJson::array()}});
      for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
        if (snapshots >= max) return enough.stop();
        ENGRAM_ASSIGN_OR_RETURN(ToolJson value, snapshot_value(entity->id, snapshot));
        characters += value.dump(-1, ' ', false, ToolJson::error_handler_t::replace).size();
        if (characters > kMaxCharacters) return enough.stop();
        entities.back()["snapshots"].push_back(std::move(value));
        ++snapshots;
      }
    }
    return {};
  });
  ENGRAM_RETURN_IF_ERROR(enough.unless(status));
  return ToolAnswer{{{"entities", std::move(entities)},
                     {"snapshots", snapshots},
                     {"has_more", enough.is_enough()}}};
}

// ---- near

/// A time range in the text form of queries.
std::string range_text(std::optional<Time> from, std::optional<Time> until) {
  if (!from && !until) return "all";
  if (!from) return fmt::format("until:{}", to_string(*until));
  return fmt::format("time:{}..{}", to_ns(*from), to_ns(until.value_or(Time::max())));
}

/// Which entities were near, with the first and the last snapshot in which they were.
Result<ToolAnswer> near(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const double x, arguments.number("x"));
  ENGRAM_ASSIGN_OR_RETURN(const double y, arguments.number("y"));
  ENGRAM_ASSIGN_OR_RETURN(const double z, arguments.number("z"));
  ENGRAM_ASSIGN_OR_RETURN(const double radius, arguments.number_or("radius", 0.5, 0.001, 1e6));
  ENGRAM_ASSIGN_OR_RETURN(const std::string names, arguments.text_or("names", ""));
  ENGRAM_ASSIGN_OR_RETURN(const auto from, arguments.time("from"));
  ENGRAM_ASSIGN_OR_RETURN(const auto until, arguments.time("until"));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  if (from && until && *until < *from)
    return invalid_argument("argument 'until': found {}, needs a time at or after 'from', {}",
                            to_string(*until), to_string(*from));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked,
                          ltm::Query::parse(fmt::format("?ids {} @ {} near {},{},{} {}m", names,
                                                        range_text(from, until), x, y, z, radius)));
  ToolJson entities = ToolJson::array();
  Enough enough;
  const Status status = memory.query_parts(asked, [&](const ltm::QueryResult& part) -> Status {
    for (const ltm::EntityResult* entity : part.entities()) {
      if (entity->snapshots.empty()) continue;
      const ToolJson id = named(entity->id);
      if (entities.empty() || entities.back()["id"] != id) {
        if (entities.size() >= kMaxListed) return enough.stop();
        entities.push_back({{"id", id},
                            {"snapshots", 0},
                            {"first", to_string(entity->snapshots.front().time)},
                            {"last", ""}});
      }
      ToolJson& told = entities.back();
      told["snapshots"] = told["snapshots"].get<size_t>() + entity->snapshots.size();
      told["last"] = to_string(entity->snapshots.back().time);
    }
    return {};
  });
  if (status.code() != StatusCode::kNotFound) ENGRAM_RETURN_IF_ERROR(enough.unless(status));
  return ToolAnswer{{{"entities", std::move(entities)}, {"has_more", enough.is_enough()}}};
}

// ---- similar

Result<ToolAnswer> similar(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, arguments.id("id"));
  ENGRAM_ASSIGN_OR_RETURN(const size_t count, arguments.count_or("count", 10, kMaxListed));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ltm::SimilarRequest request;
  request.entity = id.entity();
  request.count = count;
  request.moment = id.time();
  if (!request.moment) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult last,
                            memory.query(ltm::Query::of_entity(id, ltm::select::Latest{})));
    const ltm::EntityResult* entity = last.find_entity(id);
    if (entity == nullptr || entity->snapshots.empty())
      return not_found("the memory has no '{}'", id.printable());
    request.moment = entity->snapshots.back().time;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::SimilarAnswer answer, memory.similar(request));
  return ToolAnswer{reports::similar_json(answer)};
}

// ---- why

Result<ToolAnswer> why(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, arguments.id("id"));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  ENGRAM_ASSIGN_OR_RETURN(const auto steps, navigation::why(memory, id));
  ToolJson list = ToolJson::array();
  for (const navigation::WhyStep& step : steps)
    list.push_back({{"id", named(step.id)}, {"member", step.member}, {"says", step.says}});
  return ToolAnswer{{{"why", std::move(list)}, {"text", navigation::why_text(steps)}}};
}

// ---- picture

/// The first image of an instance at or below a path.
const idf::NdArray* first_image(const idf::Data& value, const std::string& wanted) {
  if (!wanted.empty()) return reports::image_at(value, wanted);
  for (const reports::ShownMember& member : reports::shown_members(value, std::nullopt))
    if (member.kind == "image" || member.kind == "depth")
      return reports::image_at(value, member.path);
  return nullptr;
}

Result<ToolAnswer> picture(Memory& memory, const ToolJson& json) {
  ToolArguments arguments(json);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, arguments.id("id"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string member, arguments.text_or("member", ""));
  ENGRAM_RETURN_IF_ERROR(arguments.finish());
  const ltm::Selector selector = id.time() ? ltm::Selector(ltm::select::Before{*id.time(), true})
                                           : ltm::Selector(ltm::select::Latest{});
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                          memory.query(ltm::Query::of_entity(id.entity(), selector)));
  const ltm::EntityResult* entity = found.find_entity(id.entity());
  if (entity == nullptr || entity->snapshots.empty())
    return not_found("the memory has no '{}'", id.printable());
  const ltm::SnapshotResult& snapshot = entity->snapshots.back();
  const int32_t index = id.index().value_or(0);
  const ltm::InstanceResult* instance = snapshot.find(index);
  if (instance == nullptr)
    return not_found("'{}' has no instance {}", entity->id.at(snapshot.time).printable(), index);
  const idf::NdArray* image = first_image(instance->data, member);
  if (image == nullptr)
    return not_found("'{}' has no image{}", entity->id.at(snapshot.time).printable(),
                     member.empty() ? std::string() : fmt::format(" at '{}'", member));
  constexpr int kQuality = 85;
  ENGRAM_ASSIGN_OR_RETURN(
      const std::string bytes,
      reports::encoded_image(reports::shown_image(*image).pixels, "jpeg", kQuality));
  return ToolAnswer{{{"id", named(entity->id.at(snapshot.time).instance(index))},
                     {"source", std::string(to_string(snapshot.source))}},
                    ToolImage{"image/jpeg", idf::to_base64(as_bytes(bytes))}};
}

using Call = Result<ToolAnswer> (*)(Memory& memory, const ToolJson& arguments);

MemoryTool tool_of(Memory& memory, const char* name, const char* title, const char* description,
                   ToolJson schema, Call call) {
  return {name, title, description, std::move(schema),
          [&memory, call](const ToolJson& arguments) { return call(memory, arguments); }};
}

}  // namespace

std::vector<MemoryTool> memory_tools(Memory& memory) {
  const char* const id_text =
      "Memory/Core/Provider/Entity of an entity, or with /TIME behind it of a snapshot of it";
  const ToolJson names = text_schema(
      "Which entities: Memory/Core/Provider/Entity, each a name or a regular "
      "expression, missing ones match all; empty: all");
  return {
      tool_of(memory, "entities", "What the memory knows",
              "Lists the entities of the robot's memory, with the times of their first and last "
              "snapshots. Ask this first.",
              schema_of({{"names", names}, {"max", count_schema("How many are listed", 200)}},
                        ToolJson::array()),
              list_entities),
      tool_of(
          memory, "query", "Ask about any moment",
          "Values of entities at past moments, or predicted ones: 'NAMES @ SELECTOR', with "
          "selectors such as latest, latest:3, all, TIME, FROM..TO, at-or-before:TIME, last:10s "
          "and +200ms for a prediction. Example: 'Objects/Instances/.*/cup @ latest'. A member "
          "that is a $link names the snapshot that it leads to. Images are described; the tool "
          "picture shows them.",
          schema_of({{"query", text_schema("NAMES @ SELECTOR; several are joined by ';'")},
                     {"max_snapshots", count_schema("How many snapshots are told", 50)}},
                    ToolJson::array({"query"})),
          query),
      tool_of(memory, "near", "What was near a place",
              "Which entities had a place within a radius of a point of the world, in how many "
              "snapshots, and in which first and last one; between them they may have been "
              "elsewhere. Unit: m.",
              schema_of({{"x", number_schema("In m")},
                         {"y", number_schema("In m")},
                         {"z", number_schema("In m")},
                         {"radius", number_schema("In m; 0.5 if it is missing")},
                         {"names", names},
                         {"from", text_schema(kTimeText)},
                         {"until", text_schema(kTimeText)}},
                        ToolJson::array({"x", "y", "z"})),
              near),
      tool_of(
          memory, "similar", "When was it like this before?",
          "The moments of an entity that are most like one of its moments, the nearest first; a "
          "distance of 1 is that of two moments at random.",
          schema_of({{"id", text_schema(id_text)}, {"count", count_schema("How many moments", 10)}},
                    ToolJson::array({"id"})),
          similar),
      tool_of(memory, "why", "Why is it so?",
              "Why a snapshot is as it is, from its links alone: from an event to the plan, the "
              "request, and the words that were said.",
              schema_of({{"id", text_schema(id_text)}}, ToolJson::array({"id"})), why),
      tool_of(memory, "picture", "Look at an image",
              "The image of a snapshot, or the last one at or before its time.",
              schema_of({{"id", text_schema(id_text)},
                         {"member", text_schema("Which image of the value; empty: the first")}},
                        ToolJson::array({"id"})),
              picture),
  };
}

}  // namespace engram::speech
