// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_index.h"

#include <algorithm>
#include <map>
#include <set>

#include "ltm/core/byte_fields.h"
#include "ltm/core/file.h"
#include "ltm/store/checksum.h"
#include "ltm/store/publish.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kIndexMagic = "ENGRIDX1";
/// Magic, checksum of the segment, checksum of all before it.
constexpr size_t kIndexFrame = 24;
/// Larger files are no indexes of ours: a code takes a hundredth of a snapshot.
constexpr uint64_t kMaxIndexBytes = uint64_t{1} << 31;

/// "000012" of "segments/000012.h5".
std::string stem_of(const std::string& segment_file) {
  return std::filesystem::path(segment_file).stem().string();
}

std::vector<std::byte> framed(uint64_t owner, std::span<const std::byte> content) {
  std::vector<std::byte> bytes;
  bytes.reserve(content.size() + kIndexFrame);
  FieldWriter fields(bytes);
  fields.bytes(as_bytes(kIndexMagic));
  fields.number(owner);
  fields.bytes(content);
  fields.number(checksum(bytes));
  return bytes;
}

/// The content between the frame. Errors: kNotFound if it belongs to another owner; kDataLoss.
Result<Buffer> unframed(const std::filesystem::path& file, std::optional<uint64_t> owner) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file, error);
  if (error) return not_found("'{}': there is no such index", file.string());
  if (size < kIndexFrame || size > kMaxIndexBytes)
    return data_loss("'{}': has {} bytes, which no index has", file.string(), size);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  FieldReader head(bytes.bytes());
  const bool is_index = as_text(head.bytes(kIndexMagic.size())) == kIndexMagic;
  const auto found = head.number<uint64_t>();
  const auto content = head.bytes(bytes.size() < kIndexFrame ? 0 : bytes.size() - kIndexFrame);
  const auto sum = head.number<uint64_t>();
  if (!head.is_whole() || !is_index ||
      sum != checksum(bytes.bytes().first(bytes.size() - sizeof(uint64_t))))
    return data_loss("'{}': its checksum does not hold", file.string());
  if (owner && found != *owner)
    return not_found("'{}': belongs to an earlier segment of this name", file.string());
  return Buffer::copy(content);
}

/// What an index of an entity belongs to: how many of its snapshots had been forgotten.
uint64_t forgotten_of(const Manifest& manifest, const MemoryId& entity) {
  const auto found = manifest.forgotten.find(entity);
  return found == manifest.forgotten.end() ? 0 : found->second.snapshots;
}

Status write_index(const std::filesystem::path& store, const std::string& name, uint64_t owner,
                   std::span<const std::byte> content) {
  ENGRAM_RETURN_IF_ERROR(make_directories(store / kIndexFolder));
  return replace_file(store / name, framed(owner, content));
}

std::vector<std::string> listed_indexes(const std::filesystem::path& store) {
  std::vector<std::string> names;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(store / kIndexFolder, missing))
    names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

bool is_of_segment(const std::string& name) {
  const size_t dot = name.find('.');
  return dot != std::string::npos && dot > 0 && name.find('.', dot + 1) == std::string::npos &&
         name.find_first_not_of("0123456789") == dot;
}

/// Whether it is the index of any entity: four names and a kind.
bool is_of_entity(const std::string& name) {
  return std::ranges::count(name, '.') == MemoryId::kNameLevels && !name.ends_with(".new");
}

}  // namespace

std::string segment_index_name(const std::string& segment_file, std::string_view kind) {
  return fmt::format("{}/{}.{}", kIndexFolder, stem_of(segment_file), kind);
}

std::string entity_index_name(const MemoryId& entity, std::string_view kind) {
  return fmt::format("{}/{}{}", kIndexFolder, entity_file_prefix(entity), kind);
}

Result<Buffer> read_segment_index(const std::filesystem::path& store, const SegmentInfo& segment,
                                  std::string_view kind) {
  return unframed(store / segment_index_name(segment.file, kind), segment.checksum);
}

Status edit_segment_index(const std::filesystem::path& store, const SegmentInfo& segment,
                          std::string_view kind, const EditIndex& edit) {
  return under_manifest_lock(store, [&](const Manifest& manifest) -> Status {
    const auto found = std::ranges::find(manifest.segments, segment.file, &SegmentInfo::file);
    if (found == manifest.segments.end() || found->checksum != segment.checksum)
      return not_found("store '{}': segment '{}' is there no more", store.string(), segment.file);
    const auto there = read_segment_index(store, segment, kind);
    const auto content = edit(there.ok() ? there->bytes() : std::span<const std::byte>());
    return write_index(store, segment_index_name(segment.file, kind), segment.checksum, content);
  });
}

Result<Buffer> read_entity_index(const std::filesystem::path& store, const MemoryId& entity,
                                 std::string_view kind) {
  return unframed(store / entity_index_name(entity, kind), {});
}

