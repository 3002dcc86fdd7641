// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "ltm/codec/zstd.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

using h5::Storage;
using idf::Data;
using idf::Dict;
using idf::List;

constexpr int kRemainderLevel = 12;
constexpr double kPsnrCapDb = 60;
/// Rows of further layouts are kept whole.
constexpr size_t kMaxLayoutsCounted = 32;

template <typename T>
Status write_column(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const uint64_t count = values.size();
  return file.write(path, h5_type(idf::kElementTypeOf<T>), {&count, 1},
                    std::as_bytes(std::span(values)), Storage::kCompressed);
}

/// A number per row of an entity; one stands for all where they are equal.
template <typename T>
Status write_row_column(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const auto differs = [&](const T& value) {
    return std::memcmp(&value, values.data(), sizeof(T)) != 0;
  };
  if (values.size() > 1 && std::ranges::none_of(values, differs))
    return write_column(file, path, std::vector<T>{values.front()});
  return write_column(file, path, values);
}

/// Byte strings of varying length, one per row or block of rows.
class BlobColumn {
 public:
  void append(std::span<const std::byte> blob) {
    bytes_.insert(bytes_.end(), blob.begin(), blob.end());
    offsets_.push_back(bytes_.size());
    checksums_.push_back(blob.empty() ? 0 : checksum(blob));
  }

