// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tum_writer.h"

#include <fstream>

#include "datasets/recordings/merged_snapshots.h"
#include "datasets/recordings/stored_streams.h"
#include "ltm/codec/png.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

constexpr int64_t kNsPerSecond = 1'000'000'000;

/// Returns a member that is an array of this type; null if there is none.
const idf::NdArray* array_of(const idf::Data& value, std::string_view name, idf::ElementType type) {
  const idf::Data* member = value.is<idf::Dict>() ? value.at(name) : nullptr;
  const auto* array = member == nullptr ? nullptr : member->get_if<idf::NdArray>();
  return array != nullptr && array->type() == type ? array : nullptr;
}

bool is_vector(const idf::NdArray* array, int64_t size) {
  return array != nullptr && array->shape() == idf::Shape{size};
}

/// Returns the table that a value fits; empty if there is none.
std::string table_of(const ltm::MemoryId& entity, const idf::Data& value) {
  using enum idf::ElementType;
  if (const auto* image = array_of(value, "image", kUInt8);
      image != nullptr && ltm::png_codec().accepts(kUInt8, image->shape()))
    return "rgb";
  if (const auto* depth = array_of(value, "depth", kUInt16);
      depth != nullptr && ltm::png_codec().accepts(kUInt16, depth->shape()))
    return "depth";
  if (is_vector(array_of(value, "position", kFloat64), 3) &&
      is_vector(array_of(value, "orientation", kFloat64), 4))
    return "groundtruth";
  if (entity.names().back() == "accelerometer" && is_vector(array_of(value, "values", kFloat64), 3))
    return "accelerometer";
  return "";
}

/// The number of members that a table can hold; further members are not held.
size_t members_of(const std::string& table) {
  return table == "groundtruth" ? 2 : 1;
}

/// Writes seconds since the epoch exactly, with nine digits.
std::string seconds_of(Time time) {
  return fmt::format("{}.{:09}", to_ns(time) / kNsPerSecond, to_ns(time) % kNsPerSecond);
}

/// A folder with a hidden name until it is complete. If it is never completed, it is removed.
class HiddenFolder {
 public:
  explicit HiddenFolder(const std::filesystem::path& path)
      : final_(std::filesystem::absolute(path).lexically_normal()),
        hidden_(final_.parent_path() / ("." + final_.filename().string() + ".part")) {
    remove();
  }
  HiddenFolder(const HiddenFolder&) = delete;
  HiddenFolder& operator=(const HiddenFolder&) = delete;
  ~HiddenFolder() { remove(); }

  [[nodiscard]] const std::filesystem::path& path() const { return hidden_; }

  Status publish() const {
    std::error_code error;
    std::filesystem::rename(hidden_, final_, error);
    if (error) return unavailable("'{}': {}", final_.string(), error.message());
    return {};
  }

 private:
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove_all(hidden_, ignored);
  }

  std::filesystem::path final_;
  std::filesystem::path hidden_;
};

class TumWriter {
 public:
  explicit TumWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Adds a value, or counts it if it does not fit its table.
  Status add(const std::string& table, const ltm::MemoryId& entity, Time time,
             const idf::Data& value) {
    if (table_of(entity, value) != table) return count("values of another kind than the newest");
    if (to_ns(time) < 0) return count("values before 1970");
    if (value.get<idf::Dict>().size() > members_of(table))
      ENGRAM_RETURN_IF_ERROR(count("members beside those of the format"));
    ENGRAM_ASSIGN_OR_RETURN(const std::string words, words_of(table, time, value));
    std::ofstream& lines = tables_[table];
    if (!lines.is_open()) {
      ENGRAM_RETURN_IF_ERROR(make_directories(folder_));
      lines.open(folder_ / (table + ".txt"), std::ios::binary);
      lines << "# " << entity.to_string() << '\n';
      ++report_.files;
    }
    lines << seconds_of(time) << ' ' << words << '\n';
    if (!lines) return unavailable("'{}': cannot write", (folder_ / (table + ".txt")).string());
    ++report_.snapshots;
    ++report_.instances;
    return {};
  }

  Status close() {
    for (auto& [table, lines] : tables_) {
      const auto path = folder_ / (table + ".txt");
      lines.close();
      if (!lines) return unavailable("'{}': cannot write", path.string());
      std::error_code ignored;
      report_.bytes += std::filesystem::file_size(path, ignored);
    }
    return {};
  }

  Status count(const std::string& what) {
    ++report_.not_carried[what];
    return {};
  }
  [[nodiscard]] const ExportReport& report() const { return report_; }

