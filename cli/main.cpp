// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "cli/command.h"
#include "cli/help_texts.h"
#include "cli/interrupt.h"
#include "cli/learning_environment.h"
#include "cli/learning_module.h"
#include "cli/vault_command.h"
#include "ltm/core/log.h"

namespace engram::cli {

namespace {

constexpr const char* kMainFooter = R"(Examples:
  engram simulate scene --video scene.mp4 --table scene.csv
  engram import --video scene.mp4 --table scene.csv --entity Vision/RGB/head/cam \
      --state-entity RobotState/Proprioception/robot/joints --rate 5 robot.engram
  engram info robot.engram
  engram consolidate robot.engram --training 2m
  engram augment robot.engram --out changed.engram
  engram view robot.engram --open
  engram query robot.engram 'Vision/RGB/head/cam @ latest:3' --save answers
  engram query robot.engram 'Vision/RGB/head/cam @ +200ms'
  engram ask kitchen.engram 'Where have you seen the salt?'
  engram tell kitchen.engram --since yesterday
  engram ls robot.engram Vision/RGB/head/cam
  engram export robot.engram 'Vision @ all' --to mp4 -o videos
  engram models robot.engram
  engram eval robot.engram
  engram predict robot.engram Vision/RGB/head/cam --compare --picture predict.png
  engram crossval robot.engram --entity Vision/RGB/head/cam --training 5m
  engram forget robot.engram --config robot.yaml --dry-run
  engram export robot.engram --to vault -o robot.vault --keys robot.keys
  engram vault forget robot.vault --keys robot.keys 'Vision @ 2022-02-18'
  engram compact robot.engram
  engram idf generate kitchen.xml --cpp generated
  engram check robot.engram
  engram serve robot.engram
  engram commit Objects/Things/kitchen/cup --data '{"height": 0.11}'
  engram watch Vision Objects

Results go to stdout, messages and progress to stderr.
Exit codes: 0 done, 1 failed, 2 wrong usage or configuration, 3 done but with data loss, 130 ended
by Ctrl-C, 143 by SIGTERM (serve, mns, view and watch: 0).)";

/// Writes the options that exclude or need each other in the order of their names: CLI11 keeps them
/// by their addresses, so help texts would differ from run to run.
class OrderedHelp final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    if (!option->get_option_text().empty()) return text;
    const auto ordered = [&text](const std::string& label, const std::set<CLI::Option*>& others) {
      std::set<std::string> names;
      for (const CLI::Option* other : others) names.insert(other->get_name());
      return names.empty() ? "" : fmt::format(" {}: {}", label, fmt::join(names, " "));
    };
    const std::string needs = ordered(get_label("Needs"), option->get_needs());
    const std::string excludes = ordered(get_label("Excludes"), option->get_excludes());
    // They are the end of the text, as long in any order.
    text.resize(text.size() - needs.size() - excludes.size());
    return text + needs + excludes;
  }
};

/// The parser of the program.
struct Program {
  CLI::App app{"Engram: a deep episodic memory for robots"};
  ExitCode exit_code = ExitCode::kDone;
  bool is_quiet = false;

