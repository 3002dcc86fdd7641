// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/picture.h"
#include "cli/progress_line.h"
#include "cli/text.h"
#include "ltm/core/log.h"
#include "training/augment/augment_store.h"
#include "training/augment/change_examples.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter =
    R"(Makes a new store of changed snapshots, for training beside the real ones:
  engram consolidate STORE --augmented NEW
Each has the entity and the time of the one that it was made of, a link to it and its recipe, and is
never taken for a real one: queries answer "augmented", and no model encodes it. Copies are further
instances of the same moment. The same seed makes the same images, on every machine.

Changes, each with a strength of 1 to 100 behind a colon, as in rotate:30:
  brightness contrast temperature   the light
  noise blur                        the sensor
  shift rotate                      the view; labels, depth and --points move along
  occlude                           something plain in front
  recolour replace                  an object, with --mask or --mask-member
Without --changes: all of them that can be made.

Examples:
  engram augment robot.engram --out changed.engram
  engram augment robot.engram 'Vision/.*/.*/cam @ last:1h' --copies 3 --seed 7 --out changed.engram
  engram augment robot.engram --changes brightness,contrast:30,shift --out changed.engram
  engram augment robot.engram Vision/RGB --picture changes.png --out changed.engram
  engram augment robot.engram Vision/RGB --mask Vision/Segmentation/head/objects --label 3 \
      --changes recolour,replace --out changed.engram)";

struct AugmentArguments {
  std::string store;
  std::string query = "@ all";
  std::string out;
  std::vector<std::string> changes;
  std::string hold = "4s";
  std::string mask;
  std::string mask_member;
  training::AugmentOptions options;
  std::string picture;
  bool is_json = false;
};

/// The first 8-bit image of each value.
Result<std::vector<idf::NdArray>> images_of(const std::vector<idf::Data>& values) {
  std::vector<idf::NdArray> images;
  for (const idf::Data& value : values) {
    const idf::NdArray* image = first_image(value);
    if (image == nullptr)
      return invalid_argument("--picture: found no image of 8 bits to show, needs one");
    images.push_back(*image);
  }
  return images;
}

/// A row for what was recorded, then one for each change.
Status write_examples(const AugmentArguments& arguments, const training::AugmentOptions& options) {
  constexpr size_t kEach = 4;
  ENGRAM_ASSIGN_OR_RETURN(const auto examples,
                          training::change_examples(arguments.store, options, kEach));
  std::vector<PictureRow> rows;
  for (const training::ChangeExample& example : examples) {
    ENGRAM_ASSIGN_OR_RETURN(auto images, images_of(example.after));
    rows.push_back({example.change, std::move(images)});
  }
  // As many images as the others have: the first row says how many columns there are.
  const std::vector<idf::Data> before(kEach, examples.front().before);
  ENGRAM_ASSIGN_OR_RETURN(auto images, images_of(before));
  rows.insert(rows.begin(), {"recorded", std::move(images)});
  return write_contact_sheet(arguments.picture, rows, {});
}

Result<training::AugmentOptions> options_of(const AugmentArguments& arguments) {
  training::AugmentOptions options = arguments.options;
  // Where nobody says which snapshots, the latest one would be few.
  const bool has_selector = arguments.query.find('@') != std::string::npos;
  ENGRAM_ASSIGN_OR_RETURN(options.query,
                          ltm::Query::parse(arguments.query + (has_selector ? "" : " @ all")));
  ENGRAM_ASSIGN_OR_RETURN(options.hold, parse_duration(arguments.hold));
  if (!arguments.mask.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.mask_entity, ltm::MemoryId::parse(arguments.mask));
  }
  if (!arguments.mask_member.empty()) options.members.labels.push_back(arguments.mask_member);
  for (const std::string& text : arguments.changes) {
    ENGRAM_ASSIGN_OR_RETURN(options.changes.emplace_back(),
                            augmentation::parse_change_choice(text, options.strength_percent));
  }
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

