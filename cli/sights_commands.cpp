// SPDX-License-Identifier: Apache-2.0
// What images show, told from their latents: learning to see it, and looking for it.
#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/core/printable.h"
#include "memory/memory.h"
#include "speech/sights/learn_sights.h"
#include "speech/sights/notice_sights.h"

namespace engram::cli {

namespace {

constexpr const char* kLearnSightsFooter =
    R"(Learns to see things in the latents that nights made of images: which are in sight, on which place
or in which hand, and which colour they have. It learns from memories that tell all this besides, such
as those of simulated kitchens, and their images have to be latents of one model; what it learned is
used with engram notice-sights on memories whose images that model encoded, too
(docs/verbalisation.md, "What images show").

Examples:
  engram simulate kitchen kitchens.engram --seed 1..40 --colours --fast
  engram consolidate kitchens.engram --representation latents --training 20m
  engram learn-sights kitchens.engram --out kitchens.sights --budget 10m)";

constexpr const char* kNoticeSightsFooter =
    R"(Looks for things in the latents of images, with a network of engram learn-sights. No image is
decoded. With --commit it is written into the store as snapshots of Objects/Sightings/seen, each with
a link to the image that it was read from, and the store can be asked: "Where did you last see the
milk?" Of things whose poses others tell nothing is written: those are known better. What was
committed before is not committed again, so a nightly job may run it each night.

Examples:
  engram notice-sights robot.engram --network kitchens.sights
  engram notice-sights robot.engram --network kitchens.sights --commit
  engram notice-sights robot.engram --network kitchens.sights --json | jq '.sightings[].where')";

struct LearnSightsArguments {
  std::vector<std::filesystem::path> stores;
  std::filesystem::path out;
  speech::LearnSightsOptions options;
  std::string budget = "10m";
  bool is_json = false;
};

struct NoticeSightsArguments {
  std::string store;
  std::string network;
  std::string since;
  bool is_committed = false;
  bool is_json = false;
};

ExitCode learn(LearnSightsArguments arguments) {
  const auto budget = parse_duration(arguments.budget);
  if (!budget.ok()) return wrong_usage(budget.status());
  arguments.options.budget = *budget;
  if (const Status options = arguments.options.validate(); !options.ok())
    return wrong_usage(options);
  ProgressLine progress;
  const auto report = speech::learn_sights(arguments.stores, arguments.options, arguments.out,
                                           progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json) {
    print_json({{"file", arguments.out.string()},
                {"images", report->images},
                {"copies", report->copies},
                {"recordings", report->recordings},
                {"held_out", report->held_out},
                {"steps", report->steps},
                {"parameters", report->parameters},
                {"seconds", report->seconds},
                {"loss", report->loss},
                {"min_probability", report->min_probability},
                {"found", report->found},
                {"found_rightly", report->found_rightly},
                {"place_right", report->place_right},
                {"colour_right", report->colour_right}});
    return ExitCode::kDone;
  }
  print(fmt::format(
      "{}: learned from {} images and {} changed copies in {} steps and {:.0f} s\n"
      "  of {} of {} recordings, which it did not learn from: {:.1f} % of what is in sight is "
      "found,\n  {:.1f} % of what is found is there; of that {:.1f} % of the places and {:.1f} % "
      "of the colours are right",
      arguments.out.string(), report->images, report->copies, report->steps, report->seconds,
      report->held_out, report->recordings, 100 * report->found, 100 * report->found_rightly,
      100 * report->place_right, 100 * report->colour_right));
  return ExitCode::kDone;
}

Json sighting_json(const speech::Sighting& one) {
  return {{"time", to_string(one.time)},
          {"kind", one.kind.to_string()},
          {"image", one.image.to_string()},
          {"is_in_sight", one.is_in_sight},
          {"where", one.where},
          {"colour", one.colour},
          {"probability", one.probability}};
}

Status notice(const NoticeSightsArguments& arguments) {
  speech::NoticeSightsOptions options;
  if (!arguments.since.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.from, parse_time(arguments.since));
  }
  ProgressLine progress;
  auto found = speech::notice_sights(arguments.store, arguments.network, options, progress.sink(),
                                     interrupt_token());
  progress.finish();
  ENGRAM_RETURN_IF_ERROR(found.status());
  size_t committed = 0;
  if (arguments.is_committed) {
    ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(arguments.store));
    ENGRAM_ASSIGN_OR_RETURN(committed, speech::remember_sights(*memory, found->sightings));
    ENGRAM_RETURN_IF_ERROR(memory->close());
  }
  if (arguments.is_json) {
    Json sightings = Json::array();
    for (const speech::Sighting& one : found->sightings) sightings.push_back(sighting_json(one));
    Json known = Json::array();
    for (const ltm::MemoryId& kind : found->known) known.push_back(kind.to_string());
    print_json({{"images", found->images},
                {"others", found->others},
                {"known", std::move(known)},
                {"sightings", std::move(sightings)},
                {"committed", committed}});
    return {};
  }
  for (const speech::Sighting& one : found->sightings)
    print(fmt::format("{}  {:<14} {:<10} {:<40} {:.2f}", to_string(one.time),
                      printable(one.kind.names().back()), printable(one.colour),
                      one.is_in_sight ? printable(one.where) : "no longer in sight",
                      one.probability));
  print(fmt::format("{} sightings in {} images{}{}", found->sightings.size(), found->images,
                    found->known.empty()
                        ? std::string()
                        : fmt::format("; {} kinds are known better", found->known.size()),
                    arguments.is_committed ? fmt::format("; {} committed", committed) : ""));
  return {};
}

}  // namespace

void add_learn_sights_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<LearnSightsArguments>();
  CLI::App* command = app.add_subcommand("learn-sights", "Learn to see things in latents");
  command->footer(kLearnSightsFooter);
  command->add_option("stores", arguments->stores, "Stores that tell where things were")
      ->required();
  command->add_option("-o,--out", arguments->out, "The file to write")->required();
  command->add_option("--budget", arguments->budget, "How long it trains, once images are read")
      ->check(duration_text())
      ->capture_default_str();
  command
      ->add_option("--copies", arguments->options.copies,
                   "Changed copies of each image that are learned from, too")
      ->capture_default_str();
  command->add_option("--threads", arguments->options.threads, "Threads that compute")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--batch", arguments->options.batch, "Images of a step")
      ->capture_default_str();
  command->add_option("--rate", arguments->options.learning_rate, "Learning rate")
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Of weights, changes and order")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = learn(*arguments); });
}

void add_notice_sights_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<NoticeSightsArguments>();
  CLI::App* command = app.add_subcommand("notice-sights", "Find things in the latents of images");
  command->footer(kNoticeSightsFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--network", arguments->network, "A network of engram learn-sights")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--since", arguments->since, "Only images from this time on")
      ->check(time_text());
  command->add_flag("--commit", arguments->is_committed, "Write what was found into the store");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = done_or_failed(notice(*arguments)); });
}

}  // namespace engram::cli
