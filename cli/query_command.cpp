// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/save.h"
#include "cli/text.h"
#include "encoders/load_model.h"
#include "ltm/idf/layout.h"
#include "ltm/recall/recall.h"
#include "server/prediction/entity_forecaster.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(A query is NAMES @ SELECTOR. NAMES are Memory/Core/Provider/Entity, each a name or a regular
expression; missing ones match all. Without a selector: latest.
  latest  latest:3       the last one, the last three
  all                    every one
  TIME                   at exactly that time; a prediction where it lies after the last one
  +200ms                 a prediction so long after the last one, by the engine that was best on
                         the entity's own past (engram predict --list), with the error to expect
                         and the bound that it keeps with a probability of 90 %
  nearest:TIME~50ms      the closest within a tolerance (without ~: any)
  before:TIME  at-or-before:TIME  after:TIME
  TIME..TIME             from and to, both included
  last:10s               the last ten seconds
  -3..-1                 by index, negative from the end
Several selectors are united by ',', whole queries by ';'; '#0' behind a selector asks for one
instance only, '?ids' in front for IDs without data.
TIME is '2022-02-18 13:06:56.492182', RFC 3339, or integer nanoseconds since 1970.

Examples:
  engram query robot.engram 'Vision/RGB/head/cam @ latest:3' --save answers
  engram query robot.engram '.*/.*/.*/joints @ last:2s' --json
  engram query robot.engram 'Vision/RGB/head/cam @ +200ms' --save future
  engram query robot.engram '.*/.*/.*/joints @ latest, +400ms, +1s')";

struct QueryArguments {
  std::string store;
  std::string query;
  std::string save;
  std::string prefer = "recorded";
  bool is_json = false;
  bool is_unnoted = false;
};

/// "31.84 dB"; of a prediction "31.84 dB, 90 %: 28.20 dB", what is expected and the bound.
std::string first_error_text(const ltm::SnapshotResult& snapshot) {
  if (snapshot.instances.empty() || !snapshot.instances.front().error) return "-";
  const ltm::InstanceResult& first = snapshot.instances.front();
  const std::string bound = first.bound ? error_text(*first.bound) : "-";
  if (bound == "-") return error_text(*first.error);
  return fmt::format("{}, {:.0f} %: {}", error_text(*first.error), 100 * ltm::kBoundProbability,
                     bound);
}

/// "image uint8 [128, 128, 3]", "52 numbers": what a value is made of.
std::string content_text(const ltm::SnapshotResult& snapshot) {
  std::string text;
  for (const ltm::InstanceResult& instance : snapshot.instances) {
    const idf::Layout layout = idf::Layout::of(instance.data);
    size_t numbers = 0;
    std::string images;
    for (const idf::TensorMember& member : layout.members()) {
      if (member.kind == idf::MemberKind::kImage)
        images += fmt::format("{}{} {} {}", images.empty() ? "" : ", ", member.path,
                              to_string(member.type), idf::to_string(member.shape));
      else
        ++numbers;
    }
    if (!text.empty()) text += " | ";
    text += images;
    if (numbers > 0) text += fmt::format("{}{} numbers", images.empty() ? "" : ", ", numbers);
  }
  return text;
}

std::string source_text(const ltm::SnapshotResult& recalled) {
  std::string text(ltm::to_string(recalled.source));
  if (!recalled.predictor.empty())
    text += fmt::format(" {} ahead ({})", to_string(recalled.horizon), recalled.predictor);
  return text;
}

Result<Json> result_json(const ltm::QueryResult& result) {
  Json entities = Json::array();
  for (const ltm::EntityResult* entity : result.entities()) {
    Json snapshots = Json::array();
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      ENGRAM_ASSIGN_OR_RETURN(Json snapshot, snapshot_json(entity->id, recalled));
      snapshots.push_back(std::move(snapshot));
    }
    entities.push_back({{"id", entity->id.to_string()}, {"snapshots", std::move(snapshots)}});
  }
  return Json{{"entities", std::move(entities)}};
}

void print_ids(const ltm::QueryResult& result, bool is_json) {
  Json ids = Json::array();
  for (const ltm::MemoryId& id : result.ids()) {
    if (is_json)
      ids.push_back(id.to_string());
    else
      print(id.to_string());
  }
  if (is_json) print_json({{"ids", std::move(ids)}});
}

void print_result(const ltm::QueryResult& result) {
  for (const ltm::EntityResult* entity : result.entities()) {
    print(entity->id.to_string());
    if (entity->snapshots.empty()) {
      print("  no snapshot matches");
      continue;
    }
    TextTable table({"time", "source", "model", "error", "content"});
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      const size_t space = recalled.model.rfind(' ');
      table.add({to_string(recalled.time), source_text(recalled),
                 space == std::string::npos ? "-" : recalled.model.substr(space + 1),
                 first_error_text(recalled), content_text(recalled)});
    }
    print(table.to_string("  "));
  }
}

Status save_result(const ltm::QueryResult& result, const std::string& directory, bool is_json) {
  size_t count = 0;
  for (const ltm::EntityResult* entity : result.entities()) {
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      ENGRAM_ASSIGN_OR_RETURN(const auto files, save_snapshot(entity->id, recalled, directory));
      count += files.size();
    }
  }
  if (!is_json) print(fmt::format("{} files written below {}", count, directory));
  return {};
}

ExitCode run(const QueryArguments& arguments) {
  const auto query = ltm::Query::parse(arguments.query);
  if (!query.ok()) return wrong_usage(query.status());
  if (query->is_ids_only() && !arguments.save.empty())
    return wrong_usage(invalid_argument("query '{}' asks for IDs alone: --save needs data",
                                        arguments.query));
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  auto accesses = arguments.is_unnoted ? nullptr
                                       : std::make_unique<ltm::AccessLog>(
                                             arguments.store, ltm::AccessLog::Options{});
  ltm::Recall recall(std::move(*reader), encoders::load_model, std::move(accesses),
                     server::make_entity_forecaster);
  ltm::Recall::Options options;
  options.prefer = arguments.prefer == "latent" ? ltm::Recall::Prefer::kLatent
                                                : ltm::Recall::Prefer::kRecorded;
  const auto result = recall.query(*query, options);
  if (!result.ok()) return fail(result.status());
  if (query->is_ids_only()) {
    print_ids(*result, arguments.is_json);
  } else if (arguments.is_json) {
    const auto json = result_json(*result);
    if (!json.ok()) return fail(json.status());
    print_json(*json);
  } else {
    print_result(*result);
  }
  if (!arguments.save.empty())
    if (const Status saved = save_result(*result, arguments.save, arguments.is_json); !saved.ok())
      return fail(saved);
  return ExitCode::kDone;
}

}  // namespace

void add_query_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command = app.add_subcommand("query", "Ask about any moment, past or future");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("query", arguments->query, "NAMES @ SELECTOR")->required();
  command->add_option("--save", arguments->save, "Write images (PNG) and data (JSON) below a folder");
  command->add_option("--prefer", arguments->prefer, "Which form answers where both are there")
      ->check(CLI::IsMember({"recorded", "latent"}))
      ->capture_default_str();
  command->add_flag("--unnoted", arguments->is_unnoted,
                    "Do not note in the store what is read (docs/forgetting.md)");
  command->add_flag("--json", arguments->is_json, "All data as JSON on stdout");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
