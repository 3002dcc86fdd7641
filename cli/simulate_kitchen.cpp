// SPDX-License-Identifier: Apache-2.0
#include "cli/simulate_kitchen.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <utility>

#include "cli/child_process.h"
#include "cli/interrupt.h"
#include "cli/live_kitchen.h"
#include "cli/progress_line.h"
#include "cli/shared_progress.h"
#include "datasets/export.h"
#include "datasets/kitchen/kitchen.h"
#include "datasets/plain_files.h"
#include "ltm/recording/recording_config.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kSimulateKitchenFooter = R"(Examples:
  engram simulate kitchen kitchen.engram --seed 3
  engram simulate kitchen kitchen.engram --fast --seconds 20
  engram simulate kitchen --folder episodes --seed 1..5 --jobs 2
  engram simulate kitchen --folder days --seed 1..1000 --no-images --jobs 2
  engram simulate kitchen --folder plain --plain --fast --seconds 20
  engram query kitchen.engram 'Skill/Event @ all'
  engram simulate kitchen --live                     beside 'engram serve robot.engram'
  engram simulate kitchen --live --fast --chair 1.0,0.2 --person -0.6,-1
  engram simulate kitchen --live --stepped --fast --seconds 5
  engram simulate kitchen --live --stepped --held    time passes while kitchen/pass runs

A humanoid brings objects from a counter to a table and back (docs/kitchen.md). Seeds are recorded
into one store, one after the other, or each into a store kitchen-SEED.engram of a folder, by
several processes. Unless --start says otherwise seed 1 begins at 2026-01-01 08:00 and each one an
hour later. Equal options give equal snapshots. Everything is kept without loss unless --config or
--preset says otherwise (docs/recording.md).

With --live nothing is recorded here: the robot's drivers commit to a server what they sense, from
now on and until Ctrl-C or for --seconds.)";

struct KitchenArguments {
  datasets::KitchenOptions options;
  std::string store;
  std::string folder;
  std::string seeds = "1";
  std::string start;
  std::string config;
  std::string preset = "recorder";
  std::string progress = "line";
  int jobs = 1;
  bool is_fast = false;
  bool has_no_images = false;
  bool is_plain = false;  ///< Writes files instead of stores.
  LiveKitchenArguments live;
};

/// Parses "3", "1..5", or several of these separated by commas.
Result<std::vector<uint64_t>> read_seeds(const std::string& text) {
  constexpr unsigned long long kMax = 1'000'000;
  std::vector<uint64_t> seeds;
  std::stringstream parts(text + ",");
  for (std::string part; std::getline(parts, part, ',');) {
    unsigned long long first = 0;
    unsigned long long last = 0;
    int used = 0;
    if (std::sscanf(part.c_str(), "%llu%n", &first, &used) != 1) used = -1;
    last = first;
    if (used >= 0 && static_cast<size_t>(used) < part.size() &&
        std::sscanf(part.c_str(), "%llu..%llu%n", &first, &last, &used) != 2)
      used = -1;
    if (used < 0 || static_cast<size_t>(used) != part.size() || first > last || last > kMax ||
        first < 1)
      return invalid_argument("--seed '{}': needs numbers from 1 to {}, as in 3, 1..5 or 1,4", text,
                              kMax);
    for (unsigned long long seed = first; seed <= last; ++seed) seeds.push_back(seed);
  }
  return seeds;
}

Result<ltm::Recorder::Options> recorder_options(const KitchenArguments& arguments) {
  if (!arguments.config.empty()) return ltm::read_recording_config(arguments.config);
  ENGRAM_ASSIGN_OR_RETURN(const std::string_view yaml, ltm::recording_preset(arguments.preset));
  ENGRAM_ASSIGN_OR_RETURN(auto options,
                          ltm::parse_recording_config(yaml, "preset " + arguments.preset));
  options.max_ahead = ltm::AheadLimits::kNone;  // Its days may be any.
  return options;
}

std::string store_of(const KitchenArguments& arguments, uint64_t seed) {
  if (arguments.folder.empty()) return arguments.store;
  const std::string name = fmt::format("kitchen-{}{}", seed, arguments.is_plain ? "" : ".engram");
  return (std::filesystem::path(arguments.folder) / name).string();
}

using CommitSink = std::function<Status(const ltm::Commit&)>;

/// Simulates into a sink until a stop is requested.
Result<datasets::KitchenSummary> simulate(const datasets::KitchenOptions& options,
                                          const CommitSink& take, const ProgressSink& progress) {
  const std::stop_token stop = interrupt_token();
  const auto sink = [&](const ltm::Commit& commit) -> Status {
    if (stop.stop_requested()) return cancelled("kitchen: stopped; what was recorded is there");
    return take(commit);
  };
  return datasets::simulate_kitchen(options, sink, progress);
}

