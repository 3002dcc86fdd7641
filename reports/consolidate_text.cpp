// SPDX-License-Identifier: Apache-2.0
#include "reports/consolidate_text.h"

#include <cmath>

#include "reports/choice_text.h"
#include "reports/costs_text.h"
#include "reports/forms_text.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

// JSON has no NaN and no infinity: an entity without images has no PSNR.
Json number_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

Json number_or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json(nullptr);
}

std::string bytes_or_dash(const std::optional<double>& bytes) {
  if (!bytes) return "-";
  return *bytes < 0 ? "-" + bytes_text(-*bytes) : bytes_text(*bytes);
}

std::vector<std::string> all_notes(const training::EntityReport& entity) {
  std::vector<std::string> notes = entity.notes;
  notes.insert(notes.end(), entity.training.notes.begin(), entity.training.notes.end());
  return notes;
}

Json entity_json(const training::EntityReport& entity) {
  Json json{{"entity", entity.entity.to_string()}};
  if (!entity.skipped_reason.empty()) {
    json["skipped"] = entity.skipped_reason;
    json["stages"] = stages_json(entity.costs.stages);
    return json;
  }
  // Both means are reported, because the mean PSNR over images hides a few bad images, which
  // dominate the pooled error.
  json.update({{"model_version", entity.model_version},
               {"is_model_new", entity.is_model_new},
               {"started_from_version",
                entity.training.started_from > 0 ? Json(entity.training.started_from) : Json()},
               {"snapshots", entity.snapshots},
               {"left_behind", entity.left_behind},
               {"waiting", entity.waiting},
               {"raw_bytes", entity.raw_bytes},
               {"stored_bytes", entity.stored_bytes},
               {"latent_bytes", entity.latent_bytes},
               {"model_bytes", entity.model_bytes},
               {"psnr_mean_over_images_db", number_or_null(entity.mean_psnr_db)},
               {"psnr_pooled_error_db", number_or_null(entity.pooled_psnr_db)},
               {"psnr_minimum_db", number_or_null(entity.minimum_psnr_db)},
               {"psnr_5_percent_db", number_or_null(entity.psnr_quantiles_db[0])},
               {"psnr_median_db", number_or_null(entity.psnr_quantiles_db[1])},
               {"psnr_95_percent_db", number_or_null(entity.psnr_quantiles_db[2])},
               {"rmse", number_or_null(entity.rmse)},
               {"seconds", entity.seconds},
               {"images_per_processor_second", entity.training.images_per_second},
               {"encoding_seconds", entity.encoding_seconds},
               {"expected_encoding_seconds", entity.expected_encoding_seconds > 0
                                                 ? Json(entity.expected_encoding_seconds)
                                                 : Json(nullptr)},
               {"stages", stages_json(entity.costs.stages)},
               {"encodes", encodes_json(entity.costs)},
               {"images", forms_json(entity.forms)},
               {"choice", choice_json(entity.choice)},
               {"notes", all_notes(entity)}});
  return json;
}

}  // namespace

void print_plan(const training::ConsolidatePlan& plan) {
  TextTable table({"plan", "snapshots", "new", "plain", "stored", "expected", "gain", "time"});
  std::vector<std::string> skipped;
  for (const training::EntityPlan& entity : plan.entities) {
    if (!entity.skipped_reason.empty()) {
      skipped.push_back(entity.entity.printable() + ": will be skipped: " + entity.skipped_reason);
      continue;
    }
    table.add({entity.entity.printable(), count_text(entity.snapshots),
               count_text(entity.new_snapshots),
               bytes_text(static_cast<double>(entity.plain_bytes)),
               bytes_text(static_cast<double>(entity.stored_bytes)),
               bytes_or_dash(entity.expected_bytes()), bytes_or_dash(entity.expected_gain_bytes()),
               fmt::format("{:.0f} %", 100 * entity.budget_share)});
  }
  if (skipped.size() < plan.entities.size()) print(table.to_string());
  for (const training::EntityPlan& entity : plan.entities)
    if (entity.bound.bound_db > 0)
      print(fmt::format("{}: bound {}", entity.entity.printable(),
                        bound_text(entity.bound.bound_db, entity.bound.noise_images)));
  for (const std::string& line : skipped) print(line);
}

Json plan_json(const training::ConsolidatePlan& plan) {
  Json entities = Json::array();
  for (const training::EntityPlan& entity : plan.entities) {
    Json json{{"entity", entity.entity.to_string()}};
    if (!entity.skipped_reason.empty())
      json["skipped"] = entity.skipped_reason;
    else
      json.update(
          {{"snapshots", entity.snapshots},
           {"new_snapshots", entity.new_snapshots},
           {"plain_bytes", entity.plain_bytes},
           {"stored_bytes", entity.stored_bytes},
           {"newest_model_version", entity.newest_version},
           {"expected_bytes", number_or_null(entity.expected_bytes())},
           {"expected_gain_bytes", number_or_null(entity.expected_gain_bytes())},
           {"budget_share", entity.budget_share},
           {"bound_db", entity.bound.bound_db > 0 ? Json(entity.bound.bound_db) : Json(nullptr)},
           {"noise_images", entity.bound.noise_images},
           {"noise_grey_levels", entity.bound.noise}});
    entities.push_back(std::move(json));
  }
  return {{"entities", std::move(entities)}};
}

