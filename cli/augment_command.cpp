// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/scene_sources.h"
#include "ltm/core/log.h"
#include "reports/augment_picture.h"
#include "reports/augment_text.h"
#include "training/augment/augment_store.h"
#include "training/augment/render_store.h"

namespace engram::cli {

namespace {

constexpr const char* kAugmentFooter =
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

With --render moments are rebuilt from all that is remembered of them, and rendered anew by Blender
(3.4; Debian: apt install blender), in these ways:
  original    as it was               recolour    a thing has another colour
  view        the camera moved        replace     a thing stands where another one stood
  light       other lamps             all         all of these
Stores of "engram simulate kitchen" can be rebuilt.

Examples:
  engram augment robot.engram --out changed.engram
  engram augment robot.engram 'Vision/.*/.*/cam @ last:1h' --copies 3 --seed 7 --out changed.engram
  engram augment robot.engram --changes brightness,contrast:30,shift --out changed.engram
  engram augment robot.engram Vision/RGB --picture changes.png --out changed.engram
  engram augment robot.engram Vision/RGB --mask Vision/Segmentation/head/objects --label 3 \
      --changes recolour,replace --out changed.engram
  engram augment kitchen.engram Vision/RGB --render all --render-every 1min --out rendered.engram
  engram augment kitchen.engram Vision/RGB#0 --render view,light --picture seen.png --out new.engram)";

struct AugmentArguments {
  std::string store;
  std::string query = "@ all";
  std::string out;
  std::vector<std::string> changes;
  std::string hold = "4s";
  std::string mask;
  std::string mask_member;
  training::AugmentOptions options;
  std::vector<std::string> render;
  std::string render_every = "20s";
  training::RenderOptions render_options;
  std::string picture;
  bool is_json = false;

  [[nodiscard]] bool is_rendering() const { return !render.empty(); }
};

Result<training::AugmentOptions> options_of(const AugmentArguments& arguments) {
  training::AugmentOptions options = arguments.options;
  // Without a selector a query returns the latest snapshot, which is too few to augment.
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

Result<training::RenderOptions> render_options_of(const AugmentArguments& arguments,
                                                  const training::AugmentedStoreOptions& common) {
  training::RenderOptions options = arguments.render_options;
  static_cast<training::AugmentedStoreOptions&>(options) = common;
  ENGRAM_ASSIGN_OR_RETURN(options.every, parse_duration(arguments.render_every));
  if (arguments.render != std::vector<std::string>{"all"}) {
    options.kinds.clear();
    for (const std::string& text : arguments.render) {
      ENGRAM_ASSIGN_OR_RETURN(options.kinds.emplace_back(), augmentation::parse_scene_change(text));
    }
  }
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

Result<training::AugmentReport> render(const AugmentArguments& arguments,
                                       const training::RenderOptions& options,
                                       const ProgressSink& progress) {
  ENGRAM_ASSIGN_OR_RETURN(const auto scenes, make_scene_source());
  return training::render_store(arguments.store, arguments.out, options, *scenes, progress,
                                interrupt_token());
}

Status write_picture(const AugmentArguments& arguments, const training::AugmentOptions& options) {
  if (arguments.picture.empty()) return {};
  // Blender has drawn these moments already, so they are read from the new store. Changes of images
  // are made again, because the store has them mixed and the picture shows each by itself.
  if (arguments.is_rendering())
    return reports::write_rendered_examples(arguments.store, arguments.out, arguments.picture);
  return reports::write_change_examples(arguments.store, options, arguments.picture);
}

ExitCode run(const AugmentArguments& arguments) {
  // All words are read before the new store is made: a store that exists is refused, so one that a
  // wrong option left behind would be in the way of the corrected command.
  const auto options = options_of(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  Result<training::RenderOptions> rendering = training::RenderOptions();
  if (arguments.is_rendering()) rendering = render_options_of(arguments, *options);
  if (!rendering.ok()) return wrong_usage(rendering.status());
  ProgressLine progress;
  const auto report = arguments.is_rendering()
                          ? render(arguments, *rendering, progress.sink())
                          : training::augment_store(arguments.store, arguments.out, *options,
                                                    progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::augment_json(*report, arguments.store, arguments.out, arguments.options));
  else
    reports::print_augmented(*report, arguments.out);
  if (const Status shown = write_picture(arguments, *options); !shown.ok()) return fail(shown);
  if (report->is_cancelled) return fail(cancelled("augment was stopped; what is there is whole"));
  if (report->damaged_places == 0) return ExitCode::kDone;
  log::warning("store '{}': {} damaged places in its journals; what was there is not augmented",
               arguments.store, report->damaged_places);
  return ExitCode::kDoneWithLoss;
}

void add_render_options(CLI::App& command, AugmentArguments& arguments) {
  training::RenderOptions& options = arguments.render_options;
  CLI::Option* render = command.add_option("--render", arguments.render,
                                           "Render moments anew in these ways, see below");
  render->allow_extra_args(false)->delimiter(',');
  // Rendering ignores these options, so they are refused: nobody should believe that they counted.
  for (const char* other : {"--changes", "--mask", "--mask-member", "--label", "--points"})
    render->excludes(command.get_option(other));
  const auto add = [&](const char* name, auto& value, const char* about) {
    return command.add_option(name, value, about)->needs(render)->capture_default_str();
  };
  add("--render-every", arguments.render_every,
      "Of each period of so long a time the first --hold is rendered; 0s: everything")
      ->check(duration_text());
  add("--render-width", options.width, "Pixels; images that are wider are enlarged from it");
  add("--render-samples", options.blender.samples, "Max number of samples per pixel");
  add("--render-noise", options.blender.noise,
      "Pixels that vary less get fewer samples; 0: all get all, and a change shows nowhere else");
  add("--render-threads", options.blender.threads, "Of Blender");
}

}  // namespace

void add_augment_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<AugmentArguments>();
  training::AugmentOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("augment", "Make changed snapshots to train on");
  command->footer(kAugmentFooter);
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
      ->allow_extra_args(false)
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
  add_render_options(*command, *arguments);
  command->add_option("--picture", arguments->picture,
                      "PNG that shows each change by itself on the newest snapshot, or what was "
                      "rendered of some moments");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
