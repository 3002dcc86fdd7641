// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/manifest.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <random>

#include "ltm/core/file.h"
#include "ltm/idf/json.h"
#include "ltm/store/checksum.h"
#include "ltm/store/packed_entities.h"

namespace engram::ltm {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kManifestFile = "MANIFEST.json";
constexpr const char* kManifestLock = "MANIFEST.lock";
constexpr const char* kEntityBlocks = "entity_blocks";
/// That of stores of format 2: all of them in one.
constexpr const char* kPackedEntities = "packed_entities";
constexpr std::string_view kUnfinishedManifest = "MANIFEST.json.new";
constexpr std::array<std::string_view, 4> kFolders{"journal", "segments", "models", "tmp"};

/// Writes a checksum as text, because JSON numbers in other programs carry only 53 bits.
std::string to_hex(uint64_t value) {
  return fmt::format("{:016x}", value);
}

uint64_t from_hex(const std::string& text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size())
    throw std::invalid_argument("'" + text + "' is no hexadecimal checksum");
  return value;
}

MemoryId entity_from(const Json& json) {
  const auto id = MemoryId::parse(json.get<std::string>());
  if (!id.ok()) throw std::invalid_argument(id.status().message());
  if (!id->is_entity()) throw std::invalid_argument("'" + id->to_string() + "' is no entity");
  return *id;
}

/// Reads a file name. Names must be relative to the store and must not leave it.
std::string file_from(const Json& json) {
  auto name = json.get<std::string>();
  const std::filesystem::path path(name);
  if (path.is_absolute() || std::ranges::find(path, "..") != path.end())
    throw std::invalid_argument("file '" + name + "' lies outside of the store");
  return name;
}

Json to_json(const LatentSums& sums) {
  return {{"model_version", sums.model_version},
          {"image_rows", sums.image_rows},
          {"psnr_db", sums.psnr_db},
          {"image_mse", sums.image_mse},
          {"number_rows", sums.number_rows},
          {"number_mse", sums.number_mse}};
}

LatentSums latent_from(const Json& json) {
  return {json.at("model_version"), json.at("image_rows"),  json.at("psnr_db"),
          json.at("image_mse"),     json.at("number_rows"), json.at("number_mse")};
}

Json to_json(const SegmentEntity& entity, SegmentKind kind) {
  Json json{{"id", entity.id.to_string()},
            {"snapshots", entity.snapshots},
            {"rows", entity.rows},
            {"first", to_ns(entity.first)},
            {"last", to_ns(entity.last)},
            {"raw_bytes", entity.raw_bytes},
            {"stored_bytes", entity.stored_bytes},
            {"dropped", entity.dropped},
            {"dropped_bytes", entity.dropped_bytes}};
  if (kind == SegmentKind::kLatent) json["latent"] = to_json(entity.latent);
  if (entity.augmented > 0) json["augmented"] = entity.augmented;
  return json;
}

SegmentEntity segment_entity_from(const Json& json) {
  SegmentEntity entity{entity_from(json.at("id")),
                       json.at("snapshots"),
                       json.at("rows"),
                       time_from_ns(json.at("first")),
                       time_from_ns(json.at("last")),
                       json.at("raw_bytes"),
                       json.at("stored_bytes"),
                       json.at("dropped"),
                       json.at("dropped_bytes"),
                       {}};
  if (json.contains("latent")) entity.latent = latent_from(json.at("latent"));
  entity.augmented = json.value("augmented", uint64_t{0});
  return entity;
}

/// A list of many entities is packed, because JSON takes 240 bytes for each, and seconds to read.
bool is_packed(const SegmentInfo& segment) {
  constexpr size_t kMaxListed = 1000;
  return segment.entities.blocks() != nullptr ||
         (segment.kind == SegmentKind::kRecorded && segment.entities.size() > kMaxListed);
}

Json blocks_to_json(const SegmentEntities& entities) {
  // What nobody changed is written as it was read.
  std::vector<EntityBlock> made;
  if (entities.blocks() == nullptr) {
    auto packed = pack_in_blocks({entities.begin(), entities.end()});
    if (!packed.ok()) throw std::invalid_argument(packed.status().message());
    made = *std::move(packed);
  }
  Json blocks = Json::array();
  for (const EntityBlock& block : entities.blocks() == nullptr ? made : *entities.blocks())
    blocks.push_back({{"first", block.first.to_string()},
                      {"count", block.count},
                      {kPackedEntities, block.packed}});
  return blocks;
}

