// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "cli/command.h"
#include "cli/remote.h"
#include "ltm/core/disk_encryption.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/recall/access_log.h"
#include "ltm/store/store_reader.h"
#include "reports/plain/store_text.h"
#include "reports/plain/text.h"
#include "training/quality/quality_metrics.h"

namespace engram::cli {

namespace {

constexpr const char* kInfoFooter = R"(Examples:
  engram info robot.engram
  engram info robot.engram --security
  engram info robot.engram --json | jq '.entities[].stored_bytes'
  engram info --server 127.0.0.1:50051
  engram info --server unix:/run/engram/vision.sock --metrics
  engram info --names unix:/run/engram/names.sock

raw      bytes of the plain values: as they came (offered) and after the filters (kept)
stored   their recorded form: segments and journal; the codecs are those of the newest segments
latent   their form as latents; the model that decodes them counts beside
Of a server: what it has in memory, what came and went; of a name system: the servers that it knows.)";

/// The typical number of snapshots per second: the median over the newest ones, so that gaps
/// between recordings do not count.
Result<double> typical_rate_hz(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  constexpr size_t kMaxSteps = 1000;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader.timeline(entity));
  std::vector<Duration> steps;
  std::optional<Time> later = timeline->last();
  while (later && steps.size() < kMaxSteps && *later != *timeline->first()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry,
                            timeline->at_or_before(time_from_ns(to_ns(*later) - 1)));
    if (!entry) break;
    steps.push_back(*later - entry->time);
    later = entry->time;
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return 1 / to_seconds(*middle);
}

struct InfoArguments {
  std::string store;
  RemoteArguments remote;
  bool is_json = false;
  bool is_metrics = false;
  bool is_security = false;
  bool is_all = false;
};

/// Entities of a store that are told one by one, unless somebody wants all of them.
constexpr size_t kMaxToldEntities = 200;

/// What is told of an entity.
struct ToldEntity {
  ltm::EntitySummary summary;
  double rate_hz = 0;
  ltm::StoredForms forms;
};

Result<ToldEntity> read_told(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  ToldEntity told;
  ENGRAM_ASSIGN_OR_RETURN(told.summary, reader.summary(entity));
  ENGRAM_ASSIGN_OR_RETURN(told.rate_hz, typical_rate_hz(reader, entity));
  ENGRAM_ASSIGN_OR_RETURN(told.forms, reader.newest_forms(entity));
  return told;
}

/// Writes the entities behind `head` one by one, because the JSON of a hundred thousand of them
/// would take some GB of RAM.
Status print_entities_json(ltm::StoreReader& reader, const Json& head,
                           const std::vector<ltm::MemoryId>& entities) {
  std::string text = head.dump(2);
  text.erase(text.rfind("\n}"));
  fmt::print("{},\n  \"entities\": [", printable_json(text));
  for (size_t i = 0; i < entities.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const ToldEntity told, read_told(reader, entities[i]));
    const Json json = reports::stored_entity_json(told.summary, told.forms, told.rate_hz);
    fmt::print("{}\n    {}", i == 0 ? "" : ",", printable_json(json.dump()));
  }
  fmt::print("\n  ]\n}}\n");
  return {};
}

/// Sums of each provider segment.
Status print_segments(ltm::StoreReader& reader, const std::vector<ltm::MemoryId>& entities) {
  std::map<ltm::MemoryId, reports::StoredSegment> segments;
  for (const ltm::MemoryId& entity : entities) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::EntitySummary summary, reader.summary(entity));
    segments[entity.parent()].add(summary);
  }
  for (const auto& [segment, sums] : segments) reports::print_stored_segment(segment, sums);
  print(fmt::format("\nOf {} entities: --all tells of each, 'engram ls' lists them.",
                    reports::count_text(entities.size())));
  return {};
}

Status print_entities(ltm::StoreReader& reader, const std::vector<ltm::MemoryId>& entities) {
  for (const ltm::MemoryId& entity : entities) {
    ENGRAM_ASSIGN_OR_RETURN(const ToldEntity told, read_told(reader, entity));
    reports::print_stored_entity(told.summary, told.forms, told.rate_hz);
  }
  return {};
}

