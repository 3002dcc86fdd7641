// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "memory/memory.h"
#include "speech/attention/attention_files.h"
#include "speech/learning/learn_to_answer.h"

namespace engram::cli {

namespace {

constexpr const char* kLearnAnswersFooter =
    R"(Learns to read questions that no rule of the grammar reads, as an offline job of an hour. Questions
with true answers are made from what the stores tell (docs/dialogues.md), in thousands of wordings; a
network learns which episodes of a memory each is about, and what of them is asked for. What it reads
is executed as any program, so it invents nothing, and what it is not sure of is not told.
The network knows no names. One that was trained on some kitchens serves other memories, too.

Examples:
  engram learn-answers kitchen.engram --budget 10m
  engram learn-answers kitchens/*.engram --output answers.attention
  engram ask other.engram 'Any luck with the salt?' --attention answers.attention)";

struct LearnAnswersArguments {
  std::vector<std::string> stores;
  std::string output;
  std::string budget = "60m";
  speech::LearnOptions options;
  speech::ExampleOptions examples{.dialogues = {.count = 1500, .careless = 0.15}};
  bool is_json = false;
};

Result<speech::LearnReport> learn(const LearnAnswersArguments& arguments,
                                  speech::ExampleCounts& counts, const ProgressSink& progress) {
  std::vector<speech::AttentionExample> examples;
  speech::ExampleOptions options = arguments.examples;
  for (size_t i = 0; i < arguments.stores.size(); ++i) {
    progress({.what = "make dialogues",
              .done = i,
              .total = arguments.stores.size(),
              .detail = fmt::format("{} examples", examples.size())});
    ENGRAM_ASSIGN_OR_RETURN(
        const auto memory,
        Memory::open(arguments.stores[i], {.is_read_only = true, .notes_reads = false}));
    ENGRAM_ASSIGN_OR_RETURN(const speech::ExampleCounts made,
                            speech::add_examples(*memory, options, interrupt_token(), examples));
    counts += made;
    options.dialogues.seed += 100;
  }
  return speech::learn_to_answer(std::move(examples), arguments.options, arguments.output, progress,
                                 interrupt_token());
}

Json to_json(const speech::ExampleCounts& counts, const speech::LearnReport& report,
             const std::string& file) {
  return {{"file", file},
          {"dialogues", counts.dialogues},
          {"with_program", counts.programs},
          {"refusals", counts.refusals},
          {"unread", counts.unread},
          {"unlike", counts.unlike},
          {"examples", report.examples},
          {"held_out", report.held_out},
          {"parameters", report.parameters},
          {"steps", report.steps},
          {"seconds", report.seconds},
          {"loss", report.loss},
          {"read_rightly", report.read_rightly},
          {"min_confidence", report.min_confidence},
          {"told", report.told},
          {"told_rightly", report.told_rightly}};
}

void print_report(const speech::ExampleCounts& counts, const speech::LearnReport& report,
                  const std::string& file) {
  print(fmt::format(
      "{} dialogues: {} with a program, {} that cannot be answered; left out: {} that the grammar "
      "does not answer rightly in plain words, {} that the network's language has not got",
      counts.dialogues, counts.programs, counts.refusals, counts.unread, counts.unlike));
  print(fmt::format(
      "trained {:.0f} s: {} steps with {} examples, {:.2f} million parameters, loss {:.3f}",
      report.seconds, report.steps, report.examples, static_cast<double>(report.parameters) / 1e6,
      report.loss));
  print(
      fmt::format("of {} held-out questions {:.1f} % are read rightly; from a confidence of {:.3f} "
                  "on, {:.1f} % "
                  "are told, of which {:.1f} % rightly",
                  report.held_out, 100 * report.read_rightly, report.min_confidence,
                  100 * report.told, 100 * report.told_rightly));
  print(fmt::format("wrote {}", file));
}

ExitCode run(LearnAnswersArguments arguments) {
  const auto budget = parse_duration(arguments.budget);
  if (!budget.ok()) return wrong_usage(budget.status());
  arguments.options.budget = *budget;
  if (arguments.output.empty() && arguments.stores.size() > 1)
    return wrong_usage(invalid_argument("several stores need --output"));
  if (arguments.output.empty())
    arguments.output = speech::attention_file(arguments.stores.front()).string();
  if (const Status options = arguments.options.validate(); !options.ok())
    return wrong_usage(options);
  speech::ExampleCounts counts;
  ProgressLine progress;
  const auto report = learn(arguments, counts, progress.sink());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(to_json(counts, *report, arguments.output));
  else
    print_report(counts, *report, arguments.output);
  return ExitCode::kDone;
}

}  // namespace

void add_learn_answers_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<LearnAnswersArguments>();
  CLI::App* command =
      app.add_subcommand("learn-answers", "Learn to read questions that no rule reads");
  command->footer(kLearnAnswersFooter);
  command->add_option("stores", arguments->stores, "Stores with recordings of kitchens")
      ->required();
  command->add_option("-o,--output", arguments->output,
                      "The file to write; else within the store, where engram ask finds it");
  command->add_option("--budget", arguments->budget, "How long it trains, once dialogues are made")
      ->check(duration_text())
      ->capture_default_str();
  command
      ->add_option("--dialogues", arguments->examples.dialogues.count,
                   "Questions in the generator's own wordings about each store")
      ->capture_default_str();
  command->add_option("--wordings", arguments->examples.wordings,
                      "More files of wordings, each of which is asked once of each store");
  command->add_option("--threads", arguments->options.threads, "Threads that compute")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--batch", arguments->options.batch, "Questions of a step")
      ->capture_default_str();
  command->add_option("--rate", arguments->options.learning_rate, "Learning rate")
      ->capture_default_str();
  command
      ->add_option("--min-right", arguments->options.min_right,
                   "So much of what is told is right on held-out wordings, 0 to 1")
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Of weights and of the order of examples")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