Result<datasets::KitchenSummary> record(const KitchenArguments& arguments,
                                        const datasets::KitchenOptions& options,
                                        const ProgressSink& progress) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Recorder::Options recording, recorder_options(arguments));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder,
                          ltm::Recorder::open(store_of(arguments, options.seed), recording));
  for (const auto& [segment, type] :
       datasets::kitchen_types(options.has_images, options.has_colours))
    ENGRAM_RETURN_IF_ERROR(recorder.declare(segment, type));
  ENGRAM_ASSIGN_OR_RETURN(
      const datasets::KitchenSummary summary,
      simulate(
          options, [&](const ltm::Commit& commit) { return recorder.commit(commit); }, progress));
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  return summary;
}

Result<datasets::KitchenSummary> write_files(const KitchenArguments& arguments,
                                             const datasets::KitchenOptions& options,
                                             const ProgressSink& progress) {
  const std::string directory = store_of(arguments, options.seed);
  ENGRAM_RETURN_IF_ERROR(datasets::prepare_export(directory, false));
  datasets::PlainFiles files(directory);
  ENGRAM_ASSIGN_OR_RETURN(
      const datasets::KitchenSummary summary,
      simulate(
          options, [&](const ltm::Commit& commit) { return files.commit(commit); }, progress));
  ENGRAM_RETURN_IF_ERROR(files.finish());
  return summary;
}

void print_summary(const std::string& store, const datasets::KitchenOptions& options,
                   const datasets::KitchenSummary& summary) {
  print(
      fmt::format("{}: seed {}, {} stereo images in {:g} s, {}/s plain; actions: {} succeeded, {} "
                  "failed, {} stopped",
                  store, options.seed, summary.images, options.seconds,
                  reports::bytes_text(static_cast<double>(summary.raw_bytes) / options.seconds),
                  summary.succeeded, summary.failed, summary.stopped));
  std::fflush(stdout);
}

ProgressForm form_of(const KitchenArguments& arguments) {
  return arguments.progress == "json"   ? ProgressForm::kJson
         : arguments.progress == "none" ? ProgressForm::kNone
                                        : ProgressForm::kText;
}

/// Converts the progress of one recording into that of all.
ProgressSink part_of(ProgressSink all, uint64_t part, uint64_t parts) {
  if (!all) return all;
  return [all = std::move(all), part, parts](Progress progress) {
    progress.done += part * progress.total;
    progress.total *= parts;
    all(progress);
  };
}

/// Simulates all seeds in this process.
ExitCode run_here(const KitchenArguments& arguments, const std::vector<uint64_t>& seeds) {
  ProgressLine progress(form_of(arguments));
  for (size_t i = 0; i < seeds.size(); ++i) {
    const uint64_t seed = seeds[i];
    datasets::KitchenOptions options = arguments.options;
    options.seed = seed;
    // Recordings of several seeds go into one store, so their times must not overlap.
    if (arguments.start.empty()) options.start += std::chrono::hours(seed - 1);
    const ProgressSink part = part_of(progress.sink(), i, seeds.size());
    const auto summary = arguments.is_plain ? write_files(arguments, options, part)
                                            : record(arguments, options, part);
    progress.finish();
    if (!summary.ok()) return fail(summary.status());
    print_summary(store_of(arguments, seed), options, *summary);
  }
  return ExitCode::kDone;
}

/// Distributes the seeds over processes in turn.
ExitCode run_children_for(const KitchenArguments& arguments, const std::vector<uint64_t>& seeds,
                          const std::vector<std::string>& same) {
  const size_t count = std::min(seeds.size(), static_cast<size_t>(arguments.jobs));
  ProgressLine line(form_of(arguments));
  SharedProgress progress(count, line);
  std::vector<ChildProcess> children;
  for (size_t i = 0; i < count; ++i) {
    std::string own;
    for (size_t k = i; k < seeds.size(); k += count)
      own += (own.empty() ? "" : ",") + std::to_string(seeds[k]);
    std::vector<std::string> all{"/proc/self/exe", "simulate", "kitchen"};
    all.insert(all.end(), same.begin(), same.end());
    for (const std::string& more :
         {"--seed=" + own, std::string("--jobs=1"), std::string("--progress=json")})
      all.push_back(more);
    children.push_back({all, [&progress, &arguments, i](const std::string& text) {
                          progress.tell(i, text, arguments.progress == "json");
                        }});
  }
  const Status run = run_children(children, interrupt_token());
  line.finish();
  if (!run.ok()) return fail(run);
  bool are_done = true;
  for (const ChildProcess& child : children) {
    fmt::print("{}", child.output);
    are_done = are_done && child.exit_code == 0;
  }
  return are_done ? ExitCode::kDone : ExitCode::kFailed;
}

