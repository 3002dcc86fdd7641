// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/night_records.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "ltm/core/buffer.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/idf/strict_json.h"

namespace engram::ltm {

namespace {

using RecordJson = nlohmann::ordered_json;

constexpr uint64_t kMinFolderBytes = uint64_t{32} << 10;
constexpr uint64_t kMaxFolderBytes = uint64_t{1} << 20;
constexpr uint64_t kPublishedPerByte = 200;
/// Object, list of entities, an entity, its list of models.
constexpr int kNightLevels = 5;

/// The counts of an entity and their names, which are left out where they are 0.
struct Count {
  const char* name;
  uint64_t NightEntity::*number;
};
constexpr std::array<Count, 8> kCounts{{{"learned", &NightEntity::learned},
                                        {"encoded", &NightEntity::encoded},
                                        {"waiting", &NightEntity::waiting},
                                        {"dropped", &NightEntity::dropped},
                                        {"forgotten", &NightEntity::forgotten},
                                        {"faded", &NightEntity::faded},
                                        {"bytes_before", &NightEntity::bytes_before},
                                        {"bytes_after", &NightEntity::bytes_after}}};

uint64_t published_bytes(const Manifest& manifest) {
  uint64_t sum = 0;
  for (const SegmentInfo& segment : manifest.segments) sum += segment.bytes;
  for (const ModelInfo& model : manifest.models) sum += model.bytes;
  return sum;
}

/// What a manifest has of one entity.
struct Stock {
  uint64_t bytes = 0;
  std::set<int> models;
};

/// What a manifest has of each of the entities.
std::map<MemoryId, Stock> stocks_of(const Manifest& manifest,
                                    const std::vector<NightEntity>& entities) {
  std::map<MemoryId, Stock> stocks;
  for (const NightEntity& entity : entities) {
    Stock& stock = stocks[entity.entity];
    for (const SegmentInfo& segment : manifest.segments)
      if (const SegmentEntity* part = segment.find(entity.entity))
        stock.bytes += part->stored_bytes;
  }
  // Each model once: all of them for each entity would be the square of their number.
  for (const ModelInfo& model : manifest.models)
    if (const auto stock = stocks.find(model.entity); stock != stocks.end()) {
      stock->second.bytes += model.bytes;
      stock->second.models.insert(model.version);
    }
  return stocks;
}

double rounded(double psnr_db) {
  return std::round(psnr_db * 100) / 100;
}

RecordJson to_json(const NightEntity& entity) {
  RecordJson json{{"id", entity.entity.to_string()}};
  if (!entity.skipped.empty()) json["skipped"] = entity.skipped;
  for (const Count& count : kCounts)
    if (entity.*count.number != 0) json[count.name] = entity.*count.number;
  // What is infinite or not known is left out.
  if (entity.psnr_db && std::isfinite(*entity.psnr_db)) json["psnr"] = rounded(*entity.psnr_db);
  if (entity.min_psnr_db && std::isfinite(*entity.min_psnr_db))
    json["min_psnr"] = rounded(*entity.min_psnr_db);
  if (!entity.models_added.empty()) json["models_added"] = entity.models_added;
  if (!entity.models_removed.empty()) json["models_removed"] = entity.models_removed;
  return json;
}

RecordJson to_json(const NightRecord& record) {
  RecordJson entities = RecordJson::array();
  for (const NightEntity& entity : record.entities) entities.push_back(to_json(entity));
  return {{"work", to_string(record.work)},      {"began_ns", to_ns(record.began)},
          {"ended_ns", to_ns(record.ended)},     {"failure", record.failure},
          {"bytes_before", record.bytes_before}, {"bytes_after", record.bytes_after},
          {"entities", std::move(entities)}};
}

/// Reads members of an object. What is there and of another kind is an error of the whole.
class Members {
 public:
  explicit Members(const RecordJson& json) : json_(json), is_good_(json.is_object()) {}

  void read(const char* name, uint64_t& to) {
    if (const RecordJson* found = find(name)) {
      if (check(found->is_number_unsigned())) to = found->get<uint64_t>();
    }
  }
  void read(const char* name, std::string& to) {
    if (const RecordJson* found = find(name)) {
      if (check(found->is_string())) to = found->get<std::string>();
    }
  }
  void read(const char* name, std::optional<double>& to) {
    if (const RecordJson* found = find(name)) {
      if (check(found->is_number())) to = found->get<double>();
    }
  }
  void read(const char* name, Time& to) {
    const RecordJson* const found = find(name);
    if (check(found != nullptr && found->is_number_integer()))
      to = time_from_ns(found->get<int64_t>());
  }
  void read(const char* name, std::vector<int>& to) {
    const RecordJson* const found = find(name);
    if (found == nullptr || !check(found->is_array())) return;
    for (const RecordJson& one : *found)
      if (check(one.is_number_integer())) to.push_back(one.get<int>());
  }

