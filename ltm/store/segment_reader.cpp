// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_reader.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

#include "ltm/idf/json.h"
#include "ltm/store/segment_errors.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_latents.h"
#include "ltm/store/segment_media_reader.h"
#include "ltm/store/segment_source.h"
#include "ltm/store/segment_value_reader.h"
#include "ltm/store/shared_directory.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxEntities = size_t{1} << 20;
/// Max number of rows per byte of a file, from the max ratio of deflate. A hostile file may claim
/// any number of rows.
constexpr uint64_t kMaxRowsPerByte = 256;

}  // namespace

struct SegmentReader::State {
  SegmentSource source;
  SegmentValueReader values{source};
  SegmentMediaReader media{source};
  LatentCodeReader codes{source};
  SharedDirectory shared{source};
  /// The entity that was asked for last, and where its rows lie.
  MemoryId last_entity;
  EntityPlace last_place;
  SegmentColumn* last_times = nullptr;              ///< Their times, which a search reads often.
  std::map<std::string, uint64_t> bytes_of_shared;  ///< Keyed by shared group.
  /// Whether any row is augmented, by the path of the metadata.
  std::map<std::string, bool> augmented;

  State(h5::File file, File raw) : source(std::move(file), std::move(raw)) {}

  /// The group of an entity, and which of its rows are the entity's.
  Result<const EntityPlace*> place_of(const MemoryId& entity) {
    if (!last_place.group.empty() && last_entity == entity) return &last_place;
    last_place.group.clear();
    ENGRAM_ASSIGN_OR_RETURN(auto found, shared.find(entity));
    if (!found) {
      found = EntityPlace{segment_group(entity), 0, 0};
      ENGRAM_ASSIGN_OR_RETURN(const SegmentColumn* times,
                              source.column_if_there(found->group + "/timestamp"));
      if (times == nullptr)
        return not_found("{}", source.broken(found->group + "/timestamp", "is missing").message());
      found->rows = times->rows();
    }
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t bytes, source.size_bytes());
    if (found->rows / kMaxRowsPerByte > bytes)
      return source.broken(
          found->group + "/timestamp",
          fmt::format("tells of {} rows in a file of {} bytes", found->rows, bytes));
    ENGRAM_ASSIGN_OR_RETURN(last_times, source.column(found->group + "/timestamp"));
    last_entity = entity;
    last_place = *std::move(found);
    return &last_place;
  }

  /// A time of the metadata, or the time of the snapshot if the column is missing.
  Result<Time> row_time(const std::string& path, uint64_t row, Time otherwise) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * found, source.column_if_there(path));
    if (found == nullptr) return otherwise;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, source.row_number<int64_t>(*found, row));
    return time_from_ns(ns);
  }

  /// A figure of the accounting. A missing column means zero in all rows.
  Result<uint64_t> accounting(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * found, source.column_if_there(path));
    return found == nullptr ? Result<uint64_t>(0) : source.row_number<uint64_t>(*found, row);
  }

  Result<InstanceMetadata> metadata(const std::string& group, uint64_t row, Time time) {
    const std::string base = group + "/metadata";
    InstanceMetadata result;
    ENGRAM_ASSIGN_OR_RETURN(result.created, row_time(base + "/created", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.sent, row_time(base + "/sent", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.arrived, row_time(base + "/arrived", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.confidence, source.row_number<float>(base + "/confidence", row));
    ENGRAM_ASSIGN_OR_RETURN(const int32_t provider,
                            source.row_number<int32_t>(base + "/provider", row));
    ENGRAM_ASSIGN_OR_RETURN(const auto* names, source.strings(base + "/providers"));
    if (provider < 0 || static_cast<size_t>(provider) >= names->size())
      return source.broken(base + "/provider", fmt::format("row {} names no provider", row));
    result.provider = (*names)[static_cast<size_t>(provider)];
    ENGRAM_RETURN_IF_ERROR(read_augmented(base, row, result));
    return result;
  }

  /// Whether any row of an entity is augmented. The answer is kept, because the lookup in the file
  /// would otherwise be repeated for each row.
  Result<bool> has_augmented(const std::string& base) {
    const auto known = augmented.find(base);
    if (known != augmented.end()) return known->second;
    ENGRAM_ASSIGN_OR_RETURN(const bool has_recipes, source.file().exists(base + "/recipe"));
    ENGRAM_ASSIGN_OR_RETURN(const bool has_origins, source.file().exists(base + "/origin"));
    return augmented.emplace(base, has_recipes || has_origins).first->second;
  }

  /// The text of a row; empty after the last stored one.
  Result<std::string> row_text(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(const auto* texts, source.strings(path));
    return row < texts->size() ? (*texts)[row] : std::string();
  }

  Status read_augmented(const std::string& base, uint64_t row, InstanceMetadata& metadata) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_any, has_augmented(base));
    if (!is_any) return {};
    ENGRAM_ASSIGN_OR_RETURN(metadata.recipe, row_text(base + "/recipe", row));
    ENGRAM_ASSIGN_OR_RETURN(const std::string origin, row_text(base + "/origin", row));
    if (origin.empty()) return {};
    const auto id = MemoryId::parse(origin);
    if (!id.ok()) return source.broken(base + "/origin", id.status().message());
    metadata.origin = *id;
    return {};
  }

  /// The time of a row of an entity.
  Result<int64_t> time_ns(const MemoryId& entity, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, place_of(entity));
    if (row >= place->rows)
      return data_loss("'{}' has {} rows, needs row {}", place->group, place->rows, row);
    return source.located(last_times->number<int64_t>(place->first + row));
  }

  /// The times of all rows of an entity, as bytes.
  Result<std::vector<std::byte>> times_of(const EntityPlace& place) {
    if (place.rows == 0) return std::vector<std::byte>();
    return source.file().read_rows(place.group + "/timestamp", h5::Type::kInt64, place.first,
                                   place.rows);
  }

  Result<PackedInstance> instance(const std::string& group, uint64_t row, Time time,
                                  bool with_media) {
    PackedInstance result;
    ENGRAM_ASSIGN_OR_RETURN(result.metadata, metadata(group, row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.value.rest, values.value(group, row));
    if (with_media) {
      ENGRAM_ASSIGN_OR_RETURN(result.value.media, media.media(group, row));
    }
    return result;
  }

  Result<PackedSnapshot> snapshot(const MemoryId& entity, const RowSpan& span, bool with_media) {
    ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, place_of(entity));
    if (span.rows > place->rows || span.first > place->rows - span.rows)
      return source.broken(place->group,
                           fmt::format("'{}' has {} rows, needs {} from {} on", entity.to_string(),
                                       place->rows, span.rows, span.first));
    PackedSnapshot snapshot;
    snapshot.entity = entity;
    snapshot.time = span.time;
    const std::string figures = place->group + "/accounting";
    const uint64_t first = place->first + span.first;
    ENGRAM_ASSIGN_OR_RETURN(snapshot.raw_bytes, accounting(figures + "/raw_bytes", first));
    ENGRAM_ASSIGN_OR_RETURN(snapshot.dropped, accounting(figures + "/dropped", first));
    ENGRAM_ASSIGN_OR_RETURN(snapshot.dropped_bytes, accounting(figures + "/dropped_bytes", first));
    for (uint64_t row = first; row < first + span.rows; ++row) {
      ENGRAM_ASSIGN_OR_RETURN(PackedInstance read,
                              instance(place->group, row, span.time, with_media));
      snapshot.instances.push_back(std::move(read));
    }
    return snapshot;
  }

  /// Adds the entity of a group.
  void add_entity(const std::string& group, SegmentContents& contents) const {
    const auto text = source.file().string_attribute(group, "memory_id");
    if (!text.ok()) return contents.damaged.push_back(text.status());
    auto id = MemoryId::parse(*text);
    if (!id.ok() || !id->is_entity() || segment_group(*id) != group)
      return contents.damaged.push_back(source.broken(group, "has no memory_id that leads to it"));
    contents.entities.push_back(std::move(id).value());
  }

  /// Adds the entities of the groups `levels` below `group`.
  void add_entities(const std::string& group, size_t levels, SegmentContents& contents) const {
    if (levels == 0) return add_entity(group, contents);
    const auto names = source.file().list(group.empty() ? "/" : group);
    if (!names.ok()) return contents.damaged.push_back(names.status());
    for (const std::string& name : *names) {
      if (contents.entities.size() + contents.damaged.size() >= kMaxEntities) return;
      // No memory name starts with '#'; these are the types and the shared groups.
      if (!name.starts_with('#')) add_entities(group + "/" + name, levels - 1, contents);
    }
  }
};