  /// Without `learning` the commands that learn are missing.
  explicit Program(const LearningModule* learning) {
    app.formatter(std::make_shared<OrderedHelp>());  // Commands that are added take it, too.
    app.name("engram");
    app.footer(kMainFooter);
    app.require_subcommand(1);
    app.set_version_flag("--version", "engram " ENGRAM_VERSION);
    app.add_flag("-q,--quiet", is_quiet, "Only errors on stderr")->each([](const std::string&) {
      log::set_level(log::Level::kError);
    });
    add_commands(learning);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Adds all commands in the order in which --help lists them.
  void add_commands(const LearningModule* learning) {
    add_import_command(app, exit_code);
    add_info_command(app, exit_code);
    add_augment_command(app, exit_code);
    if (learning != nullptr) learning->add_consolidate_command(app, exit_code);
    add_models_command(app, exit_code);
    if (learning != nullptr) learning->add_crossval_command(app, exit_code);
    add_ls_command(app, exit_code);
    add_view_command(app, exit_code);
    add_query_command(app, exit_code);
    add_ask_command(app, exit_code);
    add_tell_command(app, exit_code);
    add_notice_command(app, exit_code);
    if (learning != nullptr) learning->add_notice_sights_command(app, exit_code);
    if (learning != nullptr) learning->add_learn_answers_command(app, exit_code);
    if (learning != nullptr) learning->add_learn_sights_command(app, exit_code);
    add_similar_command(app, exit_code);
    add_why_salient_command(app, exit_code);
    add_reflect_command(app, exit_code);
    add_export_command(app, exit_code);
    if (learning != nullptr) learning->add_eval_command(app, exit_code);
    add_predict_command(app, exit_code);
    add_forget_command(app, exit_code);
    add_redact_command(app, exit_code);
    add_vault_command(app, exit_code);
    add_compact_command(app, exit_code);
    add_simulate_command(app, exit_code);
    add_idf_command(app, exit_code);
    add_map_command(app, exit_code);
    add_server_commands(app, exit_code);
    add_mcp_command(app, exit_code);
    add_check_command(app, exit_code);
    add_recover_command(app, exit_code);
  }

  /// Whether the first word that is no option is a command here: global options take no values.
  [[nodiscard]] bool has_command(std::span<char*> words) const {
    const auto name = std::ranges::find_if(
        words, [](const char* word) { return !std::string_view(word).starts_with('-'); });
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    return name != words.end() &&
           std::ranges::find(commands, *name, &CLI::App::get_name) != commands.end();
  }
};

/// What stays where a command is cut off; the others change nothing.
constexpr std::array<std::pair<std::string_view, const char*>, 18> kInterruptNotes{{
    {"augment", "what was stored of the new store is whole"},
    {"commit", "what was acknowledged is stored"},
    {"compact", "each step is whole or was not begun; the same command goes on"},
    {"consolidate", "what was published stays; the same command goes on from the last checkpoint"},
    {"crossval", "no result was finished"},
    {"export", "what it began to write is not whole; an export to a vault goes on"},
    {"forget", "each step is whole or was not begun; the same command goes on"},
    {"import", "what was acknowledged is in the store"},
    {"learn-answers", "what was learned before is as it was; the same command goes on"},
    {"learn-sights", "the file is as it was"},
    {"map", "a file or a map is whole, or not there"},
    {"notice", "nothing is recorded, or all of it"},
    {"notice-sights", "what was recorded stays, and is not recorded again"},
    {"recover", "the copy is unfinished; the source is as it was"},
    {"redact", "each snapshot is in its old or its new form; the same command goes on"},
    {"reflect", "nothing is recorded, or all of it"},
    {"simulate", "what was acknowledged is in the store"},
    {"vault", "a key is destroyed or as before; the same command goes on"},
}};

void note_what_stays(std::span<char*> words) {
  for (const std::string_view word : words.subspan(std::min<size_t>(1, words.size()))) {
    if (word.starts_with('-')) continue;
    const auto note =
        std::ranges::find(kInterruptNotes, word, &std::pair<std::string_view, const char*>::first);
    if (note != kInterruptNotes.end()) set_interrupt_note(note->second);
    return;
  }
}

ExitCode run(int argc, char** argv) {
  const std::span<char*> all(argv, static_cast<size_t>(argc));
  note_what_stays(all);
  if (Program program(nullptr); program.has_command(all.subspan(std::min<size_t>(1, all.size()))))
    return run_command(program.app, argc, argv, program.exit_code);
  const auto learning = learning_module();
  if (!learning.ok()) return fail(learning.status());
  Program program(*learning);
  // Called by the build, for the launcher.
  if (argc == 3 && std::string_view(argv[1]) == "--write-help-texts")
    return done_or_failed(write_help_texts(program.app, argv[2]));
  return run_command(program.app, argc, argv, program.exit_code);
}

}  // namespace

}  // namespace engram::cli

int main(int argc, char** argv) {
  engram::cli::prepare_to_learn(argc, argv);
  engram::cli::watch_for_interrupts();
  return engram::cli::end_interrupted_or(
      engram::cli::exit_code_of([&] { return engram::cli::run(argc, argv); }));
}