Status publish_entity_index(const std::filesystem::path& store, const Manifest& was_made_of,
                            const MemoryId& entity, std::string_view kind,
                            std::span<const std::byte> content) {
  const uint64_t owner = forgotten_of(was_made_of, entity);
  return under_manifest_lock(store, [&](const Manifest& manifest) -> Status {
    if (forgotten_of(manifest, entity) != owner)
      return failed_precondition("store '{}': snapshots of '{}' were forgotten meanwhile",
                                 store.string(), entity.to_string());
    return write_index(store, entity_index_name(entity, kind), owner, content);
  });
}

Result<std::vector<std::string>> remove_entity_indexes(const std::filesystem::path& store,
                                                       const MemoryId& entity) {
  std::vector<std::string> removed;
  for (const std::string& name : listed_indexes(store)) {
    if (!name.starts_with(entity_file_prefix(entity))) continue;
    ENGRAM_RETURN_IF_ERROR(remove_file(store / kIndexFolder / name));
    removed.push_back(fmt::format("{}/{}", kIndexFolder, name));
  }
  return removed;
}

Result<std::vector<std::string>> remove_outdated_entity_indexes(
    const std::filesystem::path& store) {
  std::vector<std::string> removed;
  ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store));
  const auto names = listed_indexes(store);
  for (const auto& [entity, sums] : manifest.forgotten)
    for (const std::string& name : names) {
      if (!name.starts_with(entity_file_prefix(entity))) continue;
      const std::string file = fmt::format("{}/{}", kIndexFolder, name);
      if (unframed(store / file, sums.snapshots).ok()) continue;
      ENGRAM_RETURN_IF_ERROR(remove_file(store / file));
      removed.push_back(file);
    }
  return removed;
}

Status remove_published(const std::filesystem::path& store, const std::vector<std::string>& files) {
  std::set<std::string> stems;
  for (const std::string& file : files)
    if (file.starts_with("segments/")) stems.insert(stem_of(file));
  for (const std::string& name : listed_indexes(store))
    if (is_of_segment(name) && stems.contains(name.substr(0, name.find('.'))))
      ENGRAM_RETURN_IF_ERROR(remove_file(store / kIndexFolder / name));
  for (const std::string& file : files) ENGRAM_RETURN_IF_ERROR(remove_file(store / file));
  return {};
}

std::vector<std::string> find_stray_indexes(const std::filesystem::path& store,
                                            const Manifest& manifest) {
  std::set<std::string> stems;
  for (const SegmentInfo& segment : manifest.segments) stems.insert(stem_of(segment.file));
  std::vector<std::string> stray;
  for (const std::string& name : listed_indexes(store)) {
    const bool is_known =
        is_of_segment(name) ? stems.contains(name.substr(0, name.find('.'))) : is_of_entity(name);
    if (!is_known) stray.push_back(fmt::format("{}/{}", kIndexFolder, name));
  }
  return stray;
}

Status copy_indexes(const std::filesystem::path& source, const std::filesystem::path& target,
                    const Manifest& manifest) {
  std::map<std::string, uint64_t> owners;
  for (const SegmentInfo& segment : manifest.segments)
    owners[stem_of(segment.file)] = segment.checksum;
  for (const std::string& name : listed_indexes(source)) {
    std::optional<uint64_t> owner;  // Of an entity's any.
    if (is_of_segment(name)) {
      const auto found = owners.find(name.substr(0, name.find('.')));
      if (found == owners.end()) continue;
      owner = found->second;
    } else if (!is_of_entity(name)) {
      continue;
    }
    const std::string file = fmt::format("{}/{}", kIndexFolder, name);
    if (!unframed(source / file, owner).ok()) continue;
    ENGRAM_ASSIGN_OR_RETURN(const Buffer whole, read_file(source / file));
    ENGRAM_RETURN_IF_ERROR(make_directories(target / kIndexFolder));
    ENGRAM_RETURN_IF_ERROR(replace_file(target / file, whole.bytes()));
  }
  return {};
}

std::vector<Finding> check_indexes(const std::filesystem::path& store, const Manifest& manifest) {
  std::vector<Finding> notes;
  const auto stray = find_stray_indexes(store, manifest);
  for (const std::string& name : listed_indexes(store)) {
    const std::string file = fmt::format("{}/{}", kIndexFolder, name);
    if (std::ranges::binary_search(stray, file)) continue;  // The list of orphans has it.
    const auto content = unframed(store / file, {});
    if (content.ok() || content.status().code() == StatusCode::kNotFound) continue;
    notes.push_back({Severity::kNote, file, "",
                     "is a damaged index; nothing is lost, because it is made of other files",
                     "remove it; the next consolidation makes it again"});
  }
  return notes;
}

}  // namespace engram::ltm
