// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "cli/command.h"
#include "cli/remote.h"
#include "ltm/core/log.h"
#include "ltm/recall/access_log.h"
#include "ltm/store/store_reader.h"
#include "reports/plain/text.h"
#include "training/quality/metrics.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram info robot.engram
  engram info robot.engram --json | jq '.entities[].stored_bytes'
  engram info --server 127.0.0.1:50051
  engram info --server unix:/run/engram/vision.sock --metrics
  engram info --names unix:/run/engram/names.sock

raw      bytes of the plain values: as they came (offered) and after the filters (kept)
stored   their recorded form: segments and journal; the codecs are those of the newest segments
latent   their form as latents; the model that decodes them counts beside
Of a server: what it has in memory, what came and went; of a name system: the servers that it knows.)";

/// A figure per snapshot, or nothing where there are none.
double each(uint64_t total, uint64_t count) {
  return count == 0 ? 0 : static_cast<double>(total) / static_cast<double>(count);
}

double mean_of(double sum, uint64_t count) {
  return count == 0 ? std::nan("") : sum / static_cast<double>(count);
}

/// Snapshots per second within recordings, gaps between them not counted: the median over the
/// newest ones.
Result<double> typical_rate_hz(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  constexpr size_t kMostSteps = 1000;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader.timeline(entity));
  std::vector<Duration> steps;
  std::optional<Time> later = timeline->last();
  while (later && steps.size() < kMostSteps && *later != *timeline->first()) {
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

Json entity_json(const ltm::EntitySummary& summary, const ltm::StoredForms& forms, double rate_hz) {
  Json models = Json::array();
  for (const ltm::ModelInfo& model : summary.models)
    models.push_back({{"version", model.version}, {"file", model.file}, {"bytes", model.bytes}});
  Json json{{"id", summary.id.to_string()},
            {"snapshots", summary.snapshots},
            {"recorded_snapshots", summary.recorded_snapshots},
            {"latent_snapshots", summary.latent_snapshots},
            {"augmented_snapshots", summary.augmented_snapshots},
            {"offered_snapshots", summary.offered},
            {"first_ns", to_ns(summary.first)},
            {"last_ns", to_ns(summary.last)},
            {"rate_hz", rate_hz},
            {"dropped_by", summary.dropped_by},
            {"forgotten_snapshots", summary.forgotten.snapshots},
            {"offered_bytes", summary.offered_bytes},
            {"raw_bytes", summary.raw_bytes},
            {"stored_bytes", summary.stored_bytes},
            {"media_codecs", forms.media_codecs},
            {"has_number_columns", forms.has_columns()},
            {"latent_bytes", summary.latent_bytes},
            {"model_bytes", summary.model_bytes},
            {"models", std::move(models)}};
  const ltm::LatentSums& sums = summary.latent;
  if (sums.image_rows > 0) {
    json["psnr_mean_over_images_db"] = mean_of(sums.psnr_db, sums.image_rows);
    json["psnr_pooled_error_db"] = training::psnr_db(mean_of(sums.image_mse, sums.image_rows));
  }
  if (sums.number_rows > 0) json["rmse"] = std::sqrt(mean_of(sums.number_mse, sums.number_rows));
  return json;
}

std::string quality_text(const ltm::LatentSums& sums) {
  std::string text;
  if (sums.image_rows > 0)
    text +=
        fmt::format(", PSNR {} mean over images, {} pooled",
                    reports::db_text(mean_of(sums.psnr_db, sums.image_rows)),
                    reports::db_text(training::psnr_db(mean_of(sums.image_mse, sums.image_rows))));
  if (sums.number_rows > 0)
    text +=
        fmt::format(", RMSE {} over numbers",
                    reports::number_text(std::sqrt(mean_of(sums.number_mse, sums.number_rows))));
  return text;
}

std::string bytes_each(uint64_t total, uint64_t count) {
  return fmt::format("{} ({} each)", reports::bytes_text(static_cast<double>(total)),
                     reports::bytes_text(each(total, count)));
}

/// ", as h264, numbers as columns"; nothing where neither says more than that it is stored.
std::string forms_text(const ltm::StoredForms& forms) {
  std::string text;
  for (const std::string& codec : forms.media_codecs)
    text += (text.empty() ? ", as " : " and ") + codec;
  if (forms.has_columns()) text += ", numbers as columns";
  return text;
}

void print_entity(const ltm::EntitySummary& summary, const ltm::StoredForms& forms,
                  double rate_hz) {
  print("\n" + summary.id.to_string());
  print(fmt::format("  snapshots  {} of {} offered: {} recorded, {} as latents",
                    reports::count_text(summary.snapshots), reports::count_text(summary.offered),
                    reports::count_text(summary.recorded_snapshots),
                    reports::count_text(summary.latent_snapshots)));
  if (summary.augmented_snapshots > 0)
    print(fmt::format("  augmented  {}: made of others, never perceived",
                      reports::count_text(summary.augmented_snapshots)));
  std::string reasons;
  for (const auto& [filter, count] : summary.dropped_by)
    reasons +=
        fmt::format("{}{} by {}", reasons.empty() ? "" : ", ", reports::count_text(count), filter);
  if (!reasons.empty()) print("  dropped    " + reasons);
  if (summary.forgotten.snapshots > 0)
    print(fmt::format("  forgotten  {}", reports::count_text(summary.forgotten.snapshots)));
  if (summary.snapshots > 0)
    print(fmt::format("  span       {} to {}, {:.3g} Hz", to_string(summary.first),
                      to_string(summary.last), rate_hz));
  print(fmt::format("  raw        {} offered, {} kept",
                    reports::bytes_text(static_cast<double>(summary.offered_bytes)),
                    bytes_each(summary.raw_bytes, summary.snapshots)));
  print("  stored     " + bytes_each(summary.stored_bytes, summary.recorded_snapshots) +
        forms_text(forms));
  if (summary.latent_snapshots == 0) return;
  print(fmt::format(
      "  latent     {} + {} model = {}", bytes_each(summary.latent_bytes, summary.latent_snapshots),
      reports::bytes_text(static_cast<double>(summary.model_bytes)),
      bytes_each(summary.latent_bytes + summary.model_bytes, summary.latent_snapshots)));
  std::string models;
  for (const ltm::ModelInfo& model : summary.models)
    models += fmt::format("{}v{}", models.empty() ? "" : ", ", model.version);
  print("  models     " + models + quality_text(summary.latent));
}

Json types_json(const ltm::SegmentTypes& types) {
  Json json = Json::object();
  for (const auto& [segment, type] : types.all()) json[segment.to_string()] = to_string(type);
  return json;
}

void print_types(const ltm::SegmentTypes& types) {
  if (!types.all().empty()) print("\nTypes of segments");
  for (const auto& [segment, type] : types.all())
    print(fmt::format("  {}  {}", segment.to_string(), to_string(type)));
}

struct InfoArguments {
  std::string store;
  RemoteArguments remote;
  bool is_json = false;
  bool is_metrics = false;
};

ExitCode run(const InfoArguments& arguments) {
  const std::string& store = arguments.store;
  const bool is_json = arguments.is_json;
  if (const Status named = check_source(store, arguments.remote); !named.ok())
    return wrong_usage(named);
  if (store.empty())
    return show_server(arguments.remote, arguments.is_metrics ? ServerFigures::kMetrics
                                         : is_json            ? ServerFigures::kJson
                                                              : ServerFigures::kText);
  if (arguments.is_metrics)
    return wrong_usage(invalid_argument("--metrics is of a server, not of a store"));
  auto reader = ltm::StoreReader::open(store);
  if (!reader.ok()) return fail(reader.status());
  const ltm::Manifest& manifest = (*reader)->manifest();
  const uint64_t damaged = (*reader)->damaged_places();
  const std::vector<ltm::MemoryId> entities = (*reader)->entities();
  Json json{{"store", store},
            {"id", manifest.store_id},
            {"format_version", ltm::kStoreFormatVersion},
            {"generation", manifest.generation},
            {"segments", manifest.segments.size()},
            {"damaged_journal_places", damaged},
            {"types", types_json(manifest.types)},
            {"entities", Json::array()}};
  if (!is_json)
    print(fmt::format("Store {}: {} entities, {} segments, {} models, generation {}", store,
                      entities.size(), manifest.segments.size(), manifest.models.size(),
                      manifest.generation));
  if (!is_json && entities.empty()) print("It is empty.");
  for (const ltm::MemoryId& entity : entities) {
    const auto summary = (*reader)->summary(entity);
    if (!summary.ok()) return fail(summary.status());
    const auto rate_hz = typical_rate_hz(**reader, entity);
    if (!rate_hz.ok()) return fail(rate_hz.status());
    const auto forms = (*reader)->newest_forms(entity);
    if (!forms.ok()) return fail(forms.status());
    if (is_json)
      json["entities"].push_back(entity_json(*summary, *forms, *rate_hz));
    else
      print_entity(*summary, *forms, *rate_hz);
  }
  if (is_json)
    print_json(json);
  else
    print_types(manifest.types);
  // The store may be one that only can be read.
  (void)ltm::merge_grown_accesses(store).ok();
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
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store; none where a server is asked");
  add_remote_options(*command, arguments->remote);
  command->add_flag("--json", arguments->is_json, "As JSON");
  if (has_servers())
    command->add_flag("--metrics", arguments->is_metrics, "Of a server, as text for Prometheus")
        ->excludes("--json");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