SegmentEntities entities_from(const Json& json) {
  if (json.contains(kEntityBlocks)) {
    std::vector<EntityBlock> blocks;
    for (const Json& block : json.at(kEntityBlocks))
      blocks.push_back(
          {entity_from(block.at("first")), block.at("count"), block.at(kPackedEntities)});
    auto entities = SegmentEntities::from_blocks(std::move(blocks));
    if (!entities.ok()) throw std::invalid_argument(entities.status().message());
    return *std::move(entities);
  }
  std::vector<SegmentEntity> entities;
  for (const Json& entity : json.at("entities")) entities.push_back(segment_entity_from(entity));
  if (json.contains(kPackedEntities)) {
    auto packed = unpack_entities(json.at(kPackedEntities).get_ref<const std::string&>());
    if (!packed.ok()) throw std::invalid_argument(packed.status().message());
    std::ranges::move(*packed, std::back_inserter(entities));
  }
  return entities;
}

Json to_json(const SegmentInfo& segment) {
  Json entities = Json::array();
  if (!is_packed(segment))
    for (const SegmentEntity& entity : segment.entities)
      entities.push_back(to_json(entity, segment.kind));
  Json json{{"file", segment.file},
            {"kind", segment.kind == SegmentKind::kLatent ? "latent" : "recorded"},
            {"bytes", segment.bytes},
            {"checksum", to_hex(segment.checksum)},
            {"last_journal", segment.last_journal},
            {"entities", std::move(entities)}};
  if (is_packed(segment)) json[kEntityBlocks] = blocks_to_json(segment.entities);
  return json;
}

void sort_entities(SegmentInfo& segment) {
  // Packed ones are in order.
  if (segment.entities.blocks() == nullptr &&
      !std::ranges::is_sorted(segment.entities, {}, &SegmentEntity::id))
    std::ranges::stable_sort(segment.entities.edit(), {}, &SegmentEntity::id);
}

SegmentInfo segment_from(const Json& json) {
  SegmentInfo segment;
  segment.file = file_from(json.at("file"));
  const auto kind = json.at("kind").get<std::string>();
  if (kind != "latent" && kind != "recorded")
    throw std::invalid_argument("unknown kind of segment '" + kind + "'");
  segment.kind = kind == "latent" ? SegmentKind::kLatent : SegmentKind::kRecorded;
  segment.bytes = json.at("bytes");
  segment.checksum = from_hex(json.at("checksum"));
  segment.last_journal = json.value("last_journal", uint64_t{0});
  segment.entities = entities_from(json);
  if (segment.entities.blocks() != nullptr && segment.kind != SegmentKind::kRecorded)
    throw std::invalid_argument("segment '" + segment.file + "' is packed, but not recorded");
  sort_entities(segment);
  return segment;
}

Json to_json(const ModelInfo& model) {
  return {{"entity", model.entity.to_string()},
          {"version", model.version},
          {"file", model.file},
          {"bytes", model.bytes},
          {"checksum", to_hex(model.checksum)}};
}

ModelInfo model_from(const Json& json) {
  return {entity_from(json.at("entity")), json.at("version"), file_from(json.at("file")),
          json.at("bytes"), from_hex(json.at("checksum"))};
}

Json to_json(const SegmentTypes& types) {
  auto json = idf::to_json(types.to_data());
  if (!json.ok()) throw std::invalid_argument(json.status().message());
  return std::move(json).value();
}

SegmentTypes types_from(const Json& json) {
  const auto data = idf::from_json(json);
  if (!data.ok()) throw std::invalid_argument(data.status().message());
  auto types = SegmentTypes::from_data(*data);
  if (!types.ok()) throw std::invalid_argument(types.status().message());
  return std::move(types).value();
}

Json to_json(const std::map<MemoryId, ForgottenSums>& forgotten) {
  Json json = Json::object();
  for (const auto& [entity, sums] : forgotten)
    json[entity.to_string()] = {{"snapshots", sums.snapshots},
                                {"raw_bytes", sums.raw_bytes},
                                {"dropped", sums.dropped},
                                {"dropped_bytes", sums.dropped_bytes}};
  return json;
}

Json to_json(const std::map<MemoryId, DropReasons>& dropped_by) {
  Json json = Json::object();
  for (const auto& [entity, reasons] : dropped_by) json[entity.to_string()] = reasons;
  return json;
}

