// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "cli/command.h"
#include "encoders/model_file.h"
#include "ltm/memory/query.h"
#include "ltm/store/store_reader.h"
#include "reports/choice_text.h"
#include "reports/forms_text.h"
#include "reports/plain/text.h"
#include "training/measure/stored_snapshots.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram models robot.engram
  engram models robot.engram --entity 'Vision/.*' --json
  engram models robot.engram --entity Vision/RGB/head/cam --snapshots

Of each model: what it was trained on, and the bytes that an image takes in each form that was
tried, alone and with the model's share for 3,000 and 30,000 images. "kept" is what was published.
--snapshots lists of each snapshot in which form its images are kept (latents, refined, residual,
video or lossless), its bytes (its own residual, and an even share of the rest of its block) and
PSNR, as it was measured when it was made. "chosen from" is what the store would have taken in so
many nights with the previous model and with this one.)";

struct ModelsArguments {
  std::string store;
  std::string entity;
  bool lists_snapshots = false;
  bool is_json = false;
};

/// A model of a store and where it comes from.
struct Model {
  const ltm::ModelInfo* info = nullptr;
  encoders::Provenance from;
};

Result<std::vector<Model>> models_of(const ltm::StoreReader& reader, const std::string& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query,
                          ltm::Query::parse(entity.empty() ? ".*" : entity));
  std::vector<Model> models;
  for (const ltm::ModelInfo& info : reader.manifest().models) {
    if (!entity.empty() && !query.matches(info.entity)) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto from, encoders::read_provenance(reader.path() / info.file));
    models.push_back({&info, std::move(from)});
  }
  if (models.empty() && !entity.empty())
    return not_found("store '{}': none of its {} models matches '{}'", reader.path().string(),
                     reader.manifest().models.size(), entity);
  return models;
}

Json to_json(const Model& model) {
  return {
      {"entity", model.info->entity.to_string()},
      {"version", model.info->version},
      {"file", model.info->file},
      {"bytes", model.info->bytes},
      {"snapshots", model.from.snapshots},
      {"recordings", model.from.autoencoder_spans.size()},
      {"steps", model.from.steps},
      {"training_seconds", model.from.training_seconds},
      {"seed", model.from.seed},
      {"psnr_aimed_at_db", model.from.psnr_db},
      {"number_bound", model.from.number_bound ? Json(*model.from.number_bound) : Json(nullptr)},
      {"variant", to_string(model.from.variant)},
      {"started_from_version",
       model.from.started_from > 0 ? Json(model.from.started_from) : Json(nullptr)},
      {"choice", reports::choice_json(model.from.choice)},
      {"images", reports::forms_json(model.from.forms)}};
}

std::string row(std::string_view form, int64_t bytes, int64_t rows, uint64_t model_bytes,
                const std::string& note) {
  const double each = static_cast<double>(bytes) / static_cast<double>(rows);
  const auto with_model = [&](double images) {
    return reports::bytes_text(each + static_cast<double>(model_bytes) / images);
  };
  return fmt::format("    {:<14} {:>10} {:>12} {:>14}  {}", form, reports::bytes_text(each),
                     with_model(3000), with_model(30000), note);
}

void print_forms(const encoders::StoredForms& forms, uint64_t model_bytes) {
  print(fmt::format("    {:<14} {:>10} {:>12} {:>14}", "form", "an image", "with 3,000",
                    "with 30,000"));
  if (forms.latent_bytes > 0)
    print(row("latents", forms.latent_bytes, forms.rows, model_bytes,
              forms.bound_db > 0
                  ? fmt::format("{} of {} below the bound", forms.below_bound_rows, forms.rows)
                  : ""));
  if (forms.residual_bytes > 0)
    print(row("with residuals", forms.residual_bytes, forms.rows, model_bytes,
              forms.refine_tried_rows > 0
                  ? fmt::format("refining tried for {}", forms.refine_tried_rows)
                  : ""));
  if (forms.video_bytes > 0) print(row("video", forms.video_bytes, forms.rows, 0, ""));
  if (forms.lossless_bytes > 0) print(row("without loss", forms.lossless_bytes, forms.rows, 0, ""));
  print(row("kept", forms.kept_bytes, forms.rows, model_bytes, reports::kept_text(forms)));
  if (forms.bound_db > 0)
    print("    bound " + reports::bound_text(forms.bound_db, forms.noise_images));
}