  [[nodiscard]] const RecordJson* find(const char* name) const {
    if (!json_.is_object()) return nullptr;
    const auto found = json_.find(name);
    return found == json_.end() ? nullptr : &*found;
  }
  [[nodiscard]] bool is_good() const { return is_good_; }
  bool check(bool is_good) {
    is_good_ = is_good_ && is_good;
    return is_good;
  }

 private:
  const RecordJson& json_;
  bool is_good_;
};

std::optional<NightEntity> night_entity_from(const RecordJson& json) {
  Members members(json);
  NightEntity entity;
  std::string id;
  members.read("id", id);
  const auto parsed = MemoryId::parse(id);
  if (!members.is_good() || !parsed.ok() || !parsed->is_entity()) return std::nullopt;
  entity.entity = *parsed;
  members.read("skipped", entity.skipped);
  for (const Count& count : kCounts) members.read(count.name, entity.*count.number);
  members.read("psnr", entity.psnr_db);
  members.read("min_psnr", entity.min_psnr_db);
  members.read("models_added", entity.models_added);
  members.read("models_removed", entity.models_removed);
  return members.is_good() ? std::optional(std::move(entity)) : std::nullopt;
}

std::optional<NightRecord> record_from(std::string_view text) {
  const auto json = idf::parse_json(text, kNightLevels);
  if (!json.ok()) return std::nullopt;
  Members members(*json);
  NightRecord record;
  std::string work;
  members.read("work", work);
  if (work == to_string(NightWork::kForget))
    record.work = NightWork::kForget;
  else
    members.check(work == to_string(NightWork::kConsolidate));
  members.read("began_ns", record.began);
  members.read("ended_ns", record.ended);
  members.read("failure", record.failure);
  members.read("bytes_before", record.bytes_before);
  members.read("bytes_after", record.bytes_after);
  const RecordJson* const entities = members.find("entities");
  if (!members.check(entities != nullptr && entities->is_array())) return std::nullopt;
  for (const RecordJson& one : *entities) {
    auto entity = night_entity_from(one);
    if (!members.check(entity.has_value())) return std::nullopt;
    record.entities.push_back(*std::move(entity));
  }
  return members.is_good() ? std::optional(std::move(record)) : std::nullopt;
}

struct NightFile {
  std::filesystem::path path;
  uint64_t bytes = 0;
};

/// The records by name, which is by time, the newest first.
Result<std::vector<NightFile>> night_files(const std::filesystem::path& store) {
  std::vector<NightFile> files;
  const auto folder = store / kNightsFolder;
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    // Another process may remove it meanwhile.
    std::error_code gone;
    const uint64_t bytes = entry->file_size(gone);
    if (!gone && entry->path().extension() == ".json") files.push_back({entry->path(), bytes});
  }
  if (error) return unavailable("'{}': {}", printable(folder.string()), error.message());
  std::ranges::sort(files, std::greater<>(), &NightFile::path);
  return files;
}

Status remove_oldest(const std::filesystem::path& store, uint64_t max_bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto files, night_files(store));
  uint64_t sum = 0;
  for (size_t i = 0; i < files.size(); ++i) {
    sum += files[i].bytes;
    if (i > 0 && sum > max_bytes) ENGRAM_RETURN_IF_ERROR(remove_file(files[i].path));
  }
  return {};
}

/// Adds what another process, or a later step of the same night, did.
void add_entity(NightEntity later, NightRecord& night) {
  const auto found =
      std::ranges::lower_bound(night.entities, later.entity, {}, &NightEntity::entity);
  if (found == night.entities.end() || found->entity != later.entity) {
    night.entities.insert(found, std::move(later));
    return;
  }
  for (const Count& count : kCounts)
    if (count.number != &NightEntity::bytes_before && count.number != &NightEntity::bytes_after)
      (*found).*count.number += later.*count.number;
  found->bytes_after = later.bytes_after;
  if (found->skipped.empty()) found->skipped = std::move(later.skipped);
  if (!found->psnr_db) found->psnr_db = later.psnr_db;
  if (!found->min_psnr_db) found->min_psnr_db = later.min_psnr_db;
  std::ranges::move(later.models_added, std::back_inserter(found->models_added));
  std::ranges::move(later.models_removed, std::back_inserter(found->models_removed));
}

