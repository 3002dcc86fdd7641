// SPDX-License-Identifier: Apache-2.0
#include "cli/predict_options.h"

namespace engram::cli {

namespace {

/// The default horizons. Those of --list are durations, so that entities can be compared; for
/// entities with long steps they are numbers of steps.
constexpr std::string_view kPredicted = "1..3";
constexpr std::string_view kListed = "200ms,400ms,1s";
constexpr std::string_view kListedOfSlow = "1,2,5";
constexpr Duration kSlow = std::chrono::milliseconds(250);

}  // namespace

void add_predict_options(CLI::App& command, PredictArguments& arguments) {
  command.add_option("store", arguments.store, "Store; none where a server is asked");
  command.add_option("entity", arguments.entity, "Memory/Core/Provider/Entity");
  add_remote_options(command, arguments.remote);
  command.add_option("--at", arguments.at, "The last moment that is known; else the newest one")
      ->check(time_text());
  command
      .add_option("--horizons", arguments.horizons,
                  "Steps ahead ('1..3', '2') or durations ('+200ms,+400ms')")
      ->default_str("1..3, with --list 200ms,400ms,1s");
  command.add_option("--engine", arguments.engine,
                     "What predicts (--list); else the best for each horizon");
  command
      .add_option("--plan", arguments.plan,
                  "Entity of planned numbers, of the same layout as what predictions start from "
                  "beside the images; that one itself: what came of it")
      ->check(entity_text());
  command.add_flag("--compare", arguments.is_compared,
                   "Only where something is known of what came; without --at from the last moment "
                   "whose horizons are all known");
  command.add_option("--picture", arguments.picture,
                     "Draw the last image, what came, the prediction and its error (PNG)");
  command.add_option("--save", arguments.save,
                     "Write predicted images (PNG) and data (JSON) below a folder");
  command
      .add_option("--every", arguments.every, "Means over the predictions from every N-th snapshot")
      ->check(CLI::PositiveNumber);
  command.add_option("--from", arguments.from, "The first moment of these")->check(time_text());
  command.add_option("--to", arguments.to, "The last moment of these")->check(time_text());
  command.add_flag("--list", arguments.is_list,
                   "What can predict the entity, its errors on the entity's own past, and which "
                   "one answers");
  command.add_flag("--json", arguments.is_json, "As JSON, with all predicted data");
}

std::string horizons_text(const PredictArguments& arguments, Duration step) {
  if (!arguments.horizons.empty()) return arguments.horizons;
  if (!arguments.is_list) return std::string(kPredicted);
  return std::string(step < kSlow ? kListed : kListedOfSlow);
}

std::optional<Time> time_of(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(*parse_time(text));
}

void show(const PredictArguments& arguments, const std::string& text, const Json& json) {
  if (arguments.is_json)
    print_json(json);
  else
    print(text);
}

}  // namespace engram::cli
