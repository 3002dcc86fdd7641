// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <set>

#include "cli/command.h"
#include "datasets/recordings/snapshot_cursor.h"
#include "ltm/recall/store_conditions.h"
#include "ltm/store/store_reader.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kLsFooter = R"(What is listed:
  no ID                  the memories
  Memory                 its core segments, and so on down to the entities
  Memory/Core/Prov/Ent   the times of the entity's snapshots
  .../TIME               the instances of that snapshot
  a query                what it asks for: entities (NAMES) or snapshots (NAMES @ SELECTOR)
Nothing is decoded. Bytes are those of recorded forms and latents, without models.

Examples:
  engram ls robot.engram
  engram ls robot.engram Vision/RGB/head
  engram ls robot.engram Vision/RGB/head/cam --limit 10
  engram ls robot.engram '.*/.*/.*/cam @ last:2s'
  engram ls robot.engram '.*/.*/.*/cup @ all near 0.4,0,0.9 0.3m')";

struct LsArguments {
  std::string store;
  std::string what;
  uint64_t limit = 50;
  bool is_json = false;
};

/// One line of a listing: an entity, or everything below a name.
struct Line {
  uint64_t entities = 0;
  uint64_t snapshots = 0;
  uint64_t bytes = 0;
  std::optional<Time> first;
  std::optional<Time> last;

  void add(const Line& other) {
    entities += other.entities;
    snapshots += other.snapshots;
    bytes += other.bytes;
    if (other.first) first = first ? std::min(*first, *other.first) : *other.first;
    if (other.last) last = last ? std::max(*last, *other.last) : *other.last;
  }
};

class Listing {
 public:
  Listing(ltm::StoreReader& reader, const LsArguments& arguments)
      : reader_(reader), arguments_(arguments) {}

  /// Lists the level directly below an ID.
  Status list(const ltm::MemoryId& id) {
    if (id.has_entity()) return id.time() ? list_instances(id) : list_snapshots(id, all(), {});
    const size_t depth = id.names().size() + 1;
    std::map<std::string, Line> lines;
    for (const ltm::MemoryId& entity : reader_.entities()) {
      if (!id.is_prefix_of(entity)) continue;
      const std::vector<std::string>& names = entity.names();
      const auto below =
          ltm::MemoryId::from_names({names.begin(), names.begin() + static_cast<ptrdiff_t>(depth)});
      ENGRAM_ASSIGN_OR_RETURN(const Line line, line_of(entity));
      lines[below->to_string()].add(line);
    }
    if (lines.empty() && id.depth() > 0) return nothing(id.to_string());
    add(lines, depth == ltm::MemoryId::kNameLevels);
    return {};
  }

  Status list(const ltm::Query& query, bool has_selector) {
    std::map<std::string, Line> lines;
    bool is_found = false;
    ltm::StoreConditions conditions(reader_.path(), query);
    for (const ltm::MemoryId& entity : reader_.entities()) {
      if (!query.matches(entity)) continue;
      is_found = true;
      if (has_selector) {
        ENGRAM_RETURN_IF_ERROR(
            list_snapshots(entity, query.snapshots_of(entity), conditions.of(entity)));
        continue;
      }
      ENGRAM_ASSIGN_OR_RETURN(lines[entity.to_string()], line_of(entity));
    }
    if (!is_found) return nothing(query.to_string());
    if (!has_selector) add(lines, true);
    return {};
  }

  void print_all() const {
    if (arguments_.is_json)
      print_json(json_);
    else if (!text_.empty())
      print(text_);
  }

 private:
  static std::vector<ltm::SnapshotQuery> all() { return {{ltm::select::All{}, {}}}; }

  Status nothing(const std::string& what) const {
    return not_found("store '{}': there is nothing at '{}'", arguments_.store, what);
  }

  /// Reads the manifest once for all entities.
  const std::map<ltm::MemoryId, uint64_t>& bytes() {
    if (!bytes_.empty()) return bytes_;
    for (const ltm::SegmentInfo& segment : reader_.manifest().segments)
      for (const ltm::SegmentEntity& part : segment.entities) bytes_[part.id] += part.stored_bytes;
    return bytes_;
  }