/// Records of one night, the one that ended first in front, as one.
NightRecord united(std::vector<NightRecord> parts) {
  std::ranges::sort(parts, {}, &NightRecord::ended);
  NightRecord night = parts.front();
  night.entities.clear();
  for (NightRecord& part : parts) {
    night.ended = part.ended;
    night.bytes_after = part.bytes_after;
    if (night.failure.empty()) night.failure = part.failure;
    for (NightEntity& entity : part.entities) add_entity(std::move(entity), night);
  }
  return night;
}

}  // namespace

std::string_view to_string(NightWork work) {
  return work == NightWork::kForget ? "forget" : "consolidate";
}

Result<NightAccount> NightAccount::open(const std::filesystem::path& store, NightWork work,
                                        Time began) {
  ENGRAM_ASSIGN_OR_RETURN(Manifest manifest, read_manifest(store));
  NightRecord record{.work = work,
                     .began = began,
                     .ended = began,
                     .failure = {},
                     .bytes_before = published_bytes(manifest),
                     .bytes_after = 0,
                     .entities = {}};
  return NightAccount(store, std::move(manifest), std::move(record));
}

NightEntity& NightAccount::of(const MemoryId& entity) {
  auto& all = record_.entities;
  const auto found = std::ranges::lower_bound(all, entity, {}, &NightEntity::entity);
  if (found != all.end() && found->entity == entity) return *found;
  return *all.insert(found, NightEntity{.entity = entity});
}

Status NightAccount::write(Time ended, const Status& failure) {
  ENGRAM_ASSIGN_OR_RETURN(const Manifest after, read_manifest(store_));
  record_.ended = ended;
  record_.failure = failure.message();
  record_.bytes_after = published_bytes(after);
  const auto all_old = stocks_of(before_, record_.entities);
  const auto all_now = stocks_of(after, record_.entities);
  for (NightEntity& entity : record_.entities) {
    const Stock& old = all_old.at(entity.entity);
    const Stock& now = all_now.at(entity.entity);
    entity.bytes_before = old.bytes;
    entity.bytes_after = now.bytes;
    entity.models_added.clear();
    entity.models_removed.clear();
    std::ranges::set_difference(now.models, old.models, std::back_inserter(entity.models_added));
    std::ranges::set_difference(old.models, now.models, std::back_inserter(entity.models_removed));
  }
  std::error_code error;
  std::filesystem::create_directories(store_ / kNightsFolder, error);
  if (error) return unavailable("'{}': {}", (store_ / kNightsFolder).string(), error.message());
  // Names have equal lengths until the year 2286, so that they are in the order of time.
  for (int number = 1; file_.empty(); ++number) {
    const auto name = fmt::format("{}/{:019}-{}-{}.json", kNightsFolder, to_ns(record_.began),
                                  ::getpid(), number);
    if (!std::filesystem::exists(store_ / name, error)) file_ = store_ / name;
  }
  ENGRAM_RETURN_IF_ERROR(replace_file(file_, as_bytes(to_json(record_).dump() + "\n")));
  return remove_oldest(store_, std::clamp(published_bytes(after) / kPublishedPerByte,
                                          kMinFolderBytes, kMaxFolderBytes));
}

Result<NightRecords> read_nights(const std::filesystem::path& store, size_t max) {
  ENGRAM_ASSIGN_OR_RETURN(const auto files, night_files(store));
  std::map<std::pair<Time, NightWork>, std::vector<NightRecord>, std::greater<>> nights;
  NightRecords found;
  for (const NightFile& file : files) {
    // A file that a night writes never grows beyond what all may take, but for the newest one.
    constexpr uint64_t kMaxRecordBytes = uint64_t{64} << 20;
    const auto bytes = file.bytes <= kMaxRecordBytes ? read_file(file.path)
                                                     : Result<Buffer>(data_loss("too large"));
    if (bytes.status().code() == StatusCode::kNotFound) continue;
    auto record = bytes.ok() ? record_from(as_text(bytes->bytes())) : std::nullopt;
    if (!record) {
      ++found.unreadable;
      continue;
    }
    const std::pair key(record->began, record->work);
    found.has_more = nights.size() == max && !nights.contains(key);
    if (found.has_more) break;
    nights[key].push_back(*std::move(record));
  }
  for (auto& [key, parts] : nights) found.nights.push_back(united(std::move(parts)));
  return found;
}

}  // namespace engram::ltm