void StoredForms::add(const StoredForms& other) {
  media_codecs.insert(other.media_codecs.begin(), other.media_codecs.end());
  has_groups = has_groups || other.has_groups;
  columns.insert(other.columns.begin(), other.columns.end());
}

SegmentReader::SegmentReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SegmentReader::~SegmentReader() = default;

Result<std::unique_ptr<SegmentReader>> SegmentReader::open(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::open(path));
  const auto version = file.int_attribute("/", "format_version");
  if (!version.ok())
    return data_loss("'{}' is no segment: {}", path.string(), version.status().message());
  if (*version > kSegmentFormatVersion)
    return failed_precondition("segment '{}': has format {}, this program reads up to {}",
                               path.string(), *version, kSegmentFormatVersion);
  ENGRAM_ASSIGN_OR_RETURN(File raw, File::open(path, File::Mode::kRead));
  return std::unique_ptr<SegmentReader>(
      new SegmentReader(std::make_unique<State>(std::move(file), std::move(raw))));
}

Result<SegmentTypes> SegmentReader::types() const {
  ENGRAM_ASSIGN_OR_RETURN(const bool has_types, state_->source.file().exists(kSegmentTypes));
  if (!has_types) return SegmentTypes();
  ENGRAM_ASSIGN_OR_RETURN(const auto texts, state_->source.file().read_strings(kSegmentTypes));
  if (texts.size() != 1) return state_->source.broken(kSegmentTypes, "needs one string");
  const auto data = idf::from_json_text(texts.front());
  if (!data.ok()) return state_->source.broken(kSegmentTypes, data.status().message());
  auto types = SegmentTypes::from_data(*data);
  if (!types.ok()) return state_->source.broken(kSegmentTypes, types.status().message());
  return types;
}

