// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/prior.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <span>

#include "ltm/core/config.h"
#include "ltm/core/file.h"
#include "ltm/idf/cast.h"
#include "ltm/idf/type_check.h"
#include "ltm/idf/type_xml.h"
#include "memory/prior/picture_file.h"
#include "memory/prior/prior_files.h"
#include "memory/prior/written_as.h"
#include "memory/prior/written_value.h"

namespace engram::memory {

using idf::Data;
using ltm::MemoryId;

namespace {

constexpr const char* kProvider = "prior";
constexpr std::string_view kInstances = "instances";
/// The bound of problems in one message.
constexpr size_t kMaxTold = 100;

/// The instances of an entity; it also locates problems in them.
struct PriorValue {
  std::vector<Data> instances;
  std::optional<WrittenValue> written;  ///< Of JSON and YAML files.
  bool is_list = false;                 ///< The instances are a list under the key `instances`.

  [[nodiscard]] std::string problem(const PriorFile& file, size_t instance, const std::string& path,
                                    const std::string& message) const {
    if (!written) return fmt::format("{}: {}", file.path.string(), message);
    if (!is_list) return written->problem_at(path, message);
    const std::string above = idf::join_path(kInstances, std::to_string(instance));
    return written->problem_at(path.empty() ? above : above + "/" + path, message);
  }
};

Result<PriorValue> of_written(Result<WrittenValue> read) {
  if (!read.ok()) return read.status();
  PriorValue value;
  value.written = *std::move(read);
  const Data& data = value.written->data();
  const auto* dict = data.get_if<idf::Dict>();
  const Data* list = dict != nullptr && dict->size() == 1 ? dict->find(kInstances) : nullptr;
  if (list == nullptr || !list->is<idf::List>()) {
    value.instances = {data};
    return value;
  }
  value.is_list = true;
  value.instances = list->get<idf::List>();
  if (value.instances.empty())
    return invalid_argument("{}", value.written->problem_at(kInstances, "has no instance"));
  return value;
}

/// Reads a file. Messages of errors name it.
Result<PriorValue> read_value(const PriorFile& file, const PriorOptions& options) {
  const std::string name = file.path.string();
  if (file.kind == PriorFileKind::kJson && file.bytes > options.max_json_bytes)
    return invalid_argument("{}: has {} bytes, of JSON at most {} are read", name, file.bytes,
                            options.max_json_bytes);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer buffer, read_file(file.path));
  switch (file.kind) {
    case PriorFileKind::kJson:
      return of_written(WrittenValue::parse_json(std::string(as_text(buffer.bytes())), name));
    case PriorFileKind::kYaml:
      return of_written(WrittenValue::parse_yaml(as_text(buffer.bytes()), name));
    case PriorFileKind::kPicture: {
      auto picture = read_picture(buffer.bytes(), options.max_pixels);
      if (!picture.ok()) return picture.status().with_context(name);
      return PriorValue{{Data(*std::move(picture))}, {}, false};
    }
    default:
      break;
  }
  const auto size = static_cast<int64_t>(buffer.size());
  ENGRAM_ASSIGN_OR_RETURN(auto bytes,
                          idf::NdArray::create(idf::ElementType::kUInt8, {size}, buffer));
  return PriorValue{
      {Data(idf::Dict{{"name", file.id.names().back()}, {"bytes", std::move(bytes)}})}, {}, false};
}

/// Returns the last object: the types before it are its parts. Without objects it is the last type.
const idf::Type& type_of_segment(const idf::TypeFile& file) {
  const auto last = std::find_if(file.types.rbegin(), file.types.rend(), [](const idf::Type& type) {
    return type.kind() == idf::TypeKind::kObject;
  });
  return last == file.types.rend() ? file.types.back() : *last;
}

/// Loads a directory file by file.
class PriorLoader {
 public:
  explicit PriorLoader(const PriorOptions& options) : options_(options) {}

  Result<PriorKnowledge> load(const std::filesystem::path& directory) {
    ENGRAM_ASSIGN_OR_RETURN(
        PriorFiles found, find_prior_files(directory, options_.max_files, options_.max_file_bytes));
    knowledge_.problems = std::move(found.problems);
    if (found.settings)
      if (const Status status = read_time(*found.settings); !status.ok()) problem(status.message());
    declare_types(directory, found.files);
    for (const PriorFile& file : found.files)
      if (file.kind != PriorFileKind::kType) take(file);
    if (!knowledge_.problems.empty() && !options_.goes_on) return refusal();
    return std::move(knowledge_);
  }