/// Checks what recordings and a live kitchen have in common.
Status read_common(KitchenArguments& arguments) {
  if (arguments.is_fast) {
    const auto fast = datasets::KitchenOptions::fast();
    arguments.options.width = fast.width;
    arguments.options.height = fast.height;
    arguments.options.is_fine = fast.is_fine;
  }
  arguments.options.has_images = !arguments.has_no_images;
  if (!arguments.start.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(arguments.options.start, parse_time(arguments.start));
  }
  return {};
}

ExitCode run(KitchenArguments arguments, const std::vector<std::string>& same) {
  const auto seeds = read_seeds(arguments.seeds);
  if (!seeds.ok()) return wrong_usage(seeds.status());
  if (arguments.store.empty() == arguments.folder.empty())
    return wrong_usage(invalid_argument("needs a STORE or --folder, and not both"));
  if (arguments.is_plain && arguments.folder.empty())
    return wrong_usage(invalid_argument("--plain: needs --folder"));
  if (arguments.jobs > 1 && arguments.folder.empty())
    return wrong_usage(
        invalid_argument("--jobs {}: one process records into a store at a time; "
                         "needs --folder",
                         arguments.jobs));
  if (const Status status = arguments.options.validate(); !status.ok()) return wrong_usage(status);
  if (const auto recording = recorder_options(arguments); !recording.ok())
    return wrong_usage(recording.status());
  if (!arguments.folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(arguments.folder, error);
    if (error) return fail(unavailable("--folder '{}': {}", arguments.folder, error.message()));
  }
  if (arguments.jobs > 1 && seeds->size() > 1) return run_children_for(arguments, *seeds, same);
  return run_here(arguments, *seeds);
}

}  // namespace

void add_kitchen_command(CLI::App& simulate, ExitCode& exit_code) {
  const auto arguments = std::make_shared<KitchenArguments>();
  CLI::App* kitchen =
      simulate.add_subcommand("kitchen", "Record a humanoid that picks and places in a kitchen");
  kitchen->footer(kSimulateKitchenFooter);
  datasets::KitchenOptions& options = arguments->options;
  kitchen->add_option("store", arguments->store, "Store to record into, made if missing");
  kitchen->add_option("--folder", arguments->folder, "Folder for a store of each seed");
  kitchen->add_option("--seed", arguments->seeds, "Same seed, same recording: 3, 1..5, 1,4")
      ->capture_default_str();
  kitchen->add_option("--seconds", options.seconds, "Length of each")->capture_default_str();
  kitchen->add_option("--start", arguments->start, "Time of the first snapshot")
      ->check(time_text());
  kitchen->add_option("--width", options.width, "Pixels")->capture_default_str();
  kitchen->add_option("--height", options.height, "Pixels")->capture_default_str();
  kitchen->add_flag("--fast", arguments->is_fast,
                    "128 x 128 pixels without smooth edges and shadows, for tests");
  kitchen->add_flag("--no-images", arguments->has_no_images,
                    "All but what cameras see, in a quarter of the time of --fast");
  kitchen->add_flag("--plain", arguments->is_plain,
                    "PNG and JSON files instead of stores, with --folder: all that is recorded, "
                    "as engram export --to armarx lays it out");
  kitchen->add_flag("--depth", options.records_depth, "Depth of the left camera too");
  kitchen->add_flag("--colours", options.has_colours,
                    "Give each thing a colour by the seed, and record it");
  kitchen->add_option("--jobs", arguments->jobs, "Processes, with --folder")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  auto* preset = kitchen->add_option("--preset", arguments->preset, "recorder, balanced or small")
                     ->capture_default_str();
  kitchen->add_option("--config", arguments->config, "Recording configuration, YAML")
      ->check(CLI::ExistingFile)
      ->excludes(preset);
  kitchen
      ->add_option("--progress", arguments->progress, "On stderr: line, json (a line each) or none")
      ->transform(old_value("text", "line"))
      ->check(CLI::IsMember({"line", "json", "none"}))
      ->capture_default_str();
  add_live_options(*kitchen, arguments->live);
  kitchen->callback([arguments, kitchen, &exit_code] {
    if (const Status status = read_common(*arguments); !status.ok()) {
      exit_code = wrong_usage(status);
      return;
    }
    if (arguments->live.is_live) {
      const auto seeds = read_seeds(arguments->seeds);
      exit_code = seeds.ok()
                      ? run_live_kitchen(arguments->options, arguments->live, *seeds, *kitchen)
                      : wrong_usage(seeds.status());
      return;
    }
    if (const Status status = check_recorded(*kitchen); !status.ok()) {
      exit_code = wrong_usage(status);
      return;
    }
    exit_code = run(*arguments, arguments_of(*kitchen, {"--seed", "--jobs", "--progress"}));
  });
  add_live_kitchen_commands(simulate, exit_code);
}

}  // namespace engram::cli