Result<SegmentContents> SegmentReader::contents() const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string kind,
                          state_->source.file().string_attribute("/", "kind"));
  if (kind != "recorded" && kind != "latent")
    return state_->source.broken("/", fmt::format("has the unknown kind '{}'", kind));
  SegmentContents contents;
  contents.kind = kind == "latent" ? SegmentKind::kLatent : SegmentKind::kRecorded;
  state_->add_entities("", MemoryId::kNameLevels, contents);
  auto damaged = state_->shared.for_each([&contents](const MemoryId& entity) {
    // Each name is in the file, so a file bounds them itself.
    contents.entities.push_back(entity);
  });
  if (!damaged.ok())
    contents.damaged.push_back(damaged.status());
  else
    std::ranges::move(*damaged, std::back_inserter(contents.damaged));
  return contents;
}

Result<uint64_t> SegmentReader::row_count(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  return place->rows;
}

Result<uint64_t> SegmentReader::stored_bytes(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto shared, state_->shared.find(entity));
  if (!shared) return state_->source.file().storage_bytes(segment_group(entity));
  auto known = state_->bytes_of_shared.find(shared->group);
  if (known == state_->bytes_of_shared.end()) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t bytes,
                            state_->source.file().storage_bytes(shared->group));
    known = state_->bytes_of_shared.emplace(shared->group, bytes).first;
  }
  ENGRAM_ASSIGN_OR_RETURN(const SegmentColumn* times,
                          state_->source.column(shared->group + "/timestamp"));
  return share_of(known->second, shared->rows, times->rows());
}

Result<StoredForms> SegmentReader::forms(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  StoredForms forms;
  ENGRAM_ASSIGN_OR_RETURN(forms.media_codecs, state_->media.codecs(place->group));
  ENGRAM_ASSIGN_OR_RETURN(forms.has_groups, state_->media.has_groups(place->group));
  ENGRAM_ASSIGN_OR_RETURN(forms.columns, state_->values.columns(place->group));
  return forms;
}

Result<Time> SegmentReader::time_at(const MemoryId& entity, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, state_->time_ns(entity, row));
  return time_from_ns(ns);
}

Result<int> SegmentReader::model_version(const MemoryId& entity) const {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version, state_->source.file().int_attribute(
                                                     segment_group(entity), "model_version"));
  if (version < 1 || version > std::numeric_limits<int>::max())
    return state_->source.broken(segment_group(entity),
                                 fmt::format("has model version {}", version));
  return static_cast<int>(version);
}

Result<std::vector<RowSpan>> SegmentReader::index(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  const std::string path = place->group + "/timestamp";
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, state_->times_of(*place));
  std::vector<RowSpan> spans;
  const std::vector<int64_t> times = h5::as_vector<int64_t>(bytes);
  for (uint64_t row = 0; row < times.size(); ++row) {
    const Time time = time_from_ns(times[row]);
    if (!spans.empty() && time < spans.back().time)
      return state_->source.broken(path, fmt::format("row {} runs backwards in time", row));
    if (!spans.empty() && spans.back().time == time)
      ++spans.back().rows;
    else
      spans.push_back({time, row, 1});
  }
  return spans;
}

