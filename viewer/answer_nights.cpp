// SPDX-License-Identifier: Apache-2.0
// What entities take, what each night did, and what reflections found.
#include <algorithm>

#include "ltm/memory/data_fields.h"
#include "ltm/reflection/record_reflection.h"
#include "ltm/reflection/reflect.h"
#include "ltm/store/night_records.h"
#include "reports/plain/store_text.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using NightJson = nlohmann::ordered_json;

NightJson night_entity_json(const ltm::NightEntity& entity) {
  NightJson json{{"id", entity.entity.to_string()},     {"skipped", entity.skipped},
                 {"learned", entity.learned},           {"encoded", entity.encoded},
                 {"waiting", entity.waiting},           {"dropped", entity.dropped},
                 {"forgotten", entity.forgotten},       {"faded", entity.faded},
                 {"bytes_before", entity.bytes_before}, {"bytes_after", entity.bytes_after},
                 {"models_added", entity.models_added}, {"models_removed", entity.models_removed}};
  if (entity.psnr_db) json["psnr"] = *entity.psnr_db;
  if (entity.min_psnr_db) json["min_psnr"] = *entity.min_psnr_db;
  return json;
}

NightJson night_json(const ltm::NightRecord& night) {
  NightJson entities = NightJson::array();
  for (const ltm::NightEntity& entity : night.entities)
    entities.push_back(night_entity_json(entity));
  return {{"work", ltm::to_string(night.work)}, {"began", time_text(night.began)},
          {"ended", time_text(night.ended)},    {"failure", night.failure},
          {"bytes_before", night.bytes_before}, {"bytes_after", night.bytes_after},
          {"entities", std::move(entities)}};
}

/// The values of a reflection, as they are recorded.
struct ReflectionValues {
  std::vector<idf::Data> findings;
  std::vector<idf::Data> rates;
  std::vector<idf::Data> chains;

  /// Where the values of an entity belong; null for others.
  std::vector<idf::Data>* of(const ltm::MemoryId& entity) {
    const std::vector<std::string>& names = entity.names();
    if (names[1] == "Findings") return &findings;
    if (names[1] != "Summary") return nullptr;
    return names[2] == "skills" ? &rates : names[2] == "chains" ? &chains : nullptr;
  }
};

Result<NightJson> finding_json(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const auto fields, ltm::DataFields::of(data, "finding"));
  NightJson json;
  for (const char* name : {"kind", "severity", "entity", "member", "first_snapshot",
                           "last_snapshot", "found", "expected"}) {
    ENGRAM_ASSIGN_OR_RETURN(json[name], fields.text(name));
  }
  ENGRAM_ASSIGN_OR_RETURN(json["count"], fields.integer("count"));
  return json;
}

Result<NightJson> rate_json(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const auto fields, ltm::DataFields::of(data, "rate of success"));
  NightJson json;
  for (const char* name : {"skill", "by", "name"}) {
    ENGRAM_ASSIGN_OR_RETURN(json[name], fields.text(name));
  }
  for (const char* name : {"runs", "successes", "failures", "stops"}) {
    ENGRAM_ASSIGN_OR_RETURN(json[name], fields.integer(name));
  }
  for (const char* name : {"low", "high", "duration_s"}) {
    ENGRAM_ASSIGN_OR_RETURN(json[name], fields.number(name));
  }
  return json;
}

Result<NightJson> chain_json(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const auto fields, ltm::DataFields::of(data, "chain of failures"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* steps, fields.list("steps"));
  NightJson json{{"steps", NightJson::array()}};
  for (const idf::Data& step : *steps)
    if (const auto* text = step.get_if<std::string>()) json["steps"].push_back(*text);
  ENGRAM_ASSIGN_OR_RETURN(json["count"], fields.integer("count"));
  return json;
}

Result<NightJson> reflection_json(const ReflectionValues& values) {
  NightJson json{{"findings", NightJson::array()},
                 {"rates", NightJson::array()},
                 {"chains", NightJson::array()}};
  for (const idf::Data& value : values.findings) {
    ENGRAM_ASSIGN_OR_RETURN(NightJson finding, finding_json(value));
    // One of kind "none" says that nothing was found.
    if (finding["kind"] != "none") json["findings"].push_back(std::move(finding));
  }
  for (const idf::Data& value : values.rates) {
    ENGRAM_ASSIGN_OR_RETURN(NightJson rate, rate_json(value));
    json["rates"].push_back(std::move(rate));
  }
  for (const idf::Data& value : values.chains) {
    ENGRAM_ASSIGN_OR_RETURN(NightJson chain, chain_json(value));
    json["chains"].push_back(std::move(chain));
  }
  return json;
}

ltm::MemoryId findings_entity() {
  return ltm::MemoryId::from_names({ltm::kReflectionMemory, "Findings", "engram", "all"}).value();
}

