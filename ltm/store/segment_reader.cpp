// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_reader.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

#include "ltm/codec/zstd.h"
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_column.h"
#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

constexpr uint64_t kMaxBlobBytes = uint64_t{1} << 32;
constexpr size_t kMaxRemainderBytes = size_t{1} << 31;
constexpr size_t kMaxEntities = size_t{1} << 20;
/// Deflate makes no more of a byte of times.
constexpr uint64_t kMaxRowsPerByte = 256;

constexpr int kDepth = idf::kMaxDepth + idf::kContainerDepth;

}  // namespace

struct SegmentReader::State {
  using List = idf::List;

  h5::File file;
  File raw;  ///< The same file, for blobs at their offsets.
  std::map<std::string, std::optional<SegmentColumn>> columns;  ///< Nothing: not there.
  std::map<std::string, List> remainder_blocks;  ///< The last block read, per group.
  std::map<std::string, uint64_t> remainder_block_number;

  State(h5::File h5_file, File raw_file) : file(std::move(h5_file)), raw(std::move(raw_file)) {}

  Status broken(const std::string& object, std::string_view what) const {
    return data_loss("segment '{}': '{}': {}", raw.path().string(), object, what);
  }

  /// Null where the file has no such dataset.
  Result<SegmentColumn*> column_if_there(const std::string& path) {
    auto known = columns.find(path);
    if (known == columns.end()) {
      auto opened = SegmentColumn::open(file, path);
      if (!opened.ok() && opened.status().code() != StatusCode::kNotFound) return opened.status();
      known = columns.emplace(path, std::nullopt).first;
      if (opened.ok()) known->second = std::move(opened).value();
    }
    return known->second ? &*known->second : nullptr;
  }