 private:
  [[nodiscard]] Status refusal() const {
    const auto& problems = knowledge_.problems;
    const size_t told = std::min(problems.size(), kMaxTold);
    return invalid_argument(
        "prior knowledge: nothing of it is loaded, for\n{}{}",
        fmt::join(std::span(problems).first(told), "\n"),
        told < problems.size() ? fmt::format("\n... and {} more", problems.size() - told) : "");
  }

  void problem(std::string text) { knowledge_.problems.push_back(std::move(text)); }

  Status read_time(const std::filesystem::path& path) {
    ENGRAM_ASSIGN_OR_RETURN(const ConfigValue config, ConfigValue::read_file(path));
    ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, config.map());
    if (const auto value = map.find("time")) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string text, value->text());
      const auto time = parse_time(text);
      if (!time.ok()) return value->error(time.status());
      time_ = *time;
    }
    return map.finish();
  }

  /// Declares the types of core segments first, because those of provider segments extend them.
  void declare_types(const std::filesystem::path& directory, const std::vector<PriorFile>& files) {
    for (const size_t level : {size_t{2}, size_t{3}})
      for (const PriorFile& file : files)
        if (file.kind == PriorFileKind::kType && file.id.depth() == level)
          declare_type(directory, file);
  }

  void declare_type(const std::filesystem::path& directory, const PriorFile& file) {
    const auto types =
        idf::read_type_file(file.path, {file.path.parent_path().parent_path(), directory});
    if (!types.ok()) return problem(types.status().message());
    for (const idf::TypeInclude& include : types->includes)
      if (!is_inside(include.path, directory))
        return problem(fmt::format("{}: includes '{}', which is outside of the directory",
                                   file.path.string(), include.path.string()));
    if (types->types.empty())
      return problem(fmt::format("{}: defines no type, needs one", file.path.string()));
    const Status status = knowledge_.types.declare(file.id, type_of_segment(*types));
    if (!status.ok()) problem(fmt::format("{}: {}", file.path.string(), status.message()));
  }

  void take(const PriorFile& file) {
    if (!seen_.insert(file.id).second || is_full_) return;
    auto value = read_value(file, options_);
    if (!value.ok()) return problem(value.status().message());
    const idf::Type* type = knowledge_.types.of_entity(file.id);
    const Time time = time_.value_or(file.changed);
    ltm::Snapshot snapshot{file.id, time, {}};
    bool fits = true;
    for (size_t i = 0; i < value->instances.size(); ++i) {
      if (type != nullptr) fits = cast(file, *value, i, *type) && fits;
      snapshot.instances.push_back(
          {value->instances[i], {.created = time, .sent = time, .provider = kProvider}});
    }
    if (!fits) return;
    bytes_ += snapshot.raw_bytes();
    if (bytes_ > options_.max_bytes) {
      is_full_ = true;
      return problem(fmt::format("{}: makes more than {} bytes, which are loaded at most",
                                 file.path.string(), options_.max_bytes));
    }
    knowledge_.commits[file.id.names().front()].updates.push_back(std::move(snapshot));
  }

  /// Casts an instance to its type; false where that is not possible.
  bool cast(const PriorFile& file, PriorValue& value, size_t index, const idf::Type& type) {
    Data& data = value.instances[index];
    data = written_as(type, std::move(data));
    if (idf::check(data, type).empty()) return true;
    idf::CastResult cast = idf::cast(data, type);
    bool fits = true;
    for (const idf::CastNote& note : cast.notes) {
      // Decimal numbers in a text are always rounded to the type: that is no problem.
      if (note.kind == idf::CastNote::Kind::kNarrowed) continue;
      fits = false;
      problem(value.problem(file, index, note.what.path, note.to_string()));
    }
    data = std::move(cast.value);
    return fits;
  }

  const PriorOptions& options_;
  PriorKnowledge knowledge_;
  std::optional<Time> time_;
  std::set<MemoryId> seen_;
  uint64_t bytes_ = 0;
  bool is_full_ = false;
};

}  // namespace

Result<PriorKnowledge> load_prior(const std::filesystem::path& directory,
                                  const PriorOptions& options) {
  return PriorLoader(options).load(directory);
}

}  // namespace engram::memory
