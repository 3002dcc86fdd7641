// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/child_process.h"
#include "cli/command.h"
#include "cli/consolidate_jobs.h"
#include "cli/interrupt.h"
#include "cli/job_options.h"
#include "cli/lesson_text.h"
#include "cli/progress_line.h"
#include "cli/training_options.h"
#include "ltm/core/log.h"
#include "ltm/core/time.h"
#include "ltm/store/night_records.h"
#include "reports/consolidate_text.h"
#include "speech/attention/attention_files.h"
#include "speech/learning/attention_file.h"
#include "training/fit/job_pace.h"
#include "training/night/consolidate.h"
#include "training/night/drop_raw.h"

namespace engram::cli {

namespace {

constexpr const char* kConsolidateFooter = R"(Examples:
  engram consolidate robot.engram
  engram consolidate robot.engram --training 30m --entity 'Vision/.*'
  engram consolidate robot.engram --budget 1h
  engram consolidate robot.engram --psnr 40
  engram consolidate robot.engram --representation latents --psnr 35 --width 128
  engram consolidate robot.engram --drop-raw --min-psnr 30 --grace 7d
  engram consolidate robot.engram --until 06:00 --yield-file /run/robot/busy
  engram consolidate robot.engram --answers 10m
  engram consolidate robot.engram --dry-run

Tells what it is going to do, then trains one autoencoder per entity with new recorded snapshots, encodes them, decodes what is
stored and measures its error. Training starts from the entity's newest model (--anew: not), on new
and on old recorded snapshots. Each block of images is kept as latents, with residuals where they
need them, as video or without loss, whichever takes fewest bytes with every image at --psnr or
better (without it, as good as the camera's noise, 30 to 40 dB); where networks cannot save five
times what they take themselves in --nights nights, video alone is used and no network is trained
for images. Where going on with the newest model takes no more bytes than a new one, in as many
nights as the newest has served, what is new gets latents of that and the store no new model.
Numbers are kept within --number-bound, 0 keeps every bit. Recorded data stays until --drop-raw.
--budget and --until end everything in time: where it is short, networks are not trained, videos
are searched for with less effort, and the oldest snapshots come first; what is left waits for the
next job. With more time than usual, videos take fewer bytes.
Ctrl-C or a kill at any moment leaves the store as it was, or with what was published until then:
whole entities, and videos every two minutes. Run again with the same options, training goes on from
its last checkpoint (only the time that it is given may differ).
Two processes of one thread train different entities at once where that is measured to be quicker
than one with two threads (unless --threads or --steps is given); --jobs decides instead.)";

struct ConsolidateArguments {
  std::string store;
  training::ConsolidateOptions options;
  training::DropOptions drop;
  TrainingArguments learning;
  JobArguments job;
  std::string representation = "auto";
  std::string variant = "rate";
  std::string grace;
  const CLI::App* command = nullptr;
  const CLI::Option* psnr = nullptr;
  int jobs = 0;
  bool is_part = false;
  std::optional<int64_t> began_ns;  ///< Of the job whose part this is.
  std::string access = "50ms";
  std::string answers;  ///< How long it learns to answer; empty: it does not.
  bool drops_raw = false;
  bool is_dry_run = false;
  bool is_json = false;
};

Status drop_all(const ConsolidateArguments& arguments, const training::ConsolidateReport& report,
                const ProgressSink& progress, std::vector<reports::DroppedRaw>& dropped) {
  const training::JobControl& job = arguments.options.job;
  std::unique_ptr<training::RobotBusy> busy;
  if (!job.yield.file.empty() || !job.yield.command.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(busy, training::RobotBusy::create(job.yield));
  }
  const std::stop_token stop = interrupt_token();
  training::JobPace pace(busy.get(), progress, stop, job.until);
  for (const training::EntityReport& entity : report.entities) {
    training::StageTimes times;
    const auto done = [&] {
      const training::StageTimes::Scope scope(&times, training::Stage::kVerification);
      return training::drop_raw(arguments.store, entity.entity, arguments.drop, progress, stop,
                                &pace);
    }();
    if (!done.ok() && pace.is_time_over()) {
      log::warning("recorded data of {} stays: {}", entity.entity.to_string(),
                   done.status().message());
      return {};
    }
    ENGRAM_RETURN_IF_ERROR(done.status());
    dropped.push_back({entity.entity, *done, times.total()});
  }
  return {};
}

/// What is dropped belongs to the record of the same night, as far as it came.
Status drop_and_record(const ConsolidateArguments& arguments,
                       const training::ConsolidateReport& report, const ProgressSink& progress,
                       std::vector<reports::DroppedRaw>& dropped) {
  ENGRAM_ASSIGN_OR_RETURN(
      ltm::NightAccount account,
      ltm::NightAccount::open(arguments.store, ltm::NightWork::kConsolidate, report.began));
  const Status done = drop_all(arguments, report, progress, dropped);
  for (const reports::DroppedRaw& one : dropped)
    if (one.report.snapshots > 0) account.of(one.entity).dropped = one.report.snapshots;
  const bool is_told = !done.ok() || std::ranges::any_of(dropped, [](const auto& one) {
    return one.report.snapshots > 0;
  });
  if (!is_told) return {};
  if (const Status written = account.write(system_now(), done); !written.ok())
    log::warning("what was dropped is not written down: {}", written.message());
  return done;
}

Status finish_grace(const std::string& text, training::DropOptions& drop) {
  if (text.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const Duration grace, parse_duration(text));
  if (grace < Duration::zero()) return invalid_argument("--grace: found {}, needs 0 or more", text);
  drop.stays_from = system_now() - grace;
  return {};
}

ExitCode show_plan(const ConsolidateArguments& arguments) {
  const auto plan =
      training::plan_consolidation(arguments.store, arguments.options, interrupt_token());
  if (!plan.ok()) return fail(plan.status());
  if (arguments.is_json)
    print_json(reports::plan_json(*plan));
  else
    reports::print_plan(*plan);
  return ExitCode::kDone;
}

/// Decoding and comparing everything before it is dropped takes some hundredths of what encoding
/// took.
void leave_time_to_drop(training::JobControl& job) {
  constexpr int kShare = 20;
  if (job.until) *job.until -= std::max(Duration::zero(), *job.until - system_now()) / kShare;
}

/// The network of the night before, to go on from; none where it is of another version.
std::filesystem::path network_to_go_on_from(const std::filesystem::path& file) {
  const Status opened = speech::load_attention(file).status();
  if (opened.ok()) return file;
  if (opened.code() != StatusCode::kNotFound)
    log::warning("what reads questions is learned anew: {}", opened.message());
  return {};
}

/// What a robot is asked is learned from its own past. A memory of which no dialogues can be made,
/// or a night that is over, has consolidated all the same, so that is said and is no failure.
Status learn_answers(const ConsolidateArguments& arguments, Json& told) {
  if (arguments.answers.empty() || arguments.is_part) return {};
  const training::JobControl& job = arguments.options.job;
  speech::Lesson lesson;
  ENGRAM_ASSIGN_OR_RETURN(lesson.options.budget, parse_duration(arguments.answers));
  lesson.stores = {arguments.store};
  lesson.file = speech::attention_file(arguments.store);
  lesson.options.start = network_to_go_on_from(lesson.file);
  lesson.until = job.until;
  std::unique_ptr<training::RobotBusy> busy;
  if (!job.yield.file.empty() || !job.yield.command.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(busy, training::RobotBusy::create(job.yield));
  }
  ProgressLine progress(progress_form(arguments.job));
  const ProgressSink sink = progress.sink();
  const std::stop_token stop = interrupt_token();
  training::JobPace pace(busy.get(), sink, stop, job.until);
  lesson.options.pause = [&pace] { return pace.pause(); };
  const auto report = speech::learn_from(lesson, pace.progress(), stop);
  progress.finish();
  const StatusCode code = report.status().code();
  if (code == StatusCode::kNotFound || code == StatusCode::kResourceExhausted) {
    log::warning("nothing was learned of questions: {}", report.status().message());
    return {};
  }
  ENGRAM_RETURN_IF_ERROR(report.status());
  if (!arguments.is_json) print(lesson_text(*report, lesson.file));
  told["answers"] = lesson_json(*report, lesson.file);
  return {};
}

ExitCode consolidate(const ConsolidateArguments& arguments) {
  ProgressLine progress(progress_form(arguments.job));
  training::ConsolidatePlan plan;
  const auto on_plan = [&](const training::ConsolidatePlan& made) {
    plan = made;
    if (arguments.is_json || arguments.is_part) return;
    reports::print_plan(made);
    std::fflush(stdout);
  };
  training::ConsolidateOptions options = arguments.options;
  if (arguments.drops_raw) leave_time_to_drop(options.job);
  const auto report =
      training::consolidate(arguments.store, options, progress.sink(), interrupt_token(), on_plan);
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (!arguments.is_json) reports::print_report(*report);
  std::vector<reports::DroppedRaw> dropped;
  if (arguments.drops_raw) {
    const Status status = drop_and_record(arguments, *report, progress.sink(), dropped);
    progress.finish();
    if (!status.ok()) return fail(status);
  }
  if (!arguments.is_json) reports::print_dropped(dropped);
  Json told;
  if (arguments.is_json) told = reports::report_json(plan, *report, dropped);
  const Status learned = learn_answers(arguments, told);
  if (arguments.is_json) print_json(told);
  return done_or_failed(learned);
}

/// A given number of snapshots decides for itself how long decoding takes.
Status finish_access(const ConsolidateArguments& arguments, Duration& access) {
  access = Duration::zero();
  if (!arguments.command->get_option("--chain")->empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(access, parse_duration(arguments.access));
  return {};
}

/// Whether several processes may share the entities: if asked for, or if left to measurement.
bool wants_processes(const ConsolidateArguments& arguments) {
  if (arguments.jobs != 0) return arguments.jobs == 2;
  // One report tells of both, and that of several processes is theirs.
  if (arguments.is_json && !arguments.answers.empty()) return false;
  // Starting others and measuring whether they pay takes seconds of a short time.
  constexpr Duration kShort = std::chrono::minutes(1);
  if (const auto& until = arguments.options.job.until; until && *until - system_now() < kShort)
    return false;
  // With a fixed number of steps the same seed must give the same model whatever else the machine
  // does, so the choice must not depend on a measurement.
  const bool is_free = arguments.command->get_option("--threads")->empty();
  return is_free && !arguments.options.train.steps && !arguments.options.reuses_models;
}

/// The arguments of the processes of a job, which end at the same moment.
std::vector<std::string> arguments_of_parts(const ConsolidateArguments& arguments) {
  auto texts = arguments_of(*arguments.command, {"--entity", "--threads", "--jobs", "--progress",
                                                 "--answers", "--json", "--budget", "--until"});
  if (const auto& until = arguments.options.job.until)
    texts.push_back("--until=" + to_string(*until) + "Z");
  texts.push_back(fmt::format("{}={}", kBeganOption, to_ns(system_now())));
  return texts;
}

ExitCode run(ConsolidateArguments& arguments) {
  training::ConsolidateOptions& options = arguments.options;
  for (const Status& status :
       {finish_training_options(arguments.learning, options.train),
        finish_job_options(arguments.job, options.job),
        finish_grace(arguments.grace, arguments.drop), finish_access(arguments, options.access)})
    if (!status.ok()) return wrong_usage(status);
  const auto representation = training::representation_of(arguments.representation);
  if (!representation.ok()) return wrong_usage(representation.status());
  options.representation.kind = *representation;
  options.representation.bound_db = arguments.psnr->empty() ? 0 : options.train.psnr_db;
  if (const Status status = options.validate(); !status.ok()) return wrong_usage(status);
  if (arguments.is_part) end_with_parent();
  if (arguments.began_ns) options.job.began = time_from_ns(*arguments.began_ns);
  if (arguments.is_dry_run) return show_plan(arguments);
  if (wants_processes(arguments)) {
    const auto plan = training::plan_consolidation(arguments.store, options, interrupt_token());
    if (!plan.ok()) return fail(plan.status());
    const auto groups = arguments.jobs == 2 ? split_jobs(*plan) : split_by_measurement(*plan);
    if (!groups.empty()) {
      const ExitCode done = run_jobs(*plan, groups, arguments_of_parts(arguments),
                                     progress_form(arguments.job), arguments.is_json);
      Json told;
      return done == ExitCode::kDone ? done_or_failed(learn_answers(arguments, told)) : done;
    }
  }
  return consolidate(arguments);
}

}  // namespace

void add_consolidate_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ConsolidateArguments>();
  training::ConsolidateOptions& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("consolidate", "Train an autoencoder per entity and store latents");
  command->footer(kConsolidateFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", options.entities, "Names or patterns of entities; else all");
  add_training_options(*command, arguments->learning, options.train, options.augmented,
                       "--training", "all entities together",
                       "Min PSNR of every image, dB, else that of the camera's noise; with "
                       "latents alone the mean to aim at");
  arguments->psnr = command->get_option("--psnr");
  add_job_options(*command, arguments->job, options.job);
  arguments->command = command;
  command
      ->add_option("--jobs", arguments->jobs,
                   "Processes: 1, 2 with a thread each, or 0: whichever is quicker, measured")
      ->check(CLI::Range(0, 2))
      ->capture_default_str();
  command->add_flag(kPartOption, arguments->is_part)->group("");
  command->add_option(kBeganOption, arguments->began_ns)->group("");
  command
      ->add_option(
          "--representation", arguments->representation,
          "How images are kept: auto, latents, video, or corrected: latents, and residuals "
          "where they miss the bound")
      ->check(CLI::IsMember({"auto", "latents", "video", "corrected"}))
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
      ->add_option("--video-effort", options.representation.video_effort,
                   "Effort of the video codec, 0 to 9: more takes fewer bytes and more time")
      ->default_str("by size");
  command
      ->add_option("--video-tolerance", options.representation.video_tolerance_db,
                   "A video may be better than the bound by this much, in dB; 0: the smallest one, "
                   "which takes two or three times as long")
      ->capture_default_str();
  command
      ->add_option("--nights", options.representation.nights,
                   "Nights like this one that share the bytes of a model")
      ->default_str("30, and for a model that replaces another as many as that one served");
  command
      ->add_option(
          "--refine", options.representation.refine_steps,
          "Steps that search better latents for each block: smaller and better, but slow; 0: "
          "some, only where the bound is missed by little")
      ->capture_default_str();
  command->add_option(
      "--number-bound", options.train.number_bound,
      "Largest error of numbers, of orientations in rad; 0 keeps every bit. Default: "
      "0.005 standard deviations of each, 0.001 rad");
  CLI::Option* access =
      command
          ->add_option("--access", arguments->access,
                       "The image of any moment is decoded within about this time: with more, more "
                       "snapshots are coded from one another, which takes fewer bytes")
          ->check(duration_text())
          ->capture_default_str();
  command
      ->add_option("--chain", options.train.chain_rows,
                   "Number of snapshots that are coded from one another instead")
      ->excludes(access);
  command
      ->add_option("--hold-out", options.train.hold_out_recordings,
                   "Number of last recordings that take no part in training")
      ->capture_default_str();
  command
      ->add_option("--min-snapshots", options.min_snapshots,
                   "Entities with fewer recorded snapshots are skipped")
      ->capture_default_str();
  command->add_flag("--force", options.force, "Train even where nothing is new");
  command->add_flag("--anew", options.starts_anew,
                    "Train from nothing instead of from the newest model of each entity");
  command->add_flag("--reuse-models", options.reuses_models,
                    "Encode what is new with the newest model of each entity instead of training");
  CLI::Option* drop =
      command->add_flag("--drop-raw", arguments->drops_raw,
                        "Drop recorded data whose latents were decoded and compared");
  command
      ->add_option("--min-psnr", arguments->drop.min_psnr_db,
                   "Images with a lower PSNR stay recorded, dB")
      ->needs(drop);
  command
      ->add_option("--max-rmse", arguments->drop.max_rmse,
                   "Numbers with a larger RMSE stay recorded")
      ->needs(drop);
  command->add_option("--grace", arguments->grace, "Data that is younger stays recorded, like 7d")
      ->check(duration_text())
      ->needs(drop);
  command
      ->add_option("--answers", arguments->answers,
                   "Afterwards learn to read questions for so long, like 10m, from dialogues that "
                   "are made of this memory (engram ask, docs/verbalisation.md)")
      ->check(duration_text());
  command->add_flag("--dry-run", arguments->is_dry_run,
                    "Only tell what would be done, and what it would gain");
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
