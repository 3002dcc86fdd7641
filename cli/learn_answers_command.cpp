// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/lesson_text.h"
#include "cli/progress_line.h"
#include "speech/attention/attention_files.h"
#include "speech/learning/learn_to_answer.h"

namespace engram::cli {

namespace {

constexpr const char* kLearnAnswersFooter =
    R"(Learns to read questions as people ask them, as an offline job of an hour. Questions
with true answers are made from what the stores tell (docs/dialogues.md), in thousands of wordings; a
network learns which episodes of a memory each is about, and what of them is asked for. What it reads
is executed as any program, so it invents nothing, and what it is not sure of is not told.
The network knows no names. One that was trained on some kitchens serves other memories, too.
Where it is cut off by Ctrl-C or a kill, the same command goes on with what was learned a minute
before at most.

Examples:
  engram learn-answers kitchen.engram --budget 10m
  engram learn-answers kitchens/*.engram --out answers.attention
  engram ask other.engram 'Any luck with the salt?' --attention answers.attention)";

struct LearnAnswersArguments {
  speech::Lesson lesson;
  std::string budget = "60m";
  bool is_json = false;
};

ExitCode run(LearnAnswersArguments arguments) {
  speech::Lesson& lesson = arguments.lesson;
  const auto budget = parse_duration(arguments.budget);
  if (!budget.ok()) return wrong_usage(budget.status());
  lesson.options.budget = *budget;
  if (lesson.file.empty() && lesson.stores.size() > 1)
    return wrong_usage(invalid_argument("several stores need --out"));
  if (lesson.file.empty()) lesson.file = speech::attention_file(lesson.stores.front());
  if (const Status options = lesson.options.validate(); !options.ok()) return wrong_usage(options);
  ProgressLine progress;
  const auto report = speech::learn_from(lesson, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(lesson_json(*report, lesson.file));
  else
    print(lesson_text(*report, lesson.file));
  return ExitCode::kDone;
}

}  // namespace

void add_learn_answers_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<LearnAnswersArguments>();
  CLI::App* command =
      app.add_subcommand("learn-answers", "Learn to read questions that no rule reads");
  command->footer(kLearnAnswersFooter);
  command->add_option("stores", arguments->lesson.stores, "Stores with recordings of kitchens")
      ->required();
  command->add_option("-o,--out", arguments->lesson.file,
                      "The file to write; else within the store, where engram ask finds it");
  command
      ->add_option("--from", arguments->lesson.options.start,
                   "A network to go on from; without, it starts anew")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--budget", arguments->budget,
                   "How long it trains, once dialogues are made; 0s with --from: only its limits "
                   "are measured anew")
      ->check(duration_text())
      ->capture_default_str();
  command
      ->add_option("--dialogues", arguments->lesson.examples.dialogues.count,
                   "Questions in the generator's own wordings about each store")
      ->capture_default_str();
  command->add_flag("--own-words{false}", arguments->lesson.examples.has_written,
                    "Without the wordings of people that come with Engram: a quick try");
  command->add_option("--wordings", arguments->lesson.examples.wordings,
                      "More files of wordings, each of which is asked once of each store");
  command->add_option("--threads", arguments->lesson.options.threads, "Threads that compute")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--batch", arguments->lesson.options.batch, "Questions of a step")
      ->capture_default_str();
  command->add_option("--rate", arguments->lesson.options.learning_rate, "Learning rate")
      ->capture_default_str();
  command
      ->add_option("--min-right", arguments->lesson.options.min_right,
                   "Min share of what is told that is right, measured on held-out questions")
      ->capture_default_str();
  command
      ->add_option("--min-refused", arguments->lesson.options.min_refused,
                   "Min share of what cannot be answered that is refused, measured on the same")
      ->capture_default_str();
  command
      ->add_option("--seed", arguments->lesson.options.seed,
                   "Of weights and of the order of examples")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