  Result<SegmentColumn*> column(const std::string& path) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * found, column_if_there(path));
    if (found == nullptr) return broken(path, "is missing");
    return found;
  }

  template <typename T>
  Result<T> number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return located(values->number<T>(row));
  }

  /// A number per row of the entity, where one row stands for all if they are equal.
  template <typename T>
  Result<T> row_number(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column(path));
    return located(values->number<T>(values->rows() == 1 ? 0 : row));
  }

  /// A time of the metadata; where there are none, that of the snapshot.
  Result<Time> row_time(const std::string& path, uint64_t row, Time otherwise) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column_if_there(path));
    if (values == nullptr) return otherwise;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, row_number<int64_t>(path, row));
    return time_from_ns(ns);
  }

  /// Missing: zero in all rows.
  Result<uint64_t> accounting(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values, column_if_there(path));
    return values == nullptr ? Result<uint64_t>(0) : row_number<uint64_t>(path, row);
  }

  template <typename T>
  Result<T> located(Result<T> result) const {
    if (result.ok()) return result;
    return result.status().with_context(fmt::format("segment '{}'", raw.path().string()));
  }

  /// Blob `row` of a blob column, read at its offset without HDF5. Empty where there is none.
  Result<Buffer> blob(const std::string& group, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t begin, number<uint64_t>(group + "/offset", row));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t end, number<uint64_t>(group + "/offset", row + 1));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t expected, number<uint64_t>(group + "/checksum", row));
    if (begin == end) return Buffer();
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * bytes, column(group + "/bytes"));
    if (end < begin || end > bytes->rows() || end - begin > kMaxBlobBytes ||
        !bytes->info().offset || bytes->info().type != h5::Type::kUInt8)
      return broken(group, fmt::format("row {} has no valid offsets", row));
    std::vector<std::byte> content(end - begin);
    ENGRAM_RETURN_IF_ERROR(raw.read_at(*bytes->info().offset + begin, content));
    if (checksum(content) != expected)
      return broken(group, fmt::format("row {} fails its checksum", row));
    return Buffer::take(std::move(content));
  }

  Result<idf::Data> remainder(const std::string& group, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t per_block, file.int_attribute(group, "rows_per_block"));
    if (per_block < 1) return broken(group, "has no rows per block");
    const uint64_t number = row / static_cast<uint64_t>(per_block);
    const auto known = remainder_block_number.find(group);
    if (known == remainder_block_number.end() || known->second != number) {
      ENGRAM_ASSIGN_OR_RETURN(const Buffer packed, blob(group, number));
      ENGRAM_ASSIGN_OR_RETURN(auto plain, decompress_zstd(packed.bytes(), kMaxRemainderBytes));
      ENGRAM_ASSIGN_OR_RETURN(idf::Data block, idf::decode(Buffer::take(std::move(plain)), kDepth));
      if (!block.is<List>()) return broken(group, fmt::format("block {} is no list", number));
      remainder_blocks[group] = std::move(*block.get_if<List>());
      remainder_block_number[group] = number;
    }
    const List& block = remainder_blocks[group];
    const uint64_t at = row % static_cast<uint64_t>(per_block);
    if (at >= block.size()) return broken(group, fmt::format("block {} lacks row {}", number, row));
    return block[at];
  }

  Result<InstanceMetadata> metadata(const std::string& group, uint64_t row, Time time) {
    const std::string base = group + "/metadata";
    InstanceMetadata result;
    ENGRAM_ASSIGN_OR_RETURN(result.created, row_time(base + "/created", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.sent, row_time(base + "/sent", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.arrived, row_time(base + "/arrived", row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.confidence, row_number<float>(base + "/confidence", row));
    ENGRAM_ASSIGN_OR_RETURN(const int32_t provider, row_number<int32_t>(base + "/provider", row));
    ENGRAM_ASSIGN_OR_RETURN(const auto* names, strings(base + "/providers"));
    if (provider < 0 || static_cast<size_t>(provider) >= names->size())
      return broken(base + "/provider", fmt::format("row {} names no provider", row));
    result.provider = (*names)[static_cast<size_t>(provider)];
    return result;
  }

  Result<const std::vector<std::string>*> strings(const std::string& path) {
    const auto known = string_lists.find(path);
    if (known != string_lists.end()) return &known->second;
    ENGRAM_ASSIGN_OR_RETURN(auto values, file.read_strings(path));
    return &string_lists.emplace(path, std::move(values)).first->second;
  }

  Result<const idf::Layout*> layout(const std::string& group) {
    const auto known = layouts.find(group);
    if (known != layouts.end()) return &known->second;
    ENGRAM_ASSIGN_OR_RETURN(auto bytes, file.read(group + "/layout", h5::Type::kUInt8));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data data,
                            idf::decode(Buffer::take(std::move(bytes)), kDepth));
    ENGRAM_ASSIGN_OR_RETURN(idf::Layout read, idf::Layout::from_data(data));
    return &layouts.emplace(group, std::move(read)).first->second;
  }

  /// The tensors of a row, in the order of the layout.
  Result<std::vector<idf::NdArray>> tensors(const std::string& group, const idf::Layout& of,
                                            uint64_t row) {
    std::vector<idf::NdArray> values;
    std::map<std::string, size_t> next_column;
    for (const idf::TensorMember& member : of.members()) {
      const size_t size = *idf::size_bytes(member.type, member.shape);
      std::string path = group + "/arrays" + segment_member(member.path);
      size_t offset = 0;
      if (is_scalar(member)) {
        const std::string name = scalar_group(member);
        path = group + "/columns/" + name + "/values";
        offset = next_column[name]++ * size;
      }
      ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * values_of, column(path));
      if (values_of->info().type != h5_type(member.type))
        return broken(path, "has another element type than the layout says");
      ENGRAM_ASSIGN_OR_RETURN(const auto bytes, values_of->row(row));
      if (bytes.size() < offset + size) return broken(path, "has fewer columns than the layout");
      ENGRAM_ASSIGN_OR_RETURN(idf::NdArray array,
                              idf::NdArray::create(member.type, member.shape,
                                                   Buffer::copy(bytes.subspan(offset, size))));
      values.push_back(std::move(array));
    }
    return values;
  }

  Result<idf::Data> rest(const std::string& group, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(idf::Data remains, remainder(group + "/remainder", row));
    if (const idf::Data* whole = remains.at("value"); remains.is<idf::Dict>() && whole != nullptr)
      return *whole;
    if (!remains.is<List>()) return broken(group, fmt::format("row {} has no remainder", row));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Layout* of, layout(group));
    ENGRAM_ASSIGN_OR_RETURN(auto arrays, tensors(group, *of, row));
    return of->join({std::move(arrays), remains.get<List>()});
  }

  struct MediaGroup {
    std::string name;
    PackedMedium medium;  ///< Without bytes, and without shape where each row has its own.
    bool has_shapes = false;
  };

  Result<const std::vector<MediaGroup>*> media_groups(const std::string& group) {
    if (const auto known = media.find(group); known != media.end()) return &known->second;
    std::vector<MediaGroup> groups;
    std::vector<std::string> names;
    ENGRAM_ASSIGN_OR_RETURN(const bool has_media, file.exists(group + "/media_groups"));
    if (has_media) {
      ENGRAM_ASSIGN_OR_RETURN(names, file.read_strings(group + "/media_groups"));
    }
    for (const std::string& name : names) {
      MediaGroup found{name, {}};
      ENGRAM_ASSIGN_OR_RETURN(found.medium.path, file.string_attribute(name, "path"));
      ENGRAM_ASSIGN_OR_RETURN(found.medium.codec, file.string_attribute(name, "codec"));
      ENGRAM_ASSIGN_OR_RETURN(const auto type, file.string_attribute(name, "element_type"));
      const auto element = idf::element_type_from_name(type);
      if (!element) return broken(name, "has an unknown element type");
      found.medium.type = *element;
      ENGRAM_ASSIGN_OR_RETURN(const h5::DatasetInfo shape, file.info(name + "/shape"));
      found.has_shapes = shape.shape.size() == 2;
      if (!found.has_shapes) {
        ENGRAM_ASSIGN_OR_RETURN(const auto sizes, file.read(name + "/shape", h5::Type::kInt64));
        found.medium.shape = h5::as_vector<int64_t>(sizes);
      }
      groups.push_back(std::move(found));
    }
    return &media.emplace(group, std::move(groups)).first->second;
  }

  Result<idf::Shape> shape(const std::string& path, uint64_t row) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * shapes, column(path));
    if (shapes->info().type != h5::Type::kInt64) return broken(path, "is no int64");
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, located(shapes->row(row)));
    return h5::as_vector<int64_t>(bytes);
  }

  Result<PackedInstance> instance(const std::string& group, uint64_t row, Time time) {
    PackedInstance result;
    ENGRAM_ASSIGN_OR_RETURN(result.metadata, metadata(group, row, time));
    ENGRAM_ASSIGN_OR_RETURN(result.value.rest, rest(group, row));
    ENGRAM_ASSIGN_OR_RETURN(const auto* groups, media_groups(group));
    for (const MediaGroup& found : *groups) {
      ENGRAM_ASSIGN_OR_RETURN(Buffer bytes, blob(found.name, row));
      if (bytes.empty()) continue;
      result.value.media.push_back(found.medium);
      result.value.media.back().bytes = std::move(bytes);
      if (!found.has_shapes) continue;
      ENGRAM_ASSIGN_OR_RETURN(result.value.media.back().shape, shape(found.name + "/shape", row));
    }
    return result;
  }

  /// Adds the entity of a group at the level of entities.
  void add_entity(const std::string& group, SegmentContents& contents) const {
    const auto text = file.string_attribute(group, "memory_id");
    if (!text.ok()) return contents.damaged.push_back(text.status());
    auto id = MemoryId::parse(*text);
    if (!id.ok() || !id->is_entity() || segment_group(*id) != group)
      return contents.damaged.push_back(broken(group, "has no memory_id that leads to it"));
    contents.entities.push_back(std::move(id).value());
  }

  /// Adds the entities below a group that lies `levels` above theirs.
  void add_entities(const std::string& group, size_t levels, SegmentContents& contents) const {
    if (levels == 0) return add_entity(group, contents);
    const auto names = file.list(group.empty() ? "/" : group);
    if (!names.ok()) return contents.damaged.push_back(names.status());
    for (const std::string& name : *names) {
      if (contents.entities.size() + contents.damaged.size() >= kMaxEntities) return;
      // No memory's name starts like that: the types.
      if (!name.starts_with('#')) add_entities(group + "/" + name, levels - 1, contents);
    }
  }

  std::map<std::string, std::vector<std::string>> string_lists;
  std::map<std::string, idf::Layout> layouts;
  std::map<std::string, std::vector<MediaGroup>> media;
};

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
  ENGRAM_ASSIGN_OR_RETURN(const bool has_types, state_->file.exists(kSegmentTypes));
  if (!has_types) return SegmentTypes();
  ENGRAM_ASSIGN_OR_RETURN(const auto texts, state_->file.read_strings(kSegmentTypes));
  if (texts.size() != 1) return state_->broken(kSegmentTypes, "needs one string");
  const auto data = idf::from_json_text(texts.front());
  if (!data.ok()) return state_->broken(kSegmentTypes, data.status().message());
  auto types = SegmentTypes::from_data(*data);
  if (!types.ok()) return state_->broken(kSegmentTypes, types.status().message());
  return types;
}

