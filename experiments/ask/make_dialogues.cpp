// SPDX-License-Identifier: Apache-2.0
// Writes questions about recordings of kitchens with their true answers, one line of JSON each.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "ltm/core/log.h"
#include "speech/dialogues/make_dialogues.h"

namespace engram::speech {
namespace {

constexpr const char* kFooter = R"(Examples:
  engram_make_dialogues kitchen-1.engram kitchen-2.engram --count 100 > dialogues.jsonl
  engram_make_dialogues kitchen-1.engram --split train --careless 0.2
  engram_make_dialogues kitchen-1.engram --phrasings others.jsonl --count 1000

Each store may have several recordings. docs/dialogues.md says what the lines mean.)";

struct Arguments {
  std::vector<std::string> stores;
  DialogueOptions options;
  std::string now;
  std::string phrasings;
  bool is_written = false;
};

Result<std::vector<Dialogue>> dialogues_of(const std::string& store, const Arguments& arguments) {
  DialogueOptions options = arguments.options;
  if (!arguments.now.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.now, parse_time(arguments.now));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto memory,
                          Memory::open(store, {.is_read_only = true, .notes_reads = false}));
  if (arguments.is_written) return make_written_dialogues(*memory, options);
  return arguments.phrasings.empty() ? make_dialogues(*memory, options)
                                     : make_dialogues_with(*memory, options, arguments.phrasings);
}

int run(int argc, char** argv) {
  Arguments arguments;
  DialogueOptions& options = arguments.options;
  CLI::App app("Makes questions about recordings of kitchens, with their true answers");
  app.footer(kFooter);
  app.add_option("stores", arguments.stores, "Stores of engram simulate kitchen")->required();
  app.add_option("--count", options.count,
                 "Questions about each store at most; else 50, or each phrasing of --phrasings");
  app.add_option("--seed", options.seed, "Chooses the questions; each store has the next one")
      ->capture_default_str();
  app.add_option("--split", options.split,
                 "train: nothing that is held out; held-out: only what is; all")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, DialogueSplit>{{"all", DialogueSplit::kAll},
                                               {"train", DialogueSplit::kTrain},
                                               {"held-out", DialogueSplit::kHeldOut}}));
  app.add_option("--now", arguments.now, "When they are asked; else when the recording ends");
  app.add_option("--careless", options.careless,
                 "Share of questions in small letters or with two letters swapped")
      ->capture_default_str();
  CLI::Option* phrasings = app.add_option("--phrasings", arguments.phrasings,
                                          "Questions in the words of others, JSON lines")
                               ->check(CLI::ExistingFile);
  app.add_flag("--written", arguments.is_written, "In the wordings that come with Engram")
      ->excludes(phrasings);
  CLI11_PARSE(app, argc, argv);
  log::set_level(log::Level::kWarning);
  for (const std::string& store : arguments.stores) {
    const auto made = dialogues_of(store, arguments);
    if (!made.ok()) {
      std::cerr << "engram_make_dialogues: " << store << ": " << made.status().to_string() << "\n";
      return 1;
    }
    for (const Dialogue& dialogue : *made) std::cout << to_json_line(dialogue) << "\n";
    ++options.seed;
  }
  return std::cout.flush().good() ? 0 : 1;
}

}  // namespace
}  // namespace engram::speech

int main(int argc, char** argv) {
  return engram::speech::run(argc, argv);
}