std::map<MemoryId, DropReasons> dropped_by_from(const Json& json) {
  std::map<MemoryId, DropReasons> dropped_by;
  for (const auto& [entity, reasons] : json.items())
    dropped_by[entity_from(entity)] = reasons.get<DropReasons>();
  return dropped_by;
}

std::map<MemoryId, ForgottenSums> forgotten_from(const Json& json) {
  std::map<MemoryId, ForgottenSums> forgotten;
  for (const auto& [entity, sums] : json.items())
    forgotten[entity_from(entity)] = {sums.at("snapshots"), sums.at("raw_bytes"),
                                      sums.at("dropped"), sums.at("dropped_bytes")};
  return forgotten;
}

Json to_json(const Manifest& manifest) {
  Json segments = Json::array();
  for (const SegmentInfo& segment : manifest.segments) segments.push_back(to_json(segment));
  Json models = Json::array();
  for (const ModelInfo& model : manifest.models) models.push_back(to_json(model));
  return {{"format", "engram store"},
          {"format_version", manifest.format_version()},
          {"store_id", manifest.store_id},
          {"generation", manifest.generation},
          {"next_segment", manifest.next_segment},
          {"first_journal", manifest.first_journal},
          {"damaged", manifest.damaged},
          {"types", to_json(manifest.types)},
          {"forgotten", to_json(manifest.forgotten)},
          {"dropped_by", to_json(manifest.dropped_by)},
          {"segments", std::move(segments)},
          {"models", std::move(models)}};
}

Manifest manifest_from(const Json& json) {
  Manifest manifest{json.at("store_id"),
                    json.at("generation"),
                    json.at("next_segment"),
                    json.at("first_journal"),
                    json.at("damaged"),
                    {},
                    {},
                    {},
                    {},
                    {}};
  if (json.contains("types")) manifest.types = types_from(json.at("types"));
  if (json.contains("dropped_by")) manifest.dropped_by = dropped_by_from(json.at("dropped_by"));
  if (json.contains("forgotten")) manifest.forgotten = forgotten_from(json.at("forgotten"));
  for (const Json& segment : json.at("segments"))
    manifest.segments.push_back(segment_from(segment));
  for (const Json& model : json.at("models")) manifest.models.push_back(model_from(model));
  return manifest;
}

/// The text after the digits of the manifest's own checksum, which is its last member.
constexpr std::string_view kEnd = "\"\n}\n";
constexpr size_t kDigits = 16;

std::string checksum_of_text(std::string_view text) {
  return to_hex(checksum(as_bytes(text.substr(0, text.size() - kEnd.size() - kDigits))));
}

/// The manifest as text, followed by the checksum of all text before it.
std::string to_text(const Manifest& manifest) {
  Json json = to_json(manifest);
  json["checksum"] = std::string(kDigits, '0');
  std::string text = json.dump(1) + "\n";
  text.replace(text.size() - kEnd.size() - kDigits, kDigits, checksum_of_text(text));
  return text;
}

/// Verifies the checksum. Manifests of earlier programs have none and end with a list.
void check_text(std::string_view text, const Json& json) {
  if (!json.contains("checksum") && !text.ends_with(kEnd)) return;
  if (!text.ends_with(kEnd) || text.size() < kEnd.size() + kDigits ||
      text.substr(text.size() - kEnd.size() - kDigits, kDigits) != checksum_of_text(text))
    throw std::invalid_argument("it fails its checksum");
}

Status write_manifest(const std::filesystem::path& store, const Manifest& manifest) {
  try {
    const std::string text = to_text(manifest);
    return replace_file(store / kManifestFile, as_bytes(text));
  } catch (const std::exception& error) {
    return invalid_argument("store '{}': {} cannot be written: {}", store.string(), kManifestFile,
                            error.what());
  }
}

std::string random_store_id() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

/// Waits for the lock of a manifest, which is released with the file.
Result<File> lock_manifest(const std::filesystem::path& store) {
  // Read before locking, because taking the lock creates a file, even in a directory that is not a
  // store.
  if (const auto manifest = read_manifest(store); !manifest.ok()) return manifest.status();
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(store / kManifestLock, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, lock.lock(true));
  ENGRAM_CHECK(is_locked, "a waiting lock returned without one");
  return lock;
}

}  // namespace

int Manifest::format_version() const {
  return std::ranges::any_of(segments, is_packed) ? kStoreFormatVersion : kFirstStoreFormatVersion;
}

Status Manifest::verify_entities() const {
  for (const SegmentInfo& segment : segments)
    if (const Status status = segment.entities.verify(); !status.ok())
      return status.with_context("segment '" + segment.file + "'");
  return {};
}