 private:
  Result<std::string> words_of(const std::string& table, Time time, const idf::Data& value) {
    if (table == "rgb" || table == "depth") return image_of(table, time, value);
    if (table == "accelerometer") {
      const auto a = value.at("values")->get<idf::NdArray>().values<double>();
      return fmt::format("{} {} {}", a[0], a[1], a[2]);
    }
    const auto p = value.at("position")->get<idf::NdArray>().values<double>();
    const auto q = value.at("orientation")->get<idf::NdArray>().values<double>();
    return fmt::format("{} {} {} {} {} {} {}", p[0], p[1], p[2], q[1], q[2], q[3], q[0]);
  }

  Result<std::string> image_of(const std::string& table, Time time, const idf::Data& value) {
    const auto& image = value.at(table == "rgb" ? "image" : "depth")->get<idf::NdArray>();
    ENGRAM_ASSIGN_OR_RETURN(const auto png, ltm::png_codec().encode(image));
    const std::string name = fmt::format("{}/{}.png", table, seconds_of(time));
    ENGRAM_RETURN_IF_ERROR(make_directories(folder_ / table));
    ENGRAM_ASSIGN_OR_RETURN(File file, File::open(folder_ / name, File::Mode::kCreate));
    ENGRAM_RETURN_IF_ERROR(file.append(png));
    ++report_.files;
    report_.bytes += png.size();
    return name;
  }

  std::filesystem::path folder_;
  std::map<std::string, std::ofstream> tables_;
  ExportReport report_;
};

}  // namespace

Result<TumPlan> plan_tum(ltm::Recall& recall, const ltm::Query& query,
                         const WritingOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  TumPlan plan;
  std::map<std::string, ltm::MemoryId> taken;
  for (const ltm::MemoryId& entity : entities) {
    if (is_description(entity)) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto newest, newest_snapshot(recall, entity, options.recall));
    if (!newest || newest->instances.empty()) continue;
    const idf::Data& value = newest->instances.front().data;
    const std::string table = table_of(entity, value);
    if (table.empty()) {
      ++plan.not_held[entity.to_string() + ", no image, depth, pose or accelerometer"];
    } else if (!taken.emplace(table, entity).second) {
      ++plan.not_held[entity.to_string() + ", beside the first entity of " + table + ".txt"];
    } else {
      plan.tables.emplace(entity, table);
      tell_metadata(*newest, plan.not_held);
      if (value.get<idf::Dict>().size() > members_of(table))
        ++plan.not_held["members beside those of the format"];
    }
  }
  return plan;
}

Result<ExportReport> write_tum(ltm::Recall& recall, const ltm::Query& query,
                               const std::filesystem::path& path, const WritingOptions& options,
                               const ProgressSink& progress, const std::stop_token& stop) {
  if (std::filesystem::exists(path)) return already_exists("'{}' exists", path.string());
  ENGRAM_ASSIGN_OR_RETURN(const TumPlan plan, plan_tum(recall, query, options));
  if (plan.tables.empty())
    return not_found("store '{}': query '{}' asks for nothing that a TUM folder can hold",
                     recall.store().path().string(), query.to_string());
  const HiddenFolder folder(path);
  TumWriter writer(folder.path());
  ENGRAM_ASSIGN_OR_RETURN(auto snapshots, MergedSnapshots::create(recall, query, options.recall));
  while (true) {
    if (stop.stop_requested())
      return cancelled("export stopped after {} snapshots; nothing was kept",
                       writer.report().snapshots);
    ENGRAM_ASSIGN_OR_RETURN(const auto item, snapshots.next());
    if (!item) break;
    const auto table = plan.tables.find(item->entity);
    if (table == plan.tables.end() || item->snapshot.instances.empty()) continue;
    ENGRAM_RETURN_IF_ERROR(writer.add(table->second, item->entity, item->snapshot.time,
                                      item->snapshot.instances[0].data));
    if (progress)
      progress({"export " + item->entity.to_string(), writer.report().snapshots, 0,
                to_string(item->snapshot.time)});
  }
  ENGRAM_RETURN_IF_ERROR(writer.close());
  if (writer.report().snapshots == 0)
    return not_found("store '{}': no value of query '{}' fits into a TUM folder",
                     recall.store().path().string(), query.to_string());
  ENGRAM_RETURN_IF_ERROR(folder.publish());
  ExportReport report = writer.report();
  for (const auto& [what, count] : plan.not_held) report.not_carried.emplace(what, count);
  return report;
}

}  // namespace engram::datasets