  Status write(h5::File& file, const std::string& group) const {
    const uint64_t count = bytes_.size();
    ENGRAM_RETURN_IF_ERROR(
        file.write(group + "/bytes", h5::Type::kUInt8, {&count, 1}, bytes_, Storage::kContiguous));
    ENGRAM_RETURN_IF_ERROR(write_column(file, group + "/offset", offsets_));
    return write_column(file, group + "/checksum", checksums_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::vector<uint64_t> offsets_{0};
  std::vector<uint64_t> checksums_;
};

/// The values of a remainder, packed a block of rows at a time: alike strings cost little.
class RemainderColumn {
 public:
  void append(Data row) {
    largest_bytes_ = std::max(largest_bytes_, idf::encoded_size(row));
    rows_.push_back(std::move(row));
  }

  Status write(h5::File& file, const std::string& group) {
    // Who reads one row unpacks its block: blocks of large rows have few.
    const size_t block = std::clamp<size_t>(
        kRemainderBlockBytes / std::max<size_t>(largest_bytes_, 1), 1, kRemainderBlockRows);
    BlobColumn blobs;
    for (size_t first = 0; first < rows_.size(); first += block) {
      const size_t end = std::min(first + block, rows_.size());
      List rows;
      for (size_t i = first; i < end; ++i) rows.push_back(std::move(rows_[i]));
      ENGRAM_ASSIGN_OR_RETURN(const auto plain,
                              idf::encode(std::move(rows), idf::kMaxDepth + idf::kContainerDepth));
      blobs.append(compress_zstd(plain, kRemainderLevel));
    }
    rows_.clear();
    ENGRAM_RETURN_IF_ERROR(blobs.write(file, group));
    return file.write_attribute(group, "rows_per_block", static_cast<int64_t>(block));
  }

 private:
  List rows_;
  size_t largest_bytes_ = 0;
};

/// Columns that rows of every kind share: time, instance and metadata.
class RowColumns {
 public:
  void append(Time time, size_t instance, const InstanceMetadata& metadata) {
    timestamps_.push_back(to_ns(time));
    instances_.push_back(static_cast<int32_t>(instance));
    created_.push_back(to_ns(metadata.created));
    sent_.push_back(to_ns(metadata.sent));
    arrived_.push_back(to_ns(metadata.arrived));
    confidences_.push_back(metadata.confidence);
    const auto [known, is_new] = provider_index_.emplace(metadata.provider, providers_.size());
    if (is_new) providers_.push_back(metadata.provider);
    provider_.push_back(static_cast<int32_t>(known->second));
  }

  Status write(h5::File& file, const std::string& group) const {
    const std::string metadata = group + "/metadata";
    ENGRAM_RETURN_IF_ERROR(write_column(file, group + "/timestamp", timestamps_));
    ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/instance", instances_));
    ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/created", created_));
    ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/sent", sent_));
    ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/arrived", arrived_));
    ENGRAM_RETURN_IF_ERROR(write_row_column(file, metadata + "/confidence", confidences_));
    ENGRAM_RETURN_IF_ERROR(write_row_column(file, metadata + "/provider", provider_));
    return file.write_strings(metadata + "/providers", providers_);
  }

  [[nodiscard]] size_t rows() const { return timestamps_.size(); }

 private:
  /// Nothing where they are the times of the snapshots.
  Status write_times(h5::File& file, const std::string& path,
                     const std::vector<int64_t>& times) const {
    return times == timestamps_ ? Status() : write_row_column(file, path, times);
  }

  std::vector<int64_t> timestamps_, created_, sent_, arrived_;
  std::vector<int32_t> instances_, provider_;
  std::vector<float> confidences_;
  std::vector<std::string> providers_;
  std::unordered_map<std::string, size_t> provider_index_;
};

struct Row {
  const PackedSnapshot* snapshot;
  size_t instance;

  [[nodiscard]] const PackedInstance& packed() const { return snapshot->instances[instance]; }
};

/// The layout that most rows have; the others are kept whole in the remainder. Columns are for
/// the many: where fewer than half of the rows would fill them, there are none.
idf::Layout most_common_layout(const std::vector<Row>& rows) {
  std::vector<std::pair<idf::Layout, size_t>> counts;
  for (const Row& row : rows) {
    const idf::Layout layout = idf::Layout::of(row.packed().value.rest);
    const auto known = std::ranges::find(counts, layout, &std::pair<idf::Layout, size_t>::first);
    if (known != counts.end())
      ++known->second;
    else if (counts.size() < kMaxLayoutsCounted)
      counts.emplace_back(layout, 1);
  }
  const auto best = std::ranges::max_element(counts, {}, &std::pair<idf::Layout, size_t>::second);
  return best == counts.end() || best->second * 2 < rows.size() ? idf::Layout() : best->first;
}

/// HDF5 strings end at a zero byte. Our own reader takes paths from the layout.
std::string printable(std::string path) {
  std::ranges::replace(path, '\0', '?');
  return path;
}

/// The tensor members of the rows as datasets: scalars of one type share a matrix.
class TensorColumns {
 public:
  TensorColumns(const idf::Layout& layout, size_t rows) : layout_(layout), rows_(rows) {
    for (const idf::TensorMember& member : layout.members())
      values_.emplace_back(rows * *idf::size_bytes(member.type, member.shape));
  }

  void set(size_t row, const std::vector<idf::NdArray>& tensors) {
    for (size_t i = 0; i < tensors.size(); ++i) {
      const auto bytes = tensors[i].bytes();
      std::ranges::copy(bytes, values_[i].begin() + static_cast<ptrdiff_t>(row * bytes.size()));
    }
  }

  Status write(h5::File& file, const std::string& group) const {
    std::map<std::string, std::vector<size_t>> scalars;
    for (size_t i = 0; i < values_.size(); ++i) {
      const idf::TensorMember& member = layout_.members()[i];
      if (is_scalar(member))
        scalars[scalar_group(member)].push_back(i);
      else
        ENGRAM_RETURN_IF_ERROR(write_array(file, group, i));
    }
    for (const auto& [name, members] : scalars)
      ENGRAM_RETURN_IF_ERROR(write_scalars(file, group + "/columns/" + name, members));
    return {};
  }

 private:
  Status write_array(h5::File& file, const std::string& group, size_t index) const {
    const idf::TensorMember& member = layout_.members()[index];
    std::vector<uint64_t> shape{rows_};
    for (const int64_t size : member.shape) shape.push_back(static_cast<uint64_t>(size));
    return file.write(group + "/arrays" + segment_member(member.path), h5_type(member.type), shape,
                      values_[index], Storage::kCompressed);
  }

  Status write_scalars(h5::File& file, const std::string& group,
                       const std::vector<size_t>& members) const {
    const idf::ElementType type = layout_.members()[members.front()].type;
    const size_t size = idf::size_bytes(type);
    std::vector<std::byte> matrix(rows_ * members.size() * size);
    std::vector<std::string> paths;
    for (size_t column = 0; column < members.size(); ++column) {
      paths.push_back(printable(layout_.members()[members[column]].path));
      for (size_t row = 0; row < rows_; ++row)
        std::copy_n(values_[members[column]].data() + row * size, size,
                    matrix.data() + (row * members.size() + column) * size);
    }
    const std::vector<uint64_t> shape{rows_, members.size()};
    ENGRAM_RETURN_IF_ERROR(
        file.write(group + "/values", h5_type(type), shape, matrix, Storage::kCompressed));
    return file.write_strings(group + "/paths", paths);
  }

  const idf::Layout& layout_;
  size_t rows_;
  std::vector<std::vector<std::byte>> values_;
};

/// Media of the rows: a group per path, and per variant of codec, type and number of axes.
class MediaColumns {
 public:
  Status append(size_t row, const std::vector<PackedMedium>& media) {
    for (const PackedMedium& medium : media) {
      Variant& variant = find(medium);
      variant.fill(row);
      variant.append(medium);
    }
    return {};
  }

  Status write(h5::File& file, const std::string& group, size_t rows) {
    std::map<std::string, int> variants_of_path;
    for (Variant& variant : variants_) {
      variant.fill(rows);
      const int number = variants_of_path[variant.path]++;
      std::string name = group + "/media" + segment_member(variant.path);
      // A number, too, where groups of other media would lie among the datasets of this one.
      if (number > 0 || has_media_below(variant.path)) name += fmt::format("#{}", number);
      ENGRAM_RETURN_IF_ERROR(variant.blobs.write(file, name));
      ENGRAM_RETURN_IF_ERROR(file.write_attribute(name, "path", variant.path));
      ENGRAM_RETURN_IF_ERROR(file.write_attribute(name, "codec", variant.codec));
      ENGRAM_RETURN_IF_ERROR(file.write_attribute(name, "element_type", to_string(variant.type)));
      ENGRAM_RETURN_IF_ERROR(variant.write_shapes(file, name + "/shape"));
      names_.push_back(name);
    }
    return names_.empty() ? Status() : file.write_strings(group + "/media_groups", names_);
  }

 private:
  struct Variant {
    std::string path;
    std::string codec;
    idf::ElementType type;
    idf::Shape shape;  ///< Of the first medium.
    BlobColumn blobs;
    std::vector<int64_t> shapes;  ///< Row-major [rows, rank].
    size_t rows = 0;
    bool has_one_shape = true;

    /// Rows without this medium have no bytes.
    void fill(size_t until) {
      for (; rows < until; ++rows) {
        blobs.append({});
        shapes.insert(shapes.end(), shape.begin(), shape.end());
      }
    }

    void append(const PackedMedium& medium) {
      blobs.append(medium.bytes.bytes());
      shapes.insert(shapes.end(), medium.shape.begin(), medium.shape.end());
      has_one_shape = has_one_shape && medium.shape == shape;
      ++rows;
    }

    Status write_shapes(h5::File& file, const std::string& dataset) const {
      if (has_one_shape) return write_column(file, dataset, shape);
      const std::vector<uint64_t> size{rows, shape.size()};
      return file.write(dataset, h5::Type::kInt64, size, std::as_bytes(std::span(shapes)),
                        Storage::kCompressed);
    }
  };

  [[nodiscard]] bool has_media_below(const std::string& path) const {
    return std::ranges::any_of(variants_, [&path](const Variant& variant) {
      return variant.path.size() > path.size() && variant.path.starts_with(path + '/');
    });
  }

  Variant& find(const PackedMedium& medium) {
    for (Variant& variant : variants_)
      if (variant.path == medium.path && variant.codec == medium.codec &&
          variant.type == medium.type && variant.shape.size() == medium.shape.size())
        return variant;
    return variants_.emplace_back(
        Variant{medium.path, medium.codec, medium.type, medium.shape, {}, {}});
  }

  std::vector<Variant> variants_;
  std::vector<std::string> names_;
};

/// What the online filters did, per row; a snapshot's figures stand at its first row.
struct AccountingColumns {
  std::vector<uint64_t> raw_bytes, dropped, dropped_bytes;

  void append(const Row& row) {
    const bool is_first = row.instance == 0;
    raw_bytes.push_back(is_first ? row.snapshot->raw_bytes : 0);
    dropped.push_back(is_first ? row.snapshot->dropped : 0);
    dropped_bytes.push_back(is_first ? row.snapshot->dropped_bytes : 0);
  }

  Status write(h5::File& file, const std::string& group) const {
    ENGRAM_RETURN_IF_ERROR(write_figures(file, group + "/accounting/raw_bytes", raw_bytes));
    ENGRAM_RETURN_IF_ERROR(write_figures(file, group + "/accounting/dropped", dropped));
    return write_figures(file, group + "/accounting/dropped_bytes", dropped_bytes);
  }

  /// Nothing where all are zero.
  static Status write_figures(h5::File& file, const std::string& path,
                              const std::vector<uint64_t>& figures) {
    const bool is_any = std::ranges::any_of(figures, [](uint64_t figure) { return figure != 0; });
    return is_any ? write_row_column(file, path, figures) : Status();
  }
};

Status write_entity_header(h5::File& file, const std::string& group, const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(file.make_group(group));
  return file.write_attribute(group, "memory_id", entity.to_string());
}

Status write_recorded_entity(h5::File& file, const MemoryId& entity,
                             const RecordedEntity& recorded) {
  std::vector<Row> rows;
  for (const PackedSnapshot& snapshot : recorded.snapshots)
    for (size_t i = 0; i < snapshot.instances.size(); ++i) rows.push_back({&snapshot, i});
  const std::string group = segment_group(entity);
  const idf::Layout layout = most_common_layout(rows);
  ENGRAM_RETURN_IF_ERROR(write_entity_header(file, group, entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto layout_bytes,
                          idf::encode(layout.to_data(), idf::kMaxDepth + idf::kContainerDepth));
  const uint64_t layout_size = layout_bytes.size();
  ENGRAM_RETURN_IF_ERROR(file.write(group + "/layout", h5::Type::kUInt8, {&layout_size, 1},
                                    layout_bytes, Storage::kCompressed));
  RowColumns columns;
  AccountingColumns accounting;
  TensorColumns tensors(layout, rows.size());
  RemainderColumn remainder;
  MediaColumns media;
  for (size_t i = 0; i < rows.size(); ++i) {
    const PackedInstance& packed = rows[i].packed();
    columns.append(rows[i].snapshot->time, rows[i].instance, packed.metadata);
    accounting.append(rows[i]);
    auto parts = layout.split(packed.value.rest);
    if (parts.ok()) {
      tensors.set(i, parts->tensors);
      remainder.append(std::move(parts->remainder));
    } else {
      remainder.append(Dict{{"value", packed.value.rest}});
    }
    ENGRAM_RETURN_IF_ERROR(media.append(i, packed.value.media));
  }
  ENGRAM_RETURN_IF_ERROR(columns.write(file, group));
  ENGRAM_RETURN_IF_ERROR(accounting.write(file, group));
  ENGRAM_RETURN_IF_ERROR(tensors.write(file, group));
  ENGRAM_RETURN_IF_ERROR(remainder.write(file, group + "/remainder"));
  return media.write(file, group, rows.size());
}

/// The types of the segment's entities, so that the file explains itself.
Status write_types(h5::File& file, const SegmentInfo& info, const SegmentTypes& types) {
  std::vector<MemoryId> entities;
  for (const SegmentEntity& entity : info.entities) entities.push_back(entity.id);
  const SegmentTypes needed = types.of_entities(entities);
  if (needed.all().empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, idf::to_json_text(needed.to_data()));
  return file.write_strings(kSegmentTypes, {&text, 1});
}

Result<h5::File> create_segment(const std::filesystem::path& path, std::string_view kind) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "format", "engram segment"));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute("/", "format_version", int64_t{kSegmentFormatVersion}));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "kind", kind));
  return file;
}