const ModelInfo* Manifest::newest_model(const MemoryId& entity) const {
  const ModelInfo* newest = nullptr;
  for (const ModelInfo& model : models)
    if (model.entity == entity && (newest == nullptr || model.version > newest->version))
      newest = &model;
  return newest;
}

std::string ModelInfo::name() const {
  return fmt::format("{} v{}", entity.to_string(), version);
}

Result<Manifest> read_manifest(const std::filesystem::path& store) {
  std::error_code error;
  if (!std::filesystem::exists(store, error))
    return not_found("store '{}' does not exist", store.string());
  if (!std::filesystem::is_directory(store, error) ||
      !std::filesystem::exists(store / kManifestFile, error))
    return not_found("'{}' is no store: needs a directory with {}", store.string(), kManifestFile);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer content, read_file(store / kManifestFile));
  try {
    const Json json = Json::parse(as_text(content.bytes()));
    if (json.at("format") != "engram store")
      return data_loss("store '{}': {} is not an engram store's", store.string(), kManifestFile);
    if (const int version = json.at("format_version"); version > kStoreFormatVersion)
      return failed_precondition("store '{}': has format {}, this program reads up to {}",
                                 store.string(), version, kStoreFormatVersion);
    check_text(as_text(content.bytes()), json);
    return manifest_from(json);
  } catch (const std::exception& problem) {
    return data_loss("store '{}': {} is broken: {}", store.string(), kManifestFile, problem.what());
  }
}

Result<uint64_t> read_generation(const std::filesystem::path& store) {
  // Manifests are replaced as a whole, and begin with a few short members.
  constexpr size_t kHead = 512;
  constexpr std::string_view kKey = "\n \"generation\": ";
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(store / kManifestFile, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  std::string head(std::min<uint64_t>(size, kHead), '\0');
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, std::as_writable_bytes(std::span(head))));
  const size_t key = head.find(kKey);
  uint64_t generation = 0;
  if (key != std::string::npos) {
    const char* const begin = head.data() + key + kKey.size();
    const auto [end, error] = std::from_chars(begin, head.data() + head.size(), generation);
    if (error == std::errc() && end != head.data() + head.size() && *end == ',') return generation;
  }
  // Somebody else wrote it in another form.
  ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store));
  return manifest.generation;
}

Status edit_manifest(const std::filesystem::path& store,
                     const std::function<Status(Manifest&)>& change) {
  ENGRAM_ASSIGN_OR_RETURN(const File lock, lock_manifest(store));
  ENGRAM_ASSIGN_OR_RETURN(Manifest manifest, read_manifest(store));
  ENGRAM_RETURN_IF_ERROR(change(manifest));
  for (SegmentInfo& segment : manifest.segments) sort_entities(segment);
  ++manifest.generation;
  return write_manifest(store, manifest);
}

Status under_manifest_lock(const std::filesystem::path& store,
                           const std::function<Status(const Manifest&)>& act) {
  ENGRAM_ASSIGN_OR_RETURN(const File lock, lock_manifest(store));
  ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store));
  return act(manifest);
}

bool is_store_absent(const std::filesystem::path& store) {
  std::error_code error;
  if (!std::filesystem::exists(store, error)) return true;
  if (!std::filesystem::is_directory(store, error)) return false;
  for (const auto& entry : std::filesystem::directory_iterator(store, error)) {
    const std::string name = entry.path().filename().string();
    // A killed create_store leaves only empty folders of a store and an unfinished manifest.
    const bool is_leftover =
        name == kUnfinishedManifest || (std::ranges::find(kFolders, name) != kFolders.end() &&
                                        std::filesystem::is_empty(entry.path(), error));
    if (!is_leftover) return false;
  }
  return !error;
}

Status create_store(const std::filesystem::path& store) {
  if (!is_store_absent(store))
    return already_exists("'{}': is no empty directory, cannot make a store there", store.string());
  for (const std::string_view folder : kFolders)
    ENGRAM_RETURN_IF_ERROR(make_directories(store / folder));
  Manifest manifest;
  manifest.store_id = random_store_id();
  ENGRAM_RETURN_IF_ERROR(write_manifest(store, manifest));
  // Sync the parent directory too; otherwise a power cut could lose the new store's directory entry
  // and with it all data.
  return sync_directory(std::filesystem::absolute(store).parent_path());
}

}  // namespace engram::ltm
