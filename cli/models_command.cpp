// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "cli/choice_text.h"
#include "cli/command.h"
#include "cli/forms_text.h"
#include "cli/text.h"
#include "encoders/model_file.h"
#include "ltm/memory/query.h"
#include "ltm/store/store_reader.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram models robot.engram
  engram models robot.engram --entity 'Vision/.*' --json

Of each model: what it was trained on, and the bytes that an image takes in each form that was
tried, alone and with the model's share for 3,000 and 30,000 images. "kept" is what was published.
"chosen from" is what the store would have taken in so many nights with the previous model and with
this one.)";

struct ModelsArguments {
  std::string store;
  std::string entity;
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
  return {{"entity", model.info->entity.to_string()},
          {"version", model.info->version},
          {"file", model.info->file},
          {"bytes", model.info->bytes},
          {"snapshots", model.from.snapshots},
          {"recordings", model.from.autoencoder_spans.size()},
          {"steps", model.from.steps},
          {"training_seconds", model.from.training_seconds},
          {"seed", model.from.seed},
          {"psnr_aimed_at_db", model.from.psnr_db},
          {"number_bound", model.from.number_bound},
          {"variant", to_string(model.from.variant)},
          {"started_from_version",
           model.from.started_from > 0 ? Json(model.from.started_from) : Json(nullptr)},
          {"choice", choice_json(model.from.choice)},
          {"images", forms_json(model.from.forms)}};
}

std::string row(std::string_view form, int64_t bytes, int64_t rows, uint64_t model_bytes,
                const std::string& note) {
  const double each = static_cast<double>(bytes) / static_cast<double>(rows);
  const auto with_model = [&](double images) {
    return bytes_text(each + static_cast<double>(model_bytes) / images);
  };
  return fmt::format("    {:<8} {:>10} {:>12} {:>14}  {}", form, bytes_text(each), with_model(3000),
                     with_model(30000), note);
}

void print_model(const Model& model) {
  const auto& [info, from] = model;
  std::string text =
      fmt::format("{}: {}, trained on {} snapshots of {} recordings, {} steps", info->name(),
                  bytes_text(static_cast<double>(info->bytes)),
                  count_text(static_cast<uint64_t>(from.snapshots)), from.autoencoder_spans.size(),
                  count_text(static_cast<uint64_t>(from.steps)));
  if (from.training_seconds > 0) text += " in " + seconds_text(from.training_seconds);
  if (from.started_from > 0) text += fmt::format(", started from v{}", from.started_from);
  if (from.variant != encoders::TrainingVariant::kRateAware)
    text += fmt::format(", variant {}", to_string(from.variant));
  print(text);
  if (from.choice.previous_version > 0) print(choice_text(from.choice));
  const encoders::StoredForms& forms = from.forms;
  if (forms.rows == 0) return;
  print(fmt::format("    {:<8} {:>10} {:>12} {:>14}", "form", "an image", "with 3,000",
                    "with 30,000"));
  if (forms.latent_bytes > 0)
    print(row("latents", forms.latent_bytes, forms.rows, info->bytes,
              forms.bound_db > 0 ? fmt::format("{} of {} below {:.1f} dB", forms.below_bound_rows,
                                               forms.rows, forms.bound_db)
                                 : ""));
  if (forms.video_bytes > 0) print(row("video", forms.video_bytes, forms.rows, 0, ""));
  print(row("kept", forms.kept_bytes, forms.rows, info->bytes,
            fmt::format("{} latents, {} video, {} without loss", forms.latent_rows,
                        forms.video_rows, forms.lossless_rows)));
}

ExitCode run(const ModelsArguments& arguments) {
  const auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  const auto models = models_of(**reader, arguments.entity);
  if (!models.ok()) return fail(models.status());
  if (arguments.is_json) {
    Json list = Json::array();
    for (const Model& model : *models) list.push_back(to_json(model));
    print_json({{"models", std::move(list)}});
    return ExitCode::kDone;
  }
  if (models->empty()) print(fmt::format("Store {}: no models", arguments.store));
  for (const Model& model : *models) print_model(model);
  return ExitCode::kDone;
}

}  // namespace

void add_models_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ModelsArguments>();
  CLI::App* command = app.add_subcommand("models", "List models, and what each form would take");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->entity, "Name or pattern of entities; else all");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
