// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "datasets/export_file.h"
#include "datasets/export_formats.h"
#include "datasets/export_names.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/layout.h"

namespace engram::datasets {

namespace {

/// The maximum number of elements of an array that is written to columns.
constexpr int64_t kMaxElements = 64;
/// The maximum number of tables of one entity. Each has its own columns, and all are open at once.
constexpr size_t kMaxTables = 64;

/// Quotes a text as RFC 4180 requires.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

/// The numbers of one instance: the names of their columns, and their texts.
struct Row {
  std::string names;
  std::string values;
};

void add_array(const idf::TensorMember& member, const idf::NdArray& array, Row& row) {
  const bool is_scalar = member.shape.empty();
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
    const auto values = array.values<T>();
    for (size_t i = 0; i < values.size(); ++i) {
      row.names += "," + quoted(is_scalar ? member.path.empty() ? "value" : member.path
                                          : fmt::format("{}[{}]", member.path, i));
      // fmt would print a byte as a character.
      if constexpr (sizeof(T) == 1)
        row.values += fmt::format(",{}", static_cast<int>(values[i]));
      else
        row.values += fmt::format(",{}", values[i]);
    }
  });
}

int64_t count_of(const idf::Shape& shape) {
  int64_t count = 1;
  for (const int64_t size : shape) count *= size;
  return count;
}

/// Writes <entity>.csv with a line per instance and a column per number. Instances with other
/// columns go to another table (#2, #3).
class CsvSink : public SnapshotSink {
 public:
  explicit CsvSink(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Status begin(const ltm::MemoryId& entity) override {
    ENGRAM_RETURN_IF_ERROR(close());
    entity_ = entity;
    return {};
  }

  Status add(const ltm::SnapshotResult& snapshot) override {
    ++report_.snapshots;
    for (const ltm::InstanceResult& instance : snapshot.instances)
      ENGRAM_RETURN_IF_ERROR(add(snapshot, instance));
    return {};
  }

  Status finish() override { return close(); }

 private:
  Status add(const ltm::SnapshotResult& snapshot, const ltm::InstanceResult& instance) {
    ++report_.instances;
    ENGRAM_ASSIGN_OR_RETURN(const Row row, row_of(instance.data));
    ENGRAM_ASSIGN_OR_RETURN(ExportFile * table, table_of(row.names));
    if (table == nullptr) {
      ++report_.not_carried[fmt::format("instances beyond {} kinds of lines", kMaxTables)];
      return {};
    }
    return table->write(fmt::format("{},{},{},{}{}\n", to_ns(snapshot.time),
                                    iso_time(snapshot.time), instance.index,
                                    ltm::to_string(snapshot.source), row.values));
  }

  Result<Row> row_of(const idf::Data& data) {
    const idf::Layout layout = idf::Layout::of(data);
    ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue parts, layout.split(data));
    Row row;
    for (size_t i = 0; i < parts.tensors.size(); ++i) {
      const idf::TensorMember& member = layout.members()[i];
      if (member.kind == idf::MemberKind::kImage)
        ++report_.not_carried["images"];
      else if (count_of(member.shape) > kMaxElements)
        ++report_.not_carried[fmt::format("arrays of more than {} elements", kMaxElements)];
      else
        add_array(member, parts.tensors[i], row);
    }
    for (const idf::Data& rest : parts.remainder)
      if (!rest.is<idf::None>()) ++report_.not_carried[rest.is<idf::List>() ? "lists" : "texts"];
    return row;
  }

  /// Returns the table with these columns; null if there are too many tables.
  Result<ExportFile*> table_of(const std::string& names) {
    if (const auto known = tables_.find(names); known != tables_.end()) return &known->second;
    if (tables_.size() >= kMaxTables) return static_cast<ExportFile*>(nullptr);
    const std::string number = tables_.empty() ? "" : fmt::format("#{}", tables_.size() + 1);
    ENGRAM_ASSIGN_OR_RETURN(
        ExportFile made,
        ExportFile::create(directory_ / (export_folder(entity_) + number + ".csv")));
    ENGRAM_RETURN_IF_ERROR(made.write("time_ns,time,instance,source" + names + "\n"));
    return &tables_.emplace(names, std::move(made)).first->second;
  }

  Status close() {
    for (auto& [names, table] : tables_) ENGRAM_RETURN_IF_ERROR(table.close(report_));
    tables_.clear();
    return {};
  }

  std::filesystem::path directory_;
  ltm::MemoryId entity_;
  std::map<std::string, ExportFile> tables_;  ///< Keyed by the names of their columns.
};

}  // namespace

std::unique_ptr<SnapshotSink> make_csv_sink(const std::filesystem::path& directory) {
  return std::make_unique<CsvSink>(directory);
}

}  // namespace engram::datasets