void print_model(const Model& model) {
  const auto& [info, from] = model;
  std::string text = fmt::format(
      "{}: {}, trained on {} snapshots of {} recordings, {} steps", info->name(),
      reports::bytes_text(static_cast<double>(info->bytes)),
      reports::count_text(static_cast<uint64_t>(from.snapshots)), from.autoencoder_spans.size(),
      reports::count_text(static_cast<uint64_t>(from.steps)));
  if (from.training_seconds > 0) text += " in " + reports::seconds_text(from.training_seconds);
  if (from.started_from > 0) text += fmt::format(", started from v{}", from.started_from);
  if (from.variant != encoders::TrainingVariant::kRateAware)
    text += fmt::format(", variant {}", to_string(from.variant));
  print(text);
  if (from.choice.previous_version > 0) print(reports::choice_text(from.choice));
  if (from.forms.rows > 0) print_forms(from.forms, info->bytes);
}

using SnapshotSink =
    std::function<Status(const ltm::MemoryId& entity, const training::StoredSnapshot& snapshot)>;

/// The snapshots of all entities that the models are of.
Status for_each_snapshot(ltm::StoreReader& reader, const std::vector<Model>& models,
                         const SnapshotSink& sink) {
  std::set<ltm::MemoryId> entities;
  for (const Model& model : models) entities.insert(model.info->entity);
  for (const ltm::MemoryId& entity : entities)
    ENGRAM_RETURN_IF_ERROR(training::list_stored_snapshots(
        reader, entity, [&](const training::StoredSnapshot& one) { return sink(entity, one); }));
  return {};
}

Json to_json(const ltm::MemoryId& entity, const training::StoredSnapshot& snapshot) {
  Json images = Json::array();
  for (const training::StoredImage& image : snapshot.images)
    images.push_back({{"member", image.member},
                      {"form", to_string(image.form)},
                      {"bytes", image.bytes},
                      {"residual_bytes", image.residual_bytes}});
  return {{"entity", entity.to_string()},
          {"time", to_string(snapshot.time)},
          {"model_version", snapshot.model_version},
          {"images", std::move(images)},
          {"bytes", snapshot.bytes},
          {"psnr_db", std::isnan(snapshot.psnr_db) ? Json(nullptr) : Json(snapshot.psnr_db)},
          {"rmse", std::isnan(snapshot.rmse) ? Json(nullptr) : Json(snapshot.rmse)}};
}

Status print_snapshots(ltm::StoreReader& reader, const std::vector<Model>& models) {
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
    print(entity.to_string());
    print(table.to_string("  "));
  }
  return {};
}

Status print_as_json(ltm::StoreReader& reader, const std::vector<Model>& models,
                     bool lists_snapshots) {
  Json report{{"models", Json::array()}};
  for (const Model& model : models) report["models"].push_back(to_json(model));
  if (lists_snapshots) {
    Json& list = report["snapshots"] = Json::array();
    ENGRAM_RETURN_IF_ERROR(for_each_snapshot(
        reader, models,
        [&](const ltm::MemoryId& entity, const training::StoredSnapshot& one) -> Status {
          list.push_back(to_json(entity, one));
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
    for (const Model& model : *models) print_model(model);
    if (arguments.lists_snapshots) printed = print_snapshots(**reader, *models);
  }
  return printed.ok() ? ExitCode::kDone : fail(printed);
}

}  // namespace

void add_models_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ModelsArguments>();
  CLI::App* command = app.add_subcommand("models", "List models, and what each form would take");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->entity, "Name or pattern of entities; else all");
  command->add_flag("--snapshots", arguments->lists_snapshots,
                    "Also list how each snapshot is kept");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
