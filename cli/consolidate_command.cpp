// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "cli/command.h"
#include "cli/forms_text.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/text.h"
#include "training/consolidate.h"
#include "training/drop_raw.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram consolidate robot.engram
  engram consolidate robot.engram --budget 30m --entity 'Vision/.*'
  engram consolidate robot.engram --psnr 40
  engram consolidate robot.engram --representation latents --psnr 35 --width 128
  engram consolidate robot.engram --drop-raw --min-psnr 30

Trains one autoencoder per entity with new recorded snapshots, encodes them, decodes what is
stored and measures its error. Each block of images is kept as latents or as video, whichever takes
fewer bytes with every image at --psnr or better; where networks cannot save five times what they
take themselves in --nights nights, video alone is used and no network is trained for images.
Numbers are kept within --number-bound. Recorded data stays until --drop-raw. Ctrl-C or a kill at any
moment leaves the store as it was, or with whole entities done.)";

struct ConsolidateArguments {
  std::string store;
  training::ConsolidateOptions options;
  training::DropOptions drop;
  std::string budget = "2min";
  std::string representation = "auto";
  std::string variant = "rate";
  double psnr_db = 36;
  int steps = 0;
  bool drops_raw = false;
  bool is_json = false;
};

/// What was dropped of an entity, beside its report.
struct Dropped {
  ltm::MemoryId entity;
  ltm::DropReport report;
};

Json number_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

std::vector<std::string> all_notes(const training::EntityReport& entity) {
  std::vector<std::string> notes = entity.notes;
  notes.insert(notes.end(), entity.training.notes.begin(), entity.training.notes.end());
  return notes;
}

Json report_json(const training::ConsolidateReport& report, const std::vector<Dropped>& dropped) {
  Json entities = Json::array();
  for (const training::EntityReport& entity : report.entities) {
    Json json{{"entity", entity.entity.to_string()}};
    if (!entity.skipped_reason.empty()) {
      json["skipped"] = entity.skipped_reason;
    } else {
      json.update({{"model_version", entity.model_version},
                   {"snapshots", entity.snapshots},
                   {"left_behind", entity.left_behind},
                   {"raw_bytes", entity.raw_bytes},
                   {"stored_bytes", entity.stored_bytes},
                   {"latent_bytes", entity.latent_bytes},
                   {"model_bytes", entity.model_bytes},
                   {"psnr_mean_over_images_db", number_or_null(entity.mean_psnr_db)},
                   {"psnr_pooled_error_db", number_or_null(entity.pooled_psnr_db)},
                   {"psnr_minimum_db", number_or_null(entity.minimum_psnr_db)},
                   {"rmse", number_or_null(entity.rmse)},
                   {"seconds", entity.seconds},
                   {"images", forms_json(entity.forms)},
                   {"notes", all_notes(entity)}});
    }
    entities.push_back(std::move(json));
  }
  Json drops = Json::array();
  for (const Dropped& drop : dropped)
    drops.push_back({{"entity", drop.entity.to_string()},
                     {"snapshots", drop.report.snapshots},
                     {"kept", drop.report.kept},
                     {"freed_bytes", drop.report.freed_bytes}});
  return {{"entities", std::move(entities)}, {"dropped", std::move(drops)}};
}