Result<SegmentContents> SegmentReader::contents() const {
  ENGRAM_ASSIGN_OR_RETURN(const std::string kind, state_->file.string_attribute("/", "kind"));
  if (kind != "recorded" && kind != "latent")
    return state_->broken("/", fmt::format("has the unknown kind '{}'", kind));
  SegmentContents contents;
  contents.kind = kind == "latent" ? SegmentKind::kLatent : SegmentKind::kRecorded;
  state_->add_entities("", MemoryId::kNameLevels, contents);
  return contents;
}

Result<uint64_t> SegmentReader::row_count(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * times,
                          state_->column(segment_group(entity) + "/timestamp"));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t bytes, state_->raw.size());
  if (times->rows() / kMaxRowsPerByte > bytes)
    return state_->broken(times->path(), fmt::format("tells of {} rows in a file of {} bytes",
                                                     times->rows(), bytes));
  return times->rows();
}

Result<uint64_t> SegmentReader::stored_bytes(const MemoryId& entity) const {
  return state_->file.storage_bytes(segment_group(entity));
}

Result<Time> SegmentReader::time_at(const MemoryId& entity, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns,
                          state_->number<int64_t>(segment_group(entity) + "/timestamp", row));
  return time_from_ns(ns);
}

Result<int> SegmentReader::model_version(const MemoryId& entity) const {
  ENGRAM_ASSIGN_OR_RETURN(
      const int64_t version,
      state_->file.int_attribute(segment_group(entity), "model_version"));
  if (version < 1 || version > std::numeric_limits<int>::max())
    return state_->broken(segment_group(entity), fmt::format("has model version {}", version));
  return static_cast<int>(version);
}