Result<uint64_t> SegmentReader::lower_bound(const MemoryId& entity, Time time) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  uint64_t first = 0, count = place->rows;
  while (count > 0) {
    const uint64_t half = count / 2;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t middle, state_->time_ns(entity, first + half));
    if (time_from_ns(middle) < time) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

Result<std::optional<RowSpan>> SegmentReader::snapshot_at(const MemoryId& entity, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  if (row >= place->rows) return std::optional<RowSpan>();
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, state_->time_ns(entity, row));
  RowSpan span{time_from_ns(ns), row, 1};
  for (; span.first + span.rows < place->rows; ++span.rows) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t next, state_->time_ns(entity, span.first + span.rows));
    if (next < ns)
      return state_->source.broken(place->group + "/timestamp",
                                   fmt::format("row {} runs backwards in time", span.first));
    if (next != ns) break;
  }
  return std::optional(span);
}

Result<std::vector<ArrivedSnapshot>> SegmentReader::arrivals(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* found, state_->place_of(entity));
  const EntityPlace place = *found;
  ENGRAM_ASSIGN_OR_RETURN(const auto times, state_->times_of(place));
  const std::string path = place.group + "/metadata/arrived";
  ENGRAM_ASSIGN_OR_RETURN(const SegmentColumn* column, state_->source.column_if_there(path));
  const bool is_one_for_all = column != nullptr && column->rows() == 1;
  std::vector<std::byte> arrived;
  if (column != nullptr && place.rows > 0) {
    ENGRAM_ASSIGN_OR_RETURN(arrived, state_->source.file().read_rows(
                                         path, h5::Type::kInt64, is_one_for_all ? 0 : place.first,
                                         is_one_for_all ? 1 : place.rows));
  }
  const auto number = [](const std::vector<std::byte>& bytes, uint64_t row) {
    int64_t value = 0;
    std::memcpy(&value, bytes.data() + row * sizeof(value), sizeof(value));
    return time_from_ns(value);
  };
  std::vector<ArrivedSnapshot> snapshots;
  for (uint64_t row = 0; row < place.rows; ++row) {
    const Time time = number(times, row);
    Time came = arrived.empty() ? time : number(arrived, is_one_for_all ? 0 : row);
    if (came == Time{}) came = time;
    if (!snapshots.empty() && snapshots.back().time == time)
      snapshots.back().arrived = std::max(snapshots.back().arrived, came);
    else
      snapshots.push_back({time, came});
  }
  return snapshots;
}

Result<bool> SegmentReader::has_arrivals(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const EntityPlace* place, state_->place_of(entity));
  return state_->source.file().exists(place->group + "/metadata/arrived");
}

Result<PackedSnapshot> SegmentReader::read_recorded(const MemoryId& entity, const RowSpan& span) {
  return state_->snapshot(entity, span, true);
}

Result<PackedSnapshot> SegmentReader::read_values(const MemoryId& entity, const RowSpan& span) {
  return state_->snapshot(entity, span, false);
}

Result<std::vector<LatentQuality>> SegmentReader::read_qualities(const MemoryId& entity,
                                                                 const RowSpan& span) {
  std::vector<LatentQuality> qualities;
  for (uint64_t row = span.first; row < span.first + span.rows; ++row) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentQuality quality,
                            read_quality(state_->source, segment_group(entity), row));
    qualities.push_back(quality);
  }
  return qualities;
}

Result<LatentSnapshot> SegmentReader::read_latent(const MemoryId& entity, const RowSpan& span) {
  const std::string group = segment_group(entity);
  LatentSnapshot snapshot;
  snapshot.time = span.time;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version,
                          state_->source.file().int_attribute(group, "model_version"));
  snapshot.model_version = static_cast<int>(version);
  for (uint64_t row = span.first; row < span.first + span.rows; ++row) {
    LatentInstance instance;
    ENGRAM_ASSIGN_OR_RETURN(instance.metadata, state_->metadata(group, row, span.time));
    ENGRAM_ASSIGN_OR_RETURN(instance.latent, state_->codes.read(group + "/latent", row));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data rest,
                            state_->values.remainder(group + "/remainder", row));
    if (!rest.is<idf::List>())
      return state_->source.broken(group, fmt::format("row {} has no remainder", row));
    instance.latent.remainder = rest.get<idf::List>();
    ENGRAM_ASSIGN_OR_RETURN(instance.quality, read_quality(state_->source, group, row));
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

}  // namespace engram::ltm
