// SPDX-License-Identifier: Apache-2.0
#include "reports/models_text.h"

#include <cmath>

#include "reports/choice_text.h"
#include "reports/forms_text.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::string row(std::string_view form, int64_t bytes, int64_t rows, uint64_t model_bytes,
                const std::string& note) {
  const double each = static_cast<double>(bytes) / static_cast<double>(rows);
  const auto with_model = [&](double images) {
    return bytes_text(each + static_cast<double>(model_bytes) / images);
  };
  return fmt::format("    {:<14} {:>10} {:>12} {:>14}  {}", form, bytes_text(each),
                     with_model(3000), with_model(30000), note);
}

void print_model_forms(const encoders::StoredForms& forms, uint64_t model_bytes) {
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
  print(row("kept", forms.kept_bytes, forms.rows, model_bytes, kept_text(forms)));
  if (forms.bound_db > 0) print("    bound " + bound_text(forms.bound_db, forms.noise_images));
}

}  // namespace

Json model_json(const StoredModel& model) {
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
      {"choice", choice_json(model.from.choice)},
      {"images", forms_json(model.from.forms)}};
}

void print_model(const StoredModel& model) {
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
  if (from.forms.rows > 0) print_model_forms(from.forms, info->bytes);
}

Json stored_snapshot_json(const ltm::MemoryId& entity, const training::StoredSnapshot& snapshot) {
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

}  // namespace engram::reports