  Result<Line> line_of(const ltm::MemoryId& entity) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(entity));
    Line line{1, 0, 0, timeline->first(), timeline->last()};
    ENGRAM_ASSIGN_OR_RETURN(line.snapshots, timeline->count());
    if (const auto known = bytes().find(entity); known != bytes().end()) line.bytes = known->second;
    return line;
  }

  void add(const std::map<std::string, Line>& lines, bool are_entities) {
    reports::TextTable table(
        are_entities
            ? std::vector<std::string>{"entity", "snapshots", "first", "last", "sealed"}
            : std::vector<std::string>{"name", "entities", "snapshots", "first", "last", "sealed"});
    json_["entries"] = Json::array();
    for (const auto& [name, line] : lines) {
      std::vector<std::string> row{name, reports::count_text(line.snapshots),
                                   line.first ? to_string(*line.first) : "-",
                                   line.last ? to_string(*line.last) : "-",
                                   reports::bytes_text(static_cast<double>(line.bytes))};
      if (!are_entities) row.insert(row.begin() + 1, reports::count_text(line.entities));
      table.add(std::move(row));
      Json entry{{"id", name},
                 {"entities", line.entities},
                 {"snapshots", line.snapshots},
                 {"sealed_bytes", line.bytes}};
      if (line.first) entry["first_ns"] = to_ns(*line.first);
      if (line.last) entry["last_ns"] = to_ns(*line.last);
      json_["entries"].push_back(std::move(entry));
    }
    text_ = lines.empty() ? "It is empty." : table.to_string();
  }

  Status list_snapshots(const ltm::MemoryId& entity, const std::vector<ltm::SnapshotQuery>& queries,
                        const ltm::ListMoments& listed) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(auto cursor,
                            datasets::SnapshotCursor::create(*timeline, queries, listed));
    Json times = Json::array();
    text_ += (text_.empty() ? "" : "\n") + entity.printable();
    bool has_more = false;
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(const auto step, cursor.next());
      if (!step || step->is_future) break;
      has_more = times.size() >= arguments_.limit;
      if (has_more) break;
      const char* form = !step->entry.latent    ? "recorded"
                         : step->entry.recorded ? "recorded and latent"
                                                : "latent";
      text_ += fmt::format("\n  {}  {}", to_string(step->entry.time), form);
      times.push_back({{"time_ns", to_ns(step->entry.time)}, {"form", form}});
    }
    Json json{{"id", entity.to_string()}, {"snapshots", times}, {"has_more", has_more}};
    if (has_more) ENGRAM_RETURN_IF_ERROR(tell_more(*timeline, queries, times.size(), json));
    json_["entities"].push_back(std::move(json));
    return {};
  }

  /// Adds the number of snapshots beyond the limit. It is known without counting only if all
  /// snapshots were asked for.
  Status tell_more(ltm::Timeline& timeline, const std::vector<ltm::SnapshotQuery>& queries,
                   size_t listed, Json& json) {
    if (queries != all()) {
      text_ += "\n  and more";
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, timeline.count());
    text_ += fmt::format("\n  and {} more", reports::count_text(count - listed));
    json["more"] = count - listed;
    return {};
  }

  Status list_instances(const ltm::MemoryId& id) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(id.entity()));
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(*id.time()));
    if (!entry || entry->time != *id.time()) return nothing(id.to_string());
    const auto& form = entry->recorded ? entry->recorded : entry->latent;
    size_t rows = form->rows;
    if (rows == 0) {  // A snapshot in a journal: only its frame has the number of rows.
      ENGRAM_ASSIGN_OR_RETURN(const auto packed, reader_.read_packed(id.entity(), *entry));
      rows = packed.instances.size();
    }
    json_["instances"] = Json::array();
    for (size_t i = 0; i < rows; ++i) {
      const ltm::MemoryId instance = id.entity().at(entry->time).instance(static_cast<int32_t>(i));
      if (id.index() && instance != id) continue;
      text_ += (text_.empty() ? "" : "\n") + instance.printable();
      json_["instances"].push_back(instance.to_string());
    }
    return json_["instances"].empty() ? nothing(id.to_string()) : Status();
  }

  ltm::StoreReader& reader_;
  const LsArguments& arguments_;
  std::map<ltm::MemoryId, uint64_t> bytes_;
  Json json_ = Json::object();
  std::string text_;
};

ExitCode run(const LsArguments& arguments) {
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  Listing listing(**reader, arguments);
  Status status;
  const auto id = ltm::MemoryId::parse(arguments.what);
  const bool is_query = arguments.what.find_first_of("@;*+?()[]{}|^$") != std::string::npos;
  if (arguments.what.empty()) {
    status = listing.list(ltm::MemoryId());
  } else if (id.ok() && !is_query) {
    status = listing.list(*id);
  } else {
    const auto query = ltm::Query::parse(arguments.what);
    if (!query.ok()) return wrong_usage(query.status());
    status = listing.list(*query, arguments.what.find('@') != std::string::npos);
  }
  if (!status.ok()) return fail(status);
  listing.print_all();
  return ExitCode::kDone;
}

}  // namespace

void add_ls_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<LsArguments>();
  CLI::App* command = app.add_subcommand("ls", "List what lies in a store, level by level");
  command->footer(kLsFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("what", arguments->what, "ID or query");
  command
      ->add_option("--limit", arguments->limit,
                   "Max number of snapshots of one entity that are listed")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