Json report_json(const training::AugmentReport& report, const AugmentArguments& arguments) {
  Json entities = Json::array();
  for (const training::AugmentedEntity& entity : report.entities) {
    Json json{{"id", entity.entity.to_string()},     {"snapshots", entity.snapshots},
              {"instances", entity.instances},       {"left_out", entity.left_out},
              {"without_mask", entity.without_mask}, {"stored_bytes", entity.stored_bytes}};
    if (!entity.skipped_reason.empty()) json["skipped_reason"] = entity.skipped_reason;
    entities.push_back(std::move(json));
  }
  return {{"store", arguments.store},
          {"out", arguments.out},
          {"source", ltm::to_string(ltm::Source::kAugmented)},
          {"seed", arguments.options.seed},
          {"copies", arguments.options.copies},
          {"damaged_journal_places", report.damaged_places},
          {"is_cancelled", report.is_cancelled},
          {"entities", std::move(entities)}};
}

void print_report(const training::AugmentReport& report, const AugmentArguments& arguments) {
  print(fmt::format("Augmented store {}", arguments.out));
  for (const training::AugmentedEntity& entity : report.entities) {
    print("\n" + entity.entity.to_string());
    if (!entity.skipped_reason.empty()) {
      print("  skipped    " + entity.skipped_reason);
      continue;
    }
    print(fmt::format("  made       {} of {} snapshots", count_text(entity.instances),
                      count_text(entity.snapshots)));
    if (entity.left_out > 0)
      print(fmt::format("  left out   {}{}", count_text(entity.left_out),
                        entity.without_mask > 0 ? ", where nothing tells the object" : ""));
    print("  stored     " + bytes_text(static_cast<double>(entity.stored_bytes)));
  }
}

ExitCode run(const AugmentArguments& arguments) {
  const auto options = options_of(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  ProgressLine progress;
  const auto report = training::augment_store(arguments.store, arguments.out, *options,
                                              progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(report_json(*report, arguments));
  else
    print_report(*report, arguments);
  if (!arguments.picture.empty()) {
    const Status shown = write_examples(arguments, *options);
    if (!shown.ok()) return fail(shown);
  }
  if (report->is_cancelled) return fail(cancelled("augment was stopped; what is there is whole"));
  if (report->damaged_places == 0) return ExitCode::kDone;
  log::warning("store '{}': {} damaged places in its journals; what was there is not augmented",
               arguments.store, report->damaged_places);
  return ExitCode::kDoneWithLoss;
}

}  // namespace

void add_augment_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<AugmentArguments>();
  training::AugmentOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("augment", "Make changed snapshots to train on");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command
      ->add_option("query", arguments->query,
                   "NAMES @ SELECTOR, see 'engram query --help'; without @: all")
      ->capture_default_str();
  command->add_option("-o,--out", arguments->out, "The new store")->required();
  command->add_option("--copies", options.copies, "Changed snapshots per snapshot")
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of all chance")->capture_default_str();
  command->add_option("--changes", arguments->changes, "NAME or NAME:STRENGTH, see below")
      ->delimiter(',');
  command->add_option("--strength", options.strength_percent, "Of changes without their own")
      ->capture_default_str();
  command
      ->add_option("--hold", arguments->hold,
                   "Snapshots of so long a time share a recipe, but for its noise; 0s: none do")
      ->check(duration_text())
      ->capture_default_str();
  command->add_option("--mask", arguments->mask,
                      "Entity whose image tells which object is seen, at the same moment");
  command->add_option("--mask-member", arguments->mask_member,
                      "Member of the values that tells it");
  command->add_option("--label", options.label, "The object to change; 0: all that have a label")
      ->capture_default_str();
  command->add_option("--points", options.members.points,
                      "Members that are places in the image, x and y in pixels: they move along");
  command->add_option("--image-codec", options.image_codec, "How images are stored")
      ->capture_default_str();
  command->add_option("--picture", arguments->picture,
                      "PNG that shows each change by itself on the newest snapshot");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
