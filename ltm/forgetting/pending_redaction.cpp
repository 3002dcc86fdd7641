// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/pending_redaction.h"

#include <nlohmann/json.hpp>

#include "ltm/core/file.h"
#include "ltm/idf/base64.h"
#include "ltm/idf/strict_json.h"

namespace engram::ltm {

namespace {

using PendingJson = nlohmann::ordered_json;

constexpr const char* kPendingFile = "erasures/redaction.pending";
/// The file, its entities, one of them, a list of it, an entry, a number.
constexpr int kMaxPendingLevels = 6;

/// Reads the file's JSON. What is not as write_pending_redaction wrote it throws, as the JSON
/// library does itself where a number is a text.
class PendingReader {
 public:
  static PendingRedaction read(const PendingJson& json) {
    PendingRedaction pending;
    pending.first_segment = number<uint64_t>(json.at("first_segment"));
    pending.bytes_before = number<uint64_t>(json.at("bytes_before"));
    for (const auto& [name, entity] : json.at("entities").items()) {
      auto id = MemoryId::parse(name);
      if (!id.ok() || !id->is_entity()) throw std::invalid_argument("found an ID that is none");
      pending.entities[*std::move(id)] = read_entity(entity);
    }
    return pending;
  }

 private:
  template <typename T>
  static T number(const PendingJson& json) {
    const bool fits = std::is_unsigned_v<T> ? json.is_number_unsigned() : json.is_number_integer();
    if (!fits) throw std::invalid_argument("found a number that is none");
    return json.get<T>();
  }
  static Time time(const PendingJson& json) { return time_from_ns(number<int64_t>(json)); }

  static PendingEntity read_entity(const PendingJson& json) {
    PendingEntity entity;
    for (const PendingJson& each : json.at("redacted"))
      entity.redacted[time(each.at(0))] = {number<uint64_t>(each.at(1)), each.at(2).get<bool>(),
                                           number<uint64_t>(each.at(3))};
    if (json.contains("counting"))
      entity.counting = {number<uint64_t>(json.at("counting").at(0)),
                         number<uint64_t>(json.at("counting").at(1))};
    for (const PendingJson& each : json.at("dropped"))
      entity.dropped[time(each.at(0))] = number<uint64_t>(each.at(1));
    std::vector<Time> made;
    for (const PendingJson& each : json.at("made")) made.push_back(time(each));
    entity.made = TimeSet(std::move(made));
    for (const PendingJson& each : json.at("held")) entity.held.push_back(read_held(each));
    return entity;
  }

  static PendingEntity::Held read_held(const PendingJson& json) {
    const auto member = idf::from_base64(json.at(2).get<std::string>());
    if (!member) throw std::invalid_argument("found a member that is no base64");
    PendingEntity::Held held;
    held.time = time(json.at(0));
    held.seen.place = {number<uint64_t>(json.at(1)), std::string(as_text(*member)),
                       number<int64_t>(json.at(3))};
    double* const sides[] = {&held.seen.box.left, &held.seen.box.top, &held.seen.box.right,
                             &held.seen.box.bottom};
    for (size_t i = 0; i < 4; ++i) {
      *sides[i] = json.at(4 + i).get<double>();
      if (!(*sides[i] >= 0 && *sides[i] <= 1)) throw std::invalid_argument("found a box outside");
    }
    return held;
  }
};

PendingJson to_pending_json(const PendingEntity& entity) {
  PendingJson redacted = PendingJson::array(), dropped = PendingJson::array(),
              made = PendingJson::array(), held = PendingJson::array();
  for (const auto& [time, of] : entity.redacted)
    redacted.push_back({to_ns(time), of.raw_bytes, of.is_counted, of.boxes});
  // An array in its own right, because the library takes a list of two for an object otherwise.
  for (const auto& [time, boxes] : entity.dropped)
    dropped.push_back(PendingJson::array({to_ns(time), boxes}));
  for (const Time time : entity.made) made.push_back(to_ns(time));
  for (const auto& [time, seen] : entity.held)
    // Paths of members need not be UTF-8, as texts of JSON must.
    held.push_back({to_ns(time), seen.place.instance,
                    idf::to_base64(std::as_bytes(std::span(seen.place.member))), seen.place.image,
                    seen.box.left, seen.box.top, seen.box.right, seen.box.bottom});
  PendingJson json{{"redacted", std::move(redacted)},
                   {"dropped", std::move(dropped)},
                   {"made", std::move(made)},
                   {"held", std::move(held)}};
  if (entity.counting) json["counting"] = {entity.counting->snapshots, entity.counting->raw_bytes};
  return json;
}

}  // namespace

ForgetSet PendingRedaction::redacted() const {
  ForgetSet set;
  for (const auto& [id, entity] : entities) {
    std::vector<Time> times;
    for (const auto& [time, of] : entity.redacted) times.push_back(time);
    if (!times.empty()) set[id] = TimeSet(std::move(times));
  }
  return set;
}

ForgetSet PendingRedaction::dropped() const {
  ForgetSet set;
  for (const auto& [id, entity] : entities) {
    std::vector<Time> times;
    for (const auto& [time, boxes] : entity.dropped) times.push_back(time);
    if (!times.empty()) set[id] = TimeSet(std::move(times));
  }
  return set;
}

ForgetSet PendingRedaction::made() const {
  ForgetSet set;
  for (const auto& [id, entity] : entities)
    if (!entity.made.empty()) set[id] = entity.made;
  return set;
}

uint64_t PendingRedaction::snapshots() const {
  uint64_t count = 0;
  for (const auto& [id, entity] : entities) count += entity.redacted.size() + entity.dropped.size();
  return count;
}

Result<std::optional<PendingRedaction>> read_pending_redaction(const std::filesystem::path& store) {
  const std::filesystem::path path = store / kPendingFile;
  const auto file = File::open(path, File::Mode::kRead);
  if (file.status().code() == StatusCode::kNotFound) return std::optional<PendingRedaction>();
  ENGRAM_RETURN_IF_ERROR(file.status());
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file->size());
  std::string text(size, '\0');
  ENGRAM_RETURN_IF_ERROR(file->read_at(0, std::as_writable_bytes(std::span(text))));
  const auto damaged = [&path](std::string_view what) {
    return data_loss("'{}': {}; it says which originals a redaction has still to take",
                     path.string(), what);
  };
  const auto json = idf::parse_json(text, kMaxPendingLevels);
  if (!json.ok()) return damaged(json.status().message());
  try {
    return std::optional(PendingReader::read(*json));
  } catch (const std::exception& error) {
    return damaged(error.what());
  }
}

Status write_pending_redaction(const std::filesystem::path& store,
                               const PendingRedaction& pending) {
  const std::filesystem::path path = store / kPendingFile;
  std::error_code failed;
  std::filesystem::create_directories(path.parent_path(), failed);
  if (failed) return unavailable("'{}': {}", path.parent_path().string(), failed.message());
  PendingJson entities = PendingJson::object();
  for (const auto& [id, entity] : pending.entities)
    if (!entity.empty()) entities[id.to_string()] = to_pending_json(entity);
  const PendingJson json{{"first_segment", pending.first_segment},
                         {"bytes_before", pending.bytes_before},
                         {"entities", std::move(entities)}};
  const std::string text = json.dump() + "\n";
  return replace_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

Status remove_pending_redaction(const std::filesystem::path& store) {
  const std::filesystem::path path = store / kPendingFile;
  std::error_code failed;
  if (!std::filesystem::exists(path, failed)) return {};
  return remove_file(path);
}

}  // namespace engram::ltm