/// Closes the file; the entities' bytes sum to the file's.
Status finish_segment(h5::File file, SegmentInfo& info) {
  const std::filesystem::path path = file.path();
  for (SegmentEntity& entity : info.entities) {
    ENGRAM_ASSIGN_OR_RETURN(entity.stored_bytes, file.storage_bytes(segment_group(entity.id)));
  }
  ENGRAM_RETURN_IF_ERROR(file.close());
  info.bytes = std::filesystem::file_size(path);
  spread_overhead(info);
  ENGRAM_ASSIGN_OR_RETURN(info.checksum, checksum_of_file(path));
  return {};
}

SegmentEntity summarise(const MemoryId& id, const RecordedEntity& recorded) {
  SegmentEntity entity;
  entity.id = id;
  entity.snapshots = recorded.snapshots.size();
  entity.dropped = recorded.trailing_dropped;
  entity.dropped_bytes = recorded.trailing_dropped_bytes;
  if (!recorded.snapshots.empty()) {
    entity.first = recorded.snapshots.front().time;
    entity.last = recorded.snapshots.back().time;
  }
  for (const PackedSnapshot& snapshot : recorded.snapshots) {
    entity.rows += snapshot.instances.size();
    entity.raw_bytes += snapshot.raw_bytes;
    entity.dropped += snapshot.dropped;
    entity.dropped_bytes += snapshot.dropped_bytes;
  }
  return entity;
}

}  // namespace

