// SPDX-License-Identifier: Apache-2.0
#include "cli/commit_lines.h"

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "ltm/idf/json.h"
#include "ltm/idf/strict_json.h"
#include "ltm/memory/augmentation_json.h"

namespace engram::cli {

using Json = nlohmann::ordered_json;

namespace {

constexpr size_t kMaxAtOnce = 500;
constexpr int kMaxLevels = 300;
constexpr size_t kMaxBytesAtOnce = size_t{4} << 20;
constexpr size_t kMaxLineBytes = size_t{256} << 20;

const Json* find(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

Result<Time> read_time(const Json& value) {
  const bool is_beyond = value.is_number_unsigned() && value.get<uint64_t>() > INT64_MAX;
  if (value.is_number_integer() && !is_beyond) return time_from_ns(value.get<int64_t>());
  if (value.is_string()) return parse_time(value.get<std::string>());
  return invalid_argument("time: found {}, needs a text or nanoseconds", value.dump());
}

/// Returns the time at a key, or `otherwise` if there is none.
Result<Time> read_time(const Json& object, const char* key, Time otherwise) {
  const Json* value = find(object, key);
  return value == nullptr ? otherwise : read_time(*value);
}

Result<ltm::MemoryId> read_id(const Json& object, const char* key) {
  const Json& value = *find(object, key);
  if (!value.is_string()) return invalid_argument("{}: found {}, needs a text", key, value.dump());
  return ltm::MemoryId::parse(value.get<std::string>());
}

Result<ltm::Instance> read_instance(const Json& json, Time created) {
  if (!json.is_object() || !json.contains("data"))
    return invalid_argument("instances: needs objects with the key 'data'");
  ltm::Instance instance;
  ENGRAM_ASSIGN_OR_RETURN(instance.data, idf::from_json(json.at("data")));
  ENGRAM_ASSIGN_OR_RETURN(instance.metadata.created, read_time(json, "created_ns", created));
  instance.metadata.sent = system_now();
  if (const Json* provider = find(json, "provider"); provider != nullptr && provider->is_string())
    instance.metadata.provider = provider->get<std::string>();
  if (const Json* confidence = find(json, "confidence");
      confidence != nullptr && confidence->is_number())
    instance.metadata.confidence = confidence->get<float>();
  ENGRAM_RETURN_IF_ERROR(ltm::read_augmentation(json, instance.metadata));
  return instance;
}

Result<ltm::EntityUpdate> read_head(const Json& json, Time now) {
  if (const Json* source = find(json, "source"); source != nullptr && *source == "predicted")
    return invalid_argument("found a prediction, needs what was or is");
  const bool has_entity = find(json, "entity") != nullptr;
  if (!has_entity && find(json, "id") == nullptr)
    return invalid_argument("has no 'entity', needs one, as in 'Memory/Core/Provider/Entity'");
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, read_id(json, has_entity ? "entity" : "id"));
  if (!id.has_entity())
    return invalid_argument("'{}' is no entity: needs four names, Memory/Core/Provider/Entity",
                            id.to_string());
  ltm::EntityUpdate update{id.entity(), {}, {}};
  const Time by_id = id.time().value_or(now);
  ENGRAM_ASSIGN_OR_RETURN(update.time, find(json, "time_ns") != nullptr
                                           ? read_time(json, "time_ns", by_id)
                                           : read_time(json, "time", by_id));
  return update;
}

}  // namespace

Result<ltm::EntityUpdate> parse_commit_line(std::string_view line, Time now) {
  ENGRAM_ASSIGN_OR_RETURN(const Json json, idf::parse_json(line, kMaxLevels));
  if (!json.is_object()) return invalid_argument("needs one object of JSON in each line");
  ENGRAM_ASSIGN_OR_RETURN(ltm::EntityUpdate update, read_head(json, now));
  if (json.contains("data")) {
    ENGRAM_ASSIGN_OR_RETURN(update.instances.emplace_back(), read_instance(json, update.time));
    return update;
  }
  const Json* instances = find(json, "instances");
  if (instances == nullptr || !instances->is_array() || instances->empty())
    return invalid_argument("has no data, needs 'data' or a list of 'instances'");
  for (const Json& each : *instances) {
    ENGRAM_ASSIGN_OR_RETURN(update.instances.emplace_back(), read_instance(each, update.time));
  }
  if (const Json* source = find(json, "source");
      source != nullptr && *source == "augmented" && !update.is_augmented())
    return invalid_argument("says it is augmented, needs instances with 'origin' or 'recipe'");
  return update;
}

Result<size_t> commit_lines(std::istream& lines,
                            const std::function<Status(const ltm::Commit&)>& take) {
  ltm::Commit waiting;
  std::set<ltm::MemoryId> ids;
  size_t bytes = 0, taken = 0, number = 0, first = 1;
  const auto hand_over = [&]() -> Status {
    if (waiting.updates.empty()) return {};
    if (const Status status = take(waiting); !status.ok())
      return status.with_context(first == number ? fmt::format("line {}", number)
                                                 : fmt::format("lines {} to {}", first, number));
    taken += waiting.updates.size();
    waiting.updates.clear();
    ids.clear();
    bytes = 0;
    return {};
  };
  std::string line;
  while (std::getline(lines, line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      ++number;
      continue;
    }
    auto update = line.size() > kMaxLineBytes
                      ? Result<ltm::EntityUpdate>(invalid_argument("is too long"))
                      : parse_commit_line(line, system_now());
    // One commit cannot hold two snapshots of the same entity and time.
    if (update.ok() && ids.contains(update->id())) ENGRAM_RETURN_IF_ERROR(hand_over());
    ++number;
    if (!update.ok()) {
      --number;
      ENGRAM_RETURN_IF_ERROR(hand_over());
      return update.status().with_context(
          fmt::format("line {} ({} snapshots before it were taken)", number + 1, taken));
    }
    if (waiting.updates.empty()) first = number;
    ids.insert(update->id());
    bytes += line.size();
    waiting.updates.push_back(*std::move(update));
    const bool has_more = lines.rdbuf()->in_avail() > 0;
    if (waiting.updates.size() >= kMaxAtOnce || bytes >= kMaxBytesAtOnce || !has_more)
      ENGRAM_RETURN_IF_ERROR(hand_over());
  }
  ENGRAM_RETURN_IF_ERROR(hand_over());
  return taken;
}

}  // namespace engram::cli