Result<std::vector<RowSpan>> SegmentReader::index(const MemoryId& entity) {
  const std::string path = segment_group(entity) + "/timestamp";
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, state_->file.read(path, h5::Type::kInt64));
  std::vector<RowSpan> spans;
  const std::vector<int64_t> times = h5::as_vector<int64_t>(bytes);
  for (uint64_t row = 0; row < times.size(); ++row) {
    const Time time = time_from_ns(times[row]);
    if (!spans.empty() && time < spans.back().time)
      return state_->broken(path, fmt::format("row {} runs backwards in time", row));
    if (!spans.empty() && spans.back().time == time)
      ++spans.back().rows;
    else
      spans.push_back({time, row, 1});
  }
  return spans;
}

Result<uint64_t> SegmentReader::lower_bound(const MemoryId& entity, Time time) {
  const std::string path = segment_group(entity) + "/timestamp";
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * times, state_->column(path));
  uint64_t first = 0, count = times->rows();
  while (count > 0) {
    const uint64_t half = count / 2;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t middle, state_->number<int64_t>(path, first + half));
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
  const std::string path = segment_group(entity) + "/timestamp";
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * times, state_->column(path));
  if (row >= times->rows()) return std::optional<RowSpan>();
  ENGRAM_ASSIGN_OR_RETURN(const int64_t ns, state_->number<int64_t>(path, row));
  RowSpan span{time_from_ns(ns), row, 1};
  for (; span.first + span.rows < times->rows(); ++span.rows) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t next,
                            state_->number<int64_t>(path, span.first + span.rows));
    if (next < ns)
      return state_->broken(path, fmt::format("row {} runs backwards in time", span.first));
    if (next != ns) break;
  }
  return std::optional(span);
}

Result<PackedSnapshot> SegmentReader::read_recorded(const MemoryId& entity, const RowSpan& span) {
  const std::string group = segment_group(entity);
  PackedSnapshot snapshot;
  snapshot.entity = entity;
  snapshot.time = span.time;
  const std::string accounting = group + "/accounting";
  ENGRAM_ASSIGN_OR_RETURN(snapshot.raw_bytes,
                          state_->accounting(accounting + "/raw_bytes", span.first));
  ENGRAM_ASSIGN_OR_RETURN(snapshot.dropped,
                          state_->accounting(accounting + "/dropped", span.first));
  ENGRAM_ASSIGN_OR_RETURN(snapshot.dropped_bytes,
                          state_->accounting(accounting + "/dropped_bytes", span.first));
  for (uint64_t row = span.first; row < span.first + span.rows; ++row) {
    ENGRAM_ASSIGN_OR_RETURN(PackedInstance instance, state_->instance(group, row, span.time));
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

Result<LatentSnapshot> SegmentReader::read_latent(const MemoryId& entity, const RowSpan& span) {
  const std::string group = segment_group(entity);
  LatentSnapshot snapshot;
  snapshot.time = span.time;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version,
                          state_->file.int_attribute(group, "model_version"));
  snapshot.model_version = static_cast<int>(version);
  for (uint64_t row = span.first; row < span.first + span.rows; ++row) {
    LatentInstance instance;
    ENGRAM_ASSIGN_OR_RETURN(instance.metadata, state_->metadata(group, row, span.time));
    ENGRAM_ASSIGN_OR_RETURN(instance.latent.code, state_->blob(group + "/latent", row));
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data rest, state_->remainder(group + "/remainder", row));
    if (!rest.is<idf::List>())
      return state_->broken(group, fmt::format("row {} has no remainder", row));
    instance.latent.remainder = rest.get<idf::List>();
    ENGRAM_ASSIGN_OR_RETURN(instance.error.image_mse,
                            state_->row_number<double>(group + "/error/image_mse", row));
    ENGRAM_ASSIGN_OR_RETURN(instance.error.number_mse,
                            state_->row_number<double>(group + "/error/number_mse", row));
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

}  // namespace engram::ltm
