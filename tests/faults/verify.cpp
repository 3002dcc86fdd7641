// SPDX-License-Identifier: Apache-2.0
#include "tests/faults/verify.h"

#include <algorithm>
#include <map>
#include <set>

#include "ltm/store/store_check.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm::faults {

namespace {

constexpr int64_t kLastVersion = 1;
constexpr size_t kMaxProblems = 10;

/// What must be there: the least version of each snapshot.
struct Promise {
  std::map<std::pair<int, int64_t>, int64_t> versions;
  std::vector<int> declared;
  std::vector<int> dropping;
  std::set<std::pair<int, int64_t>> forgetting;  ///< Entity and index: may be gone.
  std::set<std::pair<int, int64_t>> forgotten;   ///< Must be.

  explicit Promise(const std::vector<Told>& told) {
    for (const Told& each : told) {
      if (each.kind == Told::kDeclared) declared.push_back(each.number);
      if (each.kind == Told::kForgetting) forgetting.emplace(each.number, each.index);
      if (each.kind == Told::kForgotten) forgotten.emplace(each.number, each.index);
      if (each.kind == Told::kDropping) dropping.push_back(each.number);
      if (each.kind != Told::kStored) continue;
      int64_t& version = versions[{each.number, each.index}];
      version = std::max(version, each.version);
    }
  }
};

Status check_latent(StoreReader& reader, const MemoryId& entity, const SnapshotEntry& entry,
                    int64_t index) {
  ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot found, reader.read_latent(entity, entry));
  const LatentSnapshot needed = example_latent(index, found.model_version);
  const bool is_equal = found.instances.size() == 1 &&
                        std::ranges::equal(found.instances[0].latent.code.bytes(),
                                           needed.instances[0].latent.code.bytes()) &&
                        found.instances[0].latent.remainder == needed.instances[0].latent.remainder;
  return is_equal ? Status() : data_loss("its latents are others than were published");
}

Status check_snapshot(StoreReader& reader, int number, int64_t index, int64_t version,
                      bool may_be_latent) {
  const MemoryId entity = session_entity(number);
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(example_time(index)));
  if (!entry || entry->time != example_time(index)) return not_found("it is not there");
  if (!entry->recorded)
    return may_be_latent ? check_latent(reader, entity, *entry, index)
                         : not_found("its recorded form is gone");
  ENGRAM_ASSIGN_OR_RETURN(const Snapshot found, reader.read_recorded(entity, *entry));
  for (int64_t later = version; later <= kLastVersion; ++later)
    if (found == session_snapshot(number, index, later)) return {};
  return data_loss("its content is another than was stored");
}

}  // namespace

std::vector<std::string> problems_of_reading(const std::filesystem::path& store,
                                             const std::vector<Told>& told) {
  const Promise promise(told);
  if (promise.versions.empty() && promise.declared.empty() && is_store_absent(store)) return {};
  const auto reader = StoreReader::open(store);
  if (!reader.ok()) {
    // Before the first snapshot a store may still be in the making.
    if (promise.versions.empty() && promise.declared.empty()) return {};
    return {"the store does not open: " + reader.status().to_string()};
  }
  std::vector<std::string> problems;
  if (const uint64_t damaged = (*reader)->damaged_places(); damaged > 0)
    problems.push_back(fmt::format("{} damaged places", damaged));
  for (const auto& [key, version] : promise.versions) {
    const bool may_be_latent =
        std::ranges::find(promise.dropping, key.first) != promise.dropping.end();
    const Status status = check_snapshot(**reader, key.first, key.second, version, may_be_latent);
    if (promise.forgotten.contains(key)) {
      if (status.code() == StatusCode::kNotFound) continue;
      problems.push_back(fmt::format("entity {}, snapshot {}: is there, and was forgotten: {}",
                                     key.first, key.second, status.to_string()));
    } else if (!status.ok() && !(promise.forgetting.contains(key) &&
                                 status.code() == StatusCode::kNotFound))
      problems.push_back(fmt::format("entity {}, snapshot {}, version {}: {}", key.first,
                                     key.second, version, status.to_string()));
    if (problems.size() >= kMaxProblems) break;
  }
  for (const int number : promise.declared)
    if ((*reader)->manifest().types.find(declared_segment(number)) == nullptr)
      problems.push_back(fmt::format("type {} is not there", number));
  return problems;
}

namespace {

/// What `engram check` would call a fault.
std::vector<std::string> faults_of(const std::filesystem::path& store) {
  const auto report = check_store(store, {});
  if (!report.ok()) return {report.status().to_string()};
  std::vector<std::string> faults;
  for (const Finding& finding : report->findings)
    if (finding.severity == Severity::kFault)
      faults.push_back(fmt::format("{}: {}: {}", finding.file, finding.object, finding.what));
  return faults;
}

}  // namespace

std::vector<std::string> problems_of(const std::filesystem::path& store,
                                     const std::vector<Told>& told) {
  std::vector<std::string> problems = problems_of_reading(store, told);
  if (!problems.empty() || is_store_absent(store)) return problems;
  if (read_manifest(store).status().code() == StatusCode::kNotFound) return problems;
  {
    auto writer = StoreWriter::open(store, {.min_free_bytes = 0});
    if (!writer.ok()) return {"no writer takes it over: " + writer.status().to_string()};
    if ((*writer)->lost_frames() > 0) problems.push_back("the new writer found lost frames");
    if (const Status sealed = (*writer)->seal(); !sealed.ok())
      problems.push_back("the new writer cannot seal it: " + sealed.to_string());
  }
  for (const std::string& problem : problems_of_reading(store, told))
    problems.push_back("taken over: " + problem);
  for (const std::string& problem : faults_of(store)) problems.push_back("check: " + problem);
  return problems;
}

}  // namespace engram::ltm::faults
