// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/columns.h"

#include <algorithm>
#include <set>

#include "datasets/recordings/merged_snapshots.h"
#include "datasets/recordings/stored_streams.h"

namespace engram::datasets {

namespace {

constexpr uint64_t kChunkBytes = 256 << 10;
constexpr int kDeflateLevel = 4;  ///< The default of h5py.

/// Adds the members of a value that are numbers, arrays or texts; all others are counted.
void add_members(const idf::Data& value, const std::string& path,
                 std::vector<std::pair<std::string, RowForm>>& members, uint64_t& others) {
  if (const auto* dict = value.get_if<idf::Dict>()) {
    for (const auto& [key, below] : *dict)
      add_members(below, idf::join_path(path, key), members, others);
  } else if (auto form = row_form(value)) {
    members.emplace_back(path, *std::move(form));
  } else {
    ++others;
  }
}

template <typename Value>
Value described(const idf::Dict& attributes, std::string_view name, Value fallback) {
  const idf::Data* found = attributes.find(name);
  return found != nullptr && found->is<Value>() ? found->get<Value>() : fallback;
}

uint64_t product(const std::vector<uint64_t>& shape) {
  uint64_t total = 1;
  for (const uint64_t size : shape) total *= size;
  return total;
}

/// Lays out an array like h5py and robomimic do: images are compressed, numbers are not.
h5::ArrayInfo usual_array(const RowForm& form) {
  h5::ArrayInfo array{form.element, {1}};
  array.shape.insert(array.shape.end(), form.shape.begin(), form.shape.end());
  if (form.shape.size() < 2 || !form.element.is_number()) return array;
  array.chunk_rows = std::max<uint64_t>(kChunkBytes / std::max<uint64_t>(array.row_bytes(), 1), 1);
  array.deflate_level = kDeflateLevel;
  return array;
}

/// Lays out an array as in the file that it came from, if that still fits.
h5::ArrayInfo former_array(const RowForm& form, const idf::Dict& attributes) {
  h5::ArrayInfo array = usual_array(form);
  const auto dtype = described<std::string>(attributes, "dtype", "");
  const auto was_bytes =
      dtype == "bytes" ||
      (dtype == "uint8" && form.shape.size() == 3 && attributes.find("row_shape") != nullptr &&
       described<idf::List>(attributes, "row_shape", {}).size() == 1);
  if (was_bytes) return array;  // The images were JPEG files and are decoded now.
  std::vector<uint64_t> row;
  for (const idf::Data& size : described<idf::List>(attributes, "row_shape", {}))
    if (const auto* number = size.get_if<int64_t>(); number != nullptr && *number >= 0)
      row.push_back(static_cast<uint64_t>(*number));
  if (attributes.find("row_shape") != nullptr && product(row) == product(form.shape)) {
    array.shape.assign(1, 1);
    array.shape.insert(array.shape.end(), row.begin(), row.end());
  }
  const h5::Element half{h5::Kind::kHalf, h5::Type::kFloat32};
  if (dtype == "float16" && form.element.type == half.type) array.element = half;
  if (dtype == "bool" && form.element.type == h5::Type::kUInt8 && form.element.is_number())
    array.element = {h5::Kind::kBool};
  if (dtype == "fixed_text" && form.element.kind == h5::Kind::kText)
    array.element = {h5::Kind::kFixedText, h5::Type::kUInt8,
                     static_cast<uint64_t>(
                         std::max<int64_t>(described<int64_t>(attributes, "text_bytes", 1), 1))};
  array.chunk_rows =
      static_cast<uint64_t>(std::max<int64_t>(described<int64_t>(attributes, "chunk_rows", 0), 0));
  array.deflate_level =
      static_cast<int>(std::clamp<int64_t>(described<int64_t>(attributes, "gzip", 0), 0, 9));
  return array;
}

std::string unique_name(std::string name, std::set<std::string>& taken) {
  const std::string first = name;
  for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", first, i);
  return name;
}

}  // namespace

Result<std::vector<ExportedEntity>> exported_columns(ltm::Recall& recall, const ltm::Query& query,
                                                     const ltm::Recall::Options& options,
                                                     const Dialect& dialect, NotHeld& not_held) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  std::vector<ExportedEntity> exported;
  std::set<std::string> taken;
  for (const ltm::MemoryId& entity : entities) {
    if (is_description(entity)) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto newest, newest_snapshot(recall, entity, options));
    if (!newest || newest->instances.empty()) continue;
    tell_metadata(*newest, not_held);
    const idf::Data& value = newest->instances.front().data;
    std::vector<std::pair<std::string, RowForm>> members;
    uint64_t others = 0;
    add_members(value, "", members, others);
    if (others > 0) ++not_held["lists and members that are absent"];
    ENGRAM_ASSIGN_OR_RETURN(const auto stream,
                            stored_stream(recall, dialect.name(), entity, options));
    ExportedEntity one{entity, {}};
    for (auto& [path, form] : members) {
      Column column{path, "", form, usual_array(form)};
      if (stream && members.size() == 1) {
        column.name = stream->name;
        column.array = former_array(form, stream->attributes);
      } else {
        column.name = dialect.array_name(entity, members.size() == 1 ? "" : path);
      }
      column.name = unique_name(column.name, taken);
      one.columns.push_back(std::move(column));
    }
    if (!one.columns.empty()) exported.push_back(std::move(one));
  }
  return exported;
}

Result<std::vector<RecordingEpisode>> stored_episodes(ltm::Recall& recall, const Dialect& dialect) {
  std::vector<RecordingEpisode> episodes;
  const ltm::MemoryId id = episode_entity(dialect.name());
  if (recall.store().timeline(id).ok()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto answer,
                            recall.query(ltm::Query::of_entity(id, ltm::select::All{})));
    if (const auto* found = answer.find_entity(id))
      for (const ltm::SnapshotResult& snapshot : found->snapshots)
        for (const ltm::InstanceResult& instance : snapshot.instances) {
          ENGRAM_ASSIGN_OR_RETURN(auto episode, RecordingEpisode::from_data(instance.data));
          episodes.push_back(std::move(episode));
        }
  }
  std::ranges::stable_sort(episodes, {}, &RecordingEpisode::start);
  if (episodes.empty())
    episodes.push_back({std::string(dialect.name()),
                        dialect.has_file_per_episode() ? "episode_0" : "demo_0",
                        Time::min(),
                        {}});
  return episodes;
}

}  // namespace engram::datasets