/// When reflections were recorded, the newest last.
/// Errors: kNotFound if none was; those of Memory::query.
Result<std::vector<Time>> reflection_times(Memory& memory) {
  constexpr int64_t kMaxReflections = 200;
  std::vector<Time> times;
  const ltm::Query newest =
      ltm::Query::of_entity(findings_entity(), ltm::select::Latest{kMaxReflections});
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query ids, ltm::Query::create(newest.memories(), true));
  const auto found = memory.query(ids);
  if (!found.ok() && found.status().code() != StatusCode::kNotFound) return found.status();
  if (found.ok())
    if (const ltm::EntityResult* entity = found->find_entity(findings_entity()))
      for (const ltm::SnapshotResult& snapshot : entity->snapshots) times.push_back(snapshot.time);
  if (times.empty())
    return not_found(
        "no reflection was recorded: 'engram reflect --commit' looks at the memory and records "
        "what it finds");
  return times;
}

/// The reflection that was recorded last before `at`.
ViewAnswer recorded_reflection(ViewedMemory& viewed, std::optional<Time> at) {
  ENGRAM_ASSIGN_OR_RETURN(const auto times, reflection_times(viewed.memory()));
  const auto later = at ? std::ranges::upper_bound(times, *at) : times.end();
  if (later == times.begin())
    return not_found("no reflection was recorded before this moment; the first one is of {}",
                     engram::to_string(times.front()));
  const Time time = *std::prev(later);
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Query query,
      ltm::Query::parse(fmt::format("{} @ time:{}", ltm::kReflectionMemory, to_ns(time))));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, viewed.memory().query(query));
  ReflectionValues values;
  for (const ltm::EntityResult* entity : found.entities()) {
    std::vector<idf::Data>* const to = values.of(entity->id);
    if (to == nullptr) continue;
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      for (const ltm::InstanceResult& instance : snapshot.instances) to->push_back(instance.data);
  }
  NightJson known = NightJson::array();
  for (const Time one : times) known.push_back(time_text(one));
  NightJson json{{"time", time_text(time)}, {"times", std::move(known)}, {"is_recorded", true}};
  ENGRAM_ASSIGN_OR_RETURN(const NightJson told, reflection_json(values));
  json.update(told);
  return bounded_json(json);
}

/// Looks at the store now and records nothing.
ViewAnswer present_reflection(ViewedMemory& viewed, const std::string& page, Duration budget) {
  // A server does not hand out all that it has.
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([](const StoreView&) { return Status(); }));
  ENGRAM_ASSIGN_OR_RETURN(const auto running,
                          viewed.long_questions().begin("reflection " + page, budget));
  const auto found = ltm::reflect(viewed.options().store, {}, {}, running->stop());
  if (!found.ok()) return running->explained(found.status(), "the look at the whole store");
  const Time now = system_now();
  ReflectionValues values;
  for (const ltm::Snapshot& snapshot : ltm::to_commit(*found, now).updates) {
    std::vector<idf::Data>* const to = values.of(snapshot.entity);
    if (to == nullptr) continue;
    for (const ltm::Instance& instance : snapshot.instances) to->push_back(instance.data);
  }
  NightJson json{{"time", time_text(now)}, {"times", NightJson::array()}, {"is_recorded", false}};
  ENGRAM_ASSIGN_OR_RETURN(const NightJson told, reflection_json(values));
  json.update(told);
  return bounded_json(json);
}

}  // namespace

ViewAnswer answer_nights(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxNights = 1000;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t max, target.integer("max", 0, kMaxNights, 100));
  NightJson entities;
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
    entities = NightJson::array();
    for (const ltm::MemoryId& entity : view.reader.entities()) {
      ENGRAM_ASSIGN_OR_RETURN(const ltm::EntitySummary summary, view.reader.summary(entity));
      ENGRAM_ASSIGN_OR_RETURN(const ltm::StoredForms forms, view.reader.newest_forms(entity));
      NightJson json = reports::stored_entity_json(summary, forms, 0);
      json.erase("rate_hz");
      entities.push_back(std::move(json));
    }
    return {};
  }));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::NightRecords records,
                          ltm::read_nights(viewed.options().store, static_cast<size_t>(max)));
  NightJson nights = NightJson::array();
  for (const ltm::NightRecord& night : records.nights) nights.push_back(night_json(night));
  return bounded_json({{"entities", std::move(entities)},
                       {"nights", std::move(nights)},
                       {"unreadable", records.unreadable},
                       {"more", records.has_more}});
}

ViewAnswer answer_reflection(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t is_present, target.integer("look", 0, 1, 0));
  ENGRAM_ASSIGN_OR_RETURN(const LongQuestion question, long_question(target));
  if (question.is_called_off) {
    viewed.long_questions().call_off("reflection " + question.page);
    return json_response({{"called_off", true}});
  }
  if (is_present == 1) return present_reflection(viewed, question.page, question.budget);
  std::optional<Time> at;
  if (target.find("at")) {
    ENGRAM_ASSIGN_OR_RETURN(at, target.time("at"));
  }
  return recorded_reflection(viewed, at);
}

}  // namespace engram::viewer
