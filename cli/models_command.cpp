// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "cli/command.h"
#include "encoders/model_file.h"
#include "ltm/memory/query.h"
#include "ltm/store/store_reader.h"
#include "reports/models_text.h"
#include "reports/plain/text.h"
#include "training/measure/stored_snapshots.h"

namespace engram::cli {

namespace {

constexpr const char* kModelsFooter = R"(Examples:
  engram models robot.engram
  engram models robot.engram --entity 'Vision/.*' --json
  engram models robot.engram --entity Vision/RGB/head/cam --snapshots

Of each model: what it was trained on, and the bytes that an image takes in each form that was
tried, alone and with the model's share for 3,000 and 30,000 images. "kept" is what was published.
--snapshots lists of each snapshot in which form its images are kept (latents, refined, residual,
video, lossless or gist), its bytes (its own residual, and an even share of the rest of its block)
and PSNR, as it was measured when it was made. "chosen from" is what the store would have taken in
so many nights with the previous model and with this one.)";

struct ModelsArguments {
  std::string store;
  std::string entity;
  bool lists_snapshots = false;
  bool is_json = false;
};

Result<std::vector<reports::StoredModel>> models_of(const ltm::StoreReader& reader,
                                                    const std::string& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query,
                          ltm::Query::parse(entity.empty() ? ".*" : entity));
  std::vector<reports::StoredModel> models;
  for (const ltm::ModelInfo& info : reader.manifest().models) {
    if (!entity.empty() && !query.matches(info.entity)) continue;
    // No network is read: a list must not take as long as opening all models.
    ENGRAM_ASSIGN_OR_RETURN(auto from, encoders::read_provenance(reader.path() / info.file));
    models.push_back({&info, std::move(from)});
  }
  // A store may well have no models yet, but a name that matches none is probably mistyped.
  if (models.empty() && !entity.empty())
    return not_found("store '{}': none of its {} models matches '{}'", reader.path().string(),
                     reader.manifest().models.size(), entity);
  return models;
}

using SnapshotSink =
    std::function<Status(const ltm::MemoryId& entity, const training::StoredSnapshot& snapshot)>;

/// Calls `sink` for the snapshots of all entities that have one of the models.
Status for_each_snapshot(ltm::StoreReader& reader, const std::vector<reports::StoredModel>& models,
                         const SnapshotSink& sink) {
  // An entity may have several models, and its snapshots are listed once.
  std::set<ltm::MemoryId> entities;
  for (const reports::StoredModel& model : models) entities.insert(model.info->entity);
  for (const ltm::MemoryId& entity : entities)
    ENGRAM_RETURN_IF_ERROR(training::list_stored_snapshots(
        reader, entity, [&](const training::StoredSnapshot& one) { return sink(entity, one); }));
  return {};
}

Status print_snapshots(ltm::StoreReader& reader, const std::vector<reports::StoredModel>& models) {
  // Nothing is printed before all rows are there, because they decide the widths of the columns.
  std::map<ltm::MemoryId, reports::TextTable> tables;
  ENGRAM_RETURN_IF_ERROR(for_each_snapshot(
      reader, models,
      [&](const ltm::MemoryId& entity, const training::StoredSnapshot& snapshot) -> Status {
        std::vector<std::string> forms;
        for (const auto& image : snapshot.images) forms.emplace_back(to_string(image.form));
        const reports::TextTable header({"time", "model", "form", "bytes", "PSNR"});
        tables.try_emplace(entity, header)
            .first->second.add(
                {to_string(snapshot.time), fmt::format("v{}", snapshot.model_version),
                 fmt::format("{}", fmt::join(forms, "+")), fmt::format("{:.1f}", snapshot.bytes),
                 reports::db_text(snapshot.psnr_db)});
        return {};
      }));
  for (const auto& [entity, table] : tables) {
    print(entity.printable());
    print(table.to_string("  "));
  }
  return {};
}

Status print_as_json(ltm::StoreReader& reader, const std::vector<reports::StoredModel>& models,
                     bool lists_snapshots) {
  Json report{{"models", Json::array()}};
  for (const reports::StoredModel& model : models)
    report["models"].push_back(reports::model_json(model));
  if (lists_snapshots) {
    Json& list = report["snapshots"] = Json::array();
    ENGRAM_RETURN_IF_ERROR(for_each_snapshot(
        reader, models,
        [&](const ltm::MemoryId& entity, const training::StoredSnapshot& one) -> Status {
          list.push_back(reports::stored_snapshot_json(entity, one));
          return {};
        }));
  }
  print_json(report);
  return {};
}

ExitCode run(const ModelsArguments& arguments) {
  const auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  const auto models = models_of(**reader, arguments.entity);
  if (!models.ok()) return fail(models.status());
  Status printed;
  if (arguments.is_json) {
    printed = print_as_json(**reader, *models, arguments.lists_snapshots);
  } else {
    if (models->empty()) print(fmt::format("Store {}: no models", arguments.store));
    for (const reports::StoredModel& model : *models) reports::print_model(model);
    if (arguments.lists_snapshots) printed = print_snapshots(**reader, *models);
  }
  return printed.ok() ? ExitCode::kDone : fail(printed);
}

}  // namespace

void add_models_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ModelsArguments>();
  CLI::App* command = app.add_subcommand("models", "List models, and what each form would take");
  command->footer(kModelsFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->entity, "Name or pattern of entities; else all");
  command->add_flag("--snapshots", arguments->lists_snapshots,
                    "Also list how each snapshot is kept");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