void spread_overhead(SegmentInfo& info) {
  uint64_t data_bytes = 0;
  for (const SegmentEntity& entity : info.entities) data_bytes += entity.stored_bytes;
  uint64_t overhead = info.bytes - std::min(info.bytes, data_bytes);
  uint64_t left = info.entities.size();
  for (SegmentEntity& entity : info.entities) {
    const uint64_t share = overhead / left--;
    entity.stored_bytes += share;
    overhead -= share;
  }
}

void add_to_sums(LatentSums& sums, const MeasuredError& error) {
  if (!std::isnan(error.image_mse)) {
    ++sums.image_rows;
    sums.image_mse += error.image_mse;
    sums.psnr_db += error.image_mse <= 0
                        ? kPsnrCapDb
                        : std::min(kPsnrCapDb, 10 * std::log10(255.0 * 255.0 / error.image_mse));
  }
  if (!std::isnan(error.number_mse)) {
    ++sums.number_rows;
    sums.number_mse += error.number_mse;
  }
}

Result<SegmentInfo> write_recorded_segment(const std::filesystem::path& file,
                                           const std::map<MemoryId, RecordedEntity>& entities,
                                           const SegmentTypes& types) {
  SegmentInfo info;
  info.kind = SegmentKind::kRecorded;
  ENGRAM_ASSIGN_OR_RETURN(h5::File segment, create_segment(file, "recorded"));
  for (const auto& [id, recorded] : entities) {
    ENGRAM_RETURN_IF_ERROR(write_recorded_entity(segment, id, recorded));
    info.entities.push_back(summarise(id, recorded));
  }
  ENGRAM_RETURN_IF_ERROR(write_types(segment, info, types));
  ENGRAM_RETURN_IF_ERROR(finish_segment(std::move(segment), info));
  return info;
}