void print_report(const training::ConsolidateReport& report) {
  for (const training::EntityReport& entity : report.entities) {
    if (!entity.skipped_reason.empty()) {
      print(fmt::format("{}: skipped: {}", entity.entity.printable(), entity.skipped_reason));
      continue;
    }
    print(fmt::format("{} v{}: {} snapshots in {}", entity.entity.printable(), entity.model_version,
                      count_text(entity.snapshots), seconds_text(entity.seconds)));
    print(fmt::format("  raw {}, stored {}, latents {} + model {}",
                      bytes_text(static_cast<double>(entity.raw_bytes)),
                      bytes_text(static_cast<double>(entity.stored_bytes)),
                      bytes_text(static_cast<double>(entity.latent_bytes)),
                      bytes_text(static_cast<double>(entity.model_bytes))));
    if (!std::isnan(entity.mean_psnr_db))
      print(fmt::format("  PSNR {} mean over images, {} pooled, {} lowest",
                        db_text(entity.mean_psnr_db), db_text(entity.pooled_psnr_db),
                        db_text(entity.minimum_psnr_db)));
    if (!std::isnan(entity.mean_psnr_db))
      print(fmt::format("  PSNR of 5 % of the images below {}, of half {}, of 95 % {}",
                        db_text(entity.psnr_quantiles_db[0]), db_text(entity.psnr_quantiles_db[1]),
                        db_text(entity.psnr_quantiles_db[2])));
    if (!std::isnan(entity.rmse)) print("  RMSE " + number_text(entity.rmse) + " over numbers");
    if (entity.expected_encoding_seconds > 0)
      print(fmt::format("  encoding took {}, expected were {}",
                        seconds_text(entity.encoding_seconds),
                        seconds_text(entity.expected_encoding_seconds)));
    for (const std::string& line : costs_text(entity.costs)) print("  " + line);
    if (entity.training.images_per_second > 0)
      print(fmt::format("  trained on {:.1f} images per second of processor time",
                        entity.training.images_per_second));
    if (entity.waiting > 0)
      print(fmt::format("  {} snapshots wait for the next job: the time was over",
                        count_text(entity.waiting)));
    if (entity.left_behind > 0)
      print(fmt::format("  {} snapshots of another layout stay as they are",
                        count_text(entity.left_behind)));
    if (entity.forms.rows > 0)
      for (const std::string& line : forms_text(entity.forms)) print("  images: " + line);
    if (entity.choice.previous_version > 0) print(choice_text(entity.choice));
    for (const std::string& note : all_notes(entity)) print("  " + note);
  }
  for (const ltm::EntityCoding& coding : report.codes) {
    if (coding.coded == 0 && coding.left == 0) continue;
    print(fmt::format(
        "{}: {} images coded to be found by likeness (space {}{}){}", coding.entity.printable(),
        count_text(coding.coded), coding.space, coding.is_learned ? ", learned anew" : "",
        coding.left > 0
            ? fmt::format("; {} wait for the next job: the time was over", count_text(coding.left))
            : ""));
  }
  if (report.saliency.snapshots > 0)
    print(fmt::format("saliency of {} snapshots of {} entities calculated",
                      count_text(report.saliency.snapshots), count_text(report.saliency.entities)));
}

void print_dropped(const std::vector<DroppedRaw>& dropped) {
  for (const DroppedRaw& drop : dropped)
    print(fmt::format("{}: {} recorded snapshots dropped, {} freed, {} kept, in {}",
                      drop.entity.printable(), count_text(drop.report.snapshots),
                      bytes_text(static_cast<double>(drop.report.freed_bytes)),
                      count_text(drop.report.kept), seconds_text(drop.time.seconds)));
}

Json report_json(const training::ConsolidatePlan& plan, const training::ConsolidateReport& report,
                 const std::vector<DroppedRaw>& dropped) {
  Json entities = Json::array();
  for (const training::EntityReport& entity : report.entities)
    entities.push_back(entity_json(entity));
  Json drops = Json::array();
  for (const DroppedRaw& drop : dropped)
    drops.push_back({{"entity", drop.entity.to_string()},
                     {"snapshots", drop.report.snapshots},
                     {"kept", drop.report.kept},
                     {"freed_bytes", drop.report.freed_bytes},
                     {"processor_seconds", drop.time.processor_seconds},
                     {"seconds", drop.time.seconds}});
  Json codes = Json::array();
  for (const ltm::EntityCoding& coding : report.codes)
    codes.push_back({{"entity", coding.entity.to_string()},
                     {"space", coding.space},
                     {"is_learned", coding.is_learned},
                     {"coded", coding.coded},
                     {"kept", coding.kept},
                     {"skipped", coding.skipped},
                     {"waiting", coding.left}});
  return {{"plan", plan_json(plan)},
          {"entities", std::move(entities)},
          {"dropped", std::move(drops)},
          {"codes", std::move(codes)},
          {"saliency",
           {{"entities", report.saliency.entities},
            {"snapshots", report.saliency.snapshots},
            {"learned_from", report.saliency.weights.learned_from}}}};
}

}  // namespace engram::reports