void print_report(const training::ConsolidateReport& report) {
  for (const training::EntityReport& entity : report.entities) {
    if (!entity.skipped_reason.empty()) {
      print(fmt::format("{}: skipped: {}", entity.entity.to_string(), entity.skipped_reason));
      continue;
    }
    print(fmt::format("{} v{}: {} snapshots in {}", entity.entity.to_string(), entity.model_version,
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
    if (!std::isnan(entity.rmse)) print("  RMSE " + number_text(entity.rmse) + " over numbers");
    if (entity.left_behind > 0)
      print(fmt::format("  {} snapshots of another layout stay as they are",
                        count_text(entity.left_behind)));
    if (entity.forms.rows > 0) print("  images: " + forms_text(entity.forms));
    for (const std::string& note : all_notes(entity)) print("  " + note);
  }
}

Status drop_all(const ConsolidateArguments& arguments, const training::ConsolidateReport& report,
                const ProgressSink& progress, std::vector<Dropped>& dropped) {
  for (const training::EntityReport& entity : report.entities) {
    ENGRAM_ASSIGN_OR_RETURN(const auto done,
                            training::drop_raw(arguments.store, entity.entity, arguments.drop,
                                               progress, interrupt_token()));
    dropped.push_back({entity.entity, done});
  }
  return {};
}

ExitCode run(ConsolidateArguments& arguments) {
  const auto budget = parse_duration(arguments.budget);
  if (!budget.ok()) return wrong_usage(budget.status());
  arguments.options.train.budget = *budget;
  if (arguments.steps > 0) arguments.options.train.steps = arguments.steps;
  const auto variant = encoders::training_variant_of(arguments.variant);
  if (!variant.ok()) return wrong_usage(variant.status());
  arguments.options.train.variant = *variant;
  const auto representation = training::representation_of(arguments.representation);
  if (!representation.ok()) return wrong_usage(representation.status());
  arguments.options.representation.kind = *representation;
  arguments.options.representation.bound_db = arguments.options.train.psnr_db = arguments.psnr_db;
  if (const Status status = arguments.options.validate(); !status.ok()) return wrong_usage(status);
  ProgressLine progress;
  const auto report =
      training::consolidate(arguments.store, arguments.options, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (!arguments.is_json) print_report(*report);
  std::vector<Dropped> dropped;
  if (arguments.drops_raw) {
    const Status status = drop_all(arguments, *report, progress.sink(), dropped);
    progress.finish();
    if (!status.ok()) return fail(status);
  }
  if (arguments.is_json) {
    print_json(report_json(*report, dropped));
    return ExitCode::kDone;
  }
  for (const Dropped& drop : dropped)
    print(fmt::format("{}: {} recorded snapshots dropped, {} freed, {} kept",
                      drop.entity.to_string(), count_text(drop.report.snapshots),
                      bytes_text(static_cast<double>(drop.report.freed_bytes)),
                      count_text(drop.report.kept)));
  return ExitCode::kDone;
}

}  // namespace

void add_consolidate_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ConsolidateArguments>();
  training::ConsolidateOptions& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("consolidate", "Train an autoencoder per entity and store latents");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", options.entities, "Names or patterns of entities; else all");
  command->add_option("--budget", arguments->budget, "Training time of all entities together")
      ->check(duration_text())
      ->capture_default_str();
  command->add_option("--steps", arguments->steps,
                      "Optimiser steps instead of a time: same seed, same model");
  command->add_option("--seed", options.train.seed, "Seed of all chance")->capture_default_str();
  command
      ->add_option("--representation", arguments->representation,
                   "How images are kept: auto, latents or video")
      ->check(CLI::IsMember({"auto", "latents", "video"}))
      ->capture_default_str();
  command
      ->add_option("--psnr", arguments->psnr_db,
                   "Least PSNR of every image, dB; with latents alone the mean to aim at")
      ->capture_default_str();
  command
      ->add_option("--variant", arguments->variant,
                   "What latents are trained for: rate (few bytes), ae, vae or wae")
      ->check(CLI::IsMember({"rate", "ae", "vae", "wae"}))
      ->capture_default_str();
  command
      ->add_option("--video", options.representation.video,
                   "Video codec that latents compete with: av1, h265 or h264")
      ->check(CLI::IsMember({"av1", "h265", "h264"}))
      ->capture_default_str();
  command
      ->add_option("--nights", options.representation.nights,
                   "Nights like this one that share the bytes of a model")
      ->capture_default_str();
  command
      ->add_option("--refine", options.representation.refine_steps,
                   "Steps that search better latents for each block: smaller and better, but slow")
      ->capture_default_str();
  command
      ->add_option("--number-bound", options.train.number_bound,
                   "Largest error of numbers; 0: 0.005 standard deviations of each")
      ->capture_default_str();
  command
      ->add_option("--width", options.train.width,
                   "Features of the networks, a multiple of 16; 0: by the number of snapshots")
      ->capture_default_str();
  command
      ->add_option("--block", options.train.block_rows,
                   "Snapshots coded together: more take fewer bytes, one is reached later")
      ->capture_default_str();
  command->add_option("--threads", options.train.threads, "Threads of the networks")
      ->capture_default_str();
  command
      ->add_option("--hold-out", options.train.hold_out_recordings,
                   "So many of the last recordings take no part in training")
      ->capture_default_str();
  command->add_option("--min-snapshots", options.min_snapshots, "Smaller entities are skipped")
      ->capture_default_str();
  command->add_flag("--force", options.force, "Train even where nothing is new");
  command->add_flag("--reuse-models", options.reuses_models,
                    "Encode with the newest model of each entity instead of training one");
  CLI::Option* drop =
      command->add_flag("--drop-raw", arguments->drops_raw,
                        "Drop recorded data whose latents were decoded and compared");
  command->add_option("--min-psnr", arguments->drop.min_psnr_db, "Worse images stay recorded, dB")
      ->needs(drop);
  command->add_option("--max-rmse", arguments->drop.max_rmse, "Worse numbers stay recorded")
      ->needs(drop);
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