Result<SegmentInfo> write_latent_segment(const std::filesystem::path& file, const MemoryId& entity,
                                         const std::vector<LatentSnapshot>& snapshots) {
  SegmentInfo info;
  info.kind = SegmentKind::kLatent;
  SegmentEntity& summary = info.entities.emplace_back();
  summary.id = entity;
  ENGRAM_ASSIGN_OR_RETURN(h5::File segment, create_segment(file, "latent"));
  const std::string group = segment_group(entity);
  RowColumns columns;
  BlobColumn codes;
  RemainderColumn remainder;
  std::vector<double> image_mse, number_mse;
  for (const LatentSnapshot& snapshot : snapshots) {
    for (size_t i = 0; i < snapshot.instances.size(); ++i) {
      const LatentInstance& instance = snapshot.instances[i];
      columns.append(snapshot.time, i, instance.metadata);
      codes.append(instance.latent.code.bytes());
      remainder.append(instance.latent.remainder);
      image_mse.push_back(instance.error.image_mse);
      number_mse.push_back(instance.error.number_mse);
      add_to_sums(summary.latent, instance.error);
    }
  }
  ENGRAM_RETURN_IF_ERROR(write_entity_header(segment, group, entity));
  if (!snapshots.empty()) {
    summary.first = snapshots.front().time;
    summary.last = snapshots.back().time;
    summary.latent.model_version = snapshots.front().model_version;
  }
  ENGRAM_RETURN_IF_ERROR(
      segment.write_attribute(group, "model_version", int64_t{summary.latent.model_version}));
  ENGRAM_RETURN_IF_ERROR(columns.write(segment, group));
  ENGRAM_RETURN_IF_ERROR(codes.write(segment, group + "/latent"));
  ENGRAM_RETURN_IF_ERROR(remainder.write(segment, group + "/remainder"));
  ENGRAM_RETURN_IF_ERROR(write_row_column(segment, group + "/error/image_mse", image_mse));
  ENGRAM_RETURN_IF_ERROR(write_row_column(segment, group + "/error/number_mse", number_mse));
  summary.snapshots = snapshots.size();
  summary.rows = columns.rows();
  ENGRAM_RETURN_IF_ERROR(finish_segment(std::move(segment), info));
  return info;
}

}  // namespace engram::ltm
