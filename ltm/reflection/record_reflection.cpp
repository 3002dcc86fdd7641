// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/record_reflection.h"

#include "ltm/recording/recorder.h"
#include "ltm/reflection/reflect.h"

namespace engram::ltm {

namespace {

/// Max number of instances of one snapshot.
constexpr size_t kMaxToldInstances = 4096;
constexpr const char* kReflectionProvider = "engram";

MemoryId entity_named(const char* core, const char* provider, const char* entity) {
  return MemoryId::from_names({kReflectionMemory, core, provider, entity}).value();
}

idf::Data int64_data(uint64_t number) {
  return idf::Data(static_cast<int64_t>(number));
}

idf::Data text_data(std::string_view text) {
  return idf::Data(std::string(text));
}

idf::Data finding_data(const ReflectionFinding& finding) {
  return idf::Dict{{"kind", text_data(to_string(finding.kind))},
                   {"severity", text_data(to_string(finding.severity))},
                   {"entity", finding.entity.to_data()},
                   {"member", text_data(finding.member)},
                   {"first", to_ns(finding.first)},
                   {"last", to_ns(finding.last)},
                   {"first_snapshot", finding.entity.at(finding.first).to_data()},
                   {"last_snapshot", finding.entity.at(finding.last).to_data()},
                   {"count", int64_data(finding.count)},
                   {"found", text_data(finding.found)},
                   {"expected", text_data(finding.expected)}};
}

idf::Data no_finding_data() {
  return idf::Dict{{"kind", "none"},       {"severity", "note"},   {"entity", ""},
                   {"member", ""},         {"first", int64_t{0}},  {"last", int64_t{0}},
                   {"first_snapshot", ""}, {"last_snapshot", ""},  {"count", int64_t{0}},
                   {"found", "nothing"},   {"expected", "nothing"}};
}

idf::Type finding_type() {
  return idf::Type::object("reflection::Finding", {{"kind", idf::Type::string()},
                                                   {"severity", idf::Type::string()},
                                                   {"entity", idf::Type::memory_link()},
                                                   {"member", idf::Type::string()},
                                                   {"first", idf::Type::time()},
                                                   {"last", idf::Type::time()},
                                                   {"first_snapshot", idf::Type::memory_link()},
                                                   {"last_snapshot", idf::Type::memory_link()},
                                                   {"count", idf::Type::int64()},
                                                   {"found", idf::Type::string()},
                                                   {"expected", idf::Type::string()}});
}

idf::Data entity_data(const EntityReflection& entity) {
  return idf::Dict{
      {"entity", entity.id.to_data()},         {"snapshots", int64_data(entity.snapshots)},
      {"first", to_ns(entity.first)},          {"last", to_ns(entity.last)},
      {"is_periodic", entity.is_periodic},     {"step_s", entity.median_step_s},
      {"missing", int64_data(entity.missing)}, {"gap_s", entity.gap_s},
      {"idle_share", entity.idle_share},       {"longest_idle_s", entity.longest_idle_s}};
}

idf::Type entity_type() {
  return idf::Type::object("reflection::Entity", {{"entity", idf::Type::memory_link()},
                                                  {"snapshots", idf::Type::int64()},
                                                  {"first", idf::Type::time()},
                                                  {"last", idf::Type::time()},
                                                  {"is_periodic", idf::Type::boolean()},
                                                  {"step_s", idf::Type::float64({"s"})},
                                                  {"missing", idf::Type::int64()},
                                                  {"gap_s", idf::Type::float64({"s"})},
                                                  {"idle_share", idf::Type::float64()},
                                                  {"longest_idle_s", idf::Type::float64({"s"})}});
}

idf::Data rate_data(const std::string& skill, const SuccessRate& rate) {
  return idf::Dict{{"skill", text_data(skill)},
                   {"by", text_data(rate.by)},
                   {"name", text_data(rate.name)},
                   {"runs", int64_data(rate.runs)},
                   {"successes", int64_data(rate.successes)},
                   {"failures", int64_data(rate.failures)},
                   {"stops", int64_data(rate.stops)},
                   {"low", rate.low},
                   {"high", rate.high},
                   {"duration_s", rate.mean_duration_s}};
}

idf::Type rate_type() {
  return idf::Type::object("reflection::SuccessRate", {{"skill", idf::Type::string()},
                                                       {"by", idf::Type::string()},
                                                       {"name", idf::Type::string()},
                                                       {"runs", idf::Type::int64()},
                                                       {"successes", idf::Type::int64()},
                                                       {"failures", idf::Type::int64()},
                                                       {"stops", idf::Type::int64()},
                                                       {"low", idf::Type::float64()},
                                                       {"high", idf::Type::float64()},
                                                       {"duration_s", idf::Type::float64({"s"})}});
}

idf::Data chain_data(const FailureChain& chain) {
  idf::List steps;
  for (const std::string& step : chain.steps) steps.emplace_back(step);
  return idf::Dict{{"steps", std::move(steps)}, {"count", int64_data(chain.count)}};
}

idf::Type chain_type() {
  return idf::Type::object(
      "reflection::FailureChain",
      {{"steps", idf::Type::list(idf::Type::string())}, {"count", idf::Type::int64()}});
}

/// One snapshot of several values; nothing where there is none.
void add_snapshot(Commit& commit, const MemoryId& entity, Time time,
                  std::vector<idf::Data> values) {
  if (values.empty()) return;
  Snapshot snapshot{entity, time, {}};
  for (idf::Data& value : values) {
    if (snapshot.instances.size() >= kMaxToldInstances) break;
    InstanceMetadata metadata;
    metadata.created = metadata.sent = metadata.arrived = time;
    metadata.provider = kReflectionProvider;
    snapshot.instances.push_back({std::move(value), std::move(metadata)});
  }
  commit.updates.push_back(std::move(snapshot));
}

}  // namespace

std::vector<std::pair<MemoryId, idf::Type>> reflection_types() {
  return {{entity_named("Findings", kReflectionProvider, "all").parent(), finding_type()},
          {entity_named("Summary", "entities", "all").parent(), entity_type()},
          {entity_named("Summary", "skills", "all").parent(), rate_type()},
          {entity_named("Summary", "chains", "all").parent(), chain_type()}};
}

Commit to_commit(const Reflection& reflection, Time time) {
  std::vector<idf::Data> findings, entities, rates, chains;
  for (const ReflectionFinding& finding : reflection.findings)
    findings.push_back(finding_data(finding));
  if (findings.empty()) findings.push_back(no_finding_data());
  for (const EntityReflection& entity : reflection.entities)
    entities.push_back(entity_data(entity));
  for (const SkillReflection& skill : reflection.skills)
    for (const SuccessRate& rate : skill.rates) rates.push_back(rate_data(skill.skill, rate));
  for (const FailureChain& chain : reflection.chains) chains.push_back(chain_data(chain));
  Commit commit;
  add_snapshot(commit, entity_named("Findings", kReflectionProvider, "all"), time,
               std::move(findings));
  add_snapshot(commit, entity_named("Summary", "entities", "all"), time, std::move(entities));
  add_snapshot(commit, entity_named("Summary", "skills", "all"), time, std::move(rates));
  add_snapshot(commit, entity_named("Summary", "chains", "all"), time, std::move(chains));
  return commit;
}

Status record_reflection(const std::filesystem::path& store, const Reflection& reflection,
                         const Clock& clock) {
  ENGRAM_ASSIGN_OR_RETURN(Recorder recorder, Recorder::open(store, {}, clock));
  for (const auto& [segment, type] : reflection_types())
    ENGRAM_RETURN_IF_ERROR(recorder.declare(segment, type));
  ENGRAM_RETURN_IF_ERROR(recorder.commit(to_commit(reflection, clock())));
  return recorder.close();
}

}  // namespace engram::ltm