/// Who may read the files of a store, in words; empty if only its owner and group may.
std::string readers_text(const std::filesystem::path& store) {
  std::error_code failed;
  const auto mode = std::filesystem::status(store, failed).permissions();
  constexpr auto kOthers =
      std::filesystem::perms::others_read | std::filesystem::perms::others_exec;
  if (failed || (mode & kOthers) == std::filesystem::perms::none) return {};
  return "everybody on this machine who reaches its folder may read it: chmod o-rwx " +
         store.string();
}

/// Whether somebody who gets hold of the disk, or of the machine, reads the store.
ExitCode show_security(const InfoArguments& arguments) {
  if (const auto manifest = ltm::read_manifest(arguments.store); !manifest.ok())
    return fail(manifest.status());
  const auto disk = find_disk_state(arguments.store);
  if (!disk.ok()) return fail(disk.status());
  const std::string readers = readers_text(arguments.store);
  if (arguments.is_json) {
    print_json({{"store", arguments.store},
                {"device", disk->device},
                {"filesystem", disk->filesystem},
                {"disk", to_string(disk->encryption)},
                {"reason", disk->reason},
                {"others_may_read", !readers.empty()}});
    return ExitCode::kDone;
  }
  print(fmt::format("disk     {} ({}): {}, as {}", printable(disk->device), disk->filesystem,
                    to_string(disk->encryption), disk->reason));
  print("readers  " + (readers.empty() ? "its owner and group" : printable(readers)));
  if (disk->encryption != DiskEncryption::kEncrypted)
    print("A store is not encrypted by itself: whoever gets hold of the disk reads it.");
  return ExitCode::kDone;
}

ExitCode run(const InfoArguments& arguments) {
  const std::string& store = arguments.store;
  const bool is_json = arguments.is_json;
  if (const Status named = check_source(store, arguments.remote); !named.ok())
    return wrong_usage(named);
  if (store.empty() && arguments.is_security)
    return wrong_usage(invalid_argument("--security is of a store, not of a server"));
  if (store.empty())
    return show_server(arguments.remote, arguments.is_metrics ? ServerFigures::kMetrics
                                         : is_json            ? ServerFigures::kJson
                                                              : ServerFigures::kText);
  if (arguments.is_security) return show_security(arguments);
  if (arguments.is_metrics)
    return wrong_usage(invalid_argument("--metrics is of a server, not of a store"));
  auto reader = ltm::StoreReader::open(store);
  if (!reader.ok()) return fail(reader.status());
  const ltm::Manifest& manifest = (*reader)->manifest();
  const uint64_t damaged = (*reader)->damaged_places();
  const std::vector<ltm::MemoryId> entities = (*reader)->entities();
  const Json json{{"store", store},
                  {"id", manifest.store_id},
                  {"format_version", manifest.format_version()},
                  {"generation", manifest.generation},
                  {"segments", manifest.segments.size()},
                  {"damaged_journal_places", damaged},
                  {"types", reports::types_json(manifest.types)}};
  if (!is_json)
    print(fmt::format("Store {}: {} entities, {} segments, {} models, generation {}", store,
                      entities.size(), manifest.segments.size(), manifest.models.size(),
                      manifest.generation));
  if (!is_json && entities.empty()) print("It is empty.");
  const bool is_each = arguments.is_all || entities.size() <= kMaxToldEntities;
  const Status told = is_json   ? print_entities_json(**reader, json, entities)
                      : is_each ? print_entities(**reader, entities)
                                : print_segments(**reader, entities);
  if (!told.ok()) return fail(told);
  if (!is_json) reports::print_types(manifest.types);
  // The store may be read-only, so a failure is no warning.
  if (const Status status = ltm::merge_grown_accesses(store); !status.ok())
    log::debug("store '{}': {}", store, status.to_string());
  if (damaged > 0)
    log::warning("store '{}': {} places in its journals were found damaged; what was there is lost",
                 store, damaged);
  return ExitCode::kDone;
}

}  // namespace

void add_info_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command =
      app.add_subcommand("info", "Show what a store holds, or what a server counts");
  command->footer(kInfoFooter);
  command->add_option("store", arguments->store, "Store; none where a server is asked");
  add_remote_options(*command, arguments->remote);
  command->add_flag("--security", arguments->is_security,
                    "Is its disk encrypted, and who may read it");
  command->add_flag("--all", arguments->is_all, "Tell of each entity, however many there are");
  command->add_flag("--json", arguments->is_json, "As JSON");
  if (has_servers())
    command->add_flag("--metrics", arguments->is_metrics, "Of a server, as text for Prometheus")
        ->excludes("--json");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
