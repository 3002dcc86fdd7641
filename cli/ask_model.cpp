// SPDX-License-Identifier: Apache-2.0
#include "cli/ask_model.h"

#include <chrono>
#include <cstdlib>

#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "ltm/core/log.h"
#include "speech/assistants/asking_tools.h"
#include "speech/assistants/chat_route.h"
#include "speech/assistants/memory_tools.h"
#include "speech/attention/attention_files.h"
#include "speech/attention/attention_reader.h"

namespace engram::cli {

namespace {

/// A token on the command line would be seen by all users of the machine.
constexpr const char* kTokenVariable = "ENGRAM_LLM_TOKEN";

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

Result<speech::Answer> ask_model(const RouteArguments& arguments, Memory& memory,
                                 const std::shared_ptr<speech::Asker>& asker,
                                 const std::string& question, Time now) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<speech::MemoryTool> tools = speech::memory_tools(memory);
  for (speech::MemoryTool& tool : speech::asking_tools(asker)) tools.push_back(std::move(tool));
  // A chat has no images.
  std::erase_if(tools, [](const speech::MemoryTool& tool) { return tool.name == "picture"; });
  const char* const token = std::getenv(kTokenVariable);
  ENGRAM_ASSIGN_OR_RETURN(
      auto route,
      speech::ChatRoute::create(
          {.url = arguments.url, .model = arguments.model, .token = token == nullptr ? "" : token},
          std::move(tools)));
  ENGRAM_ASSIGN_OR_RETURN(speech::ChatAnswer said, route.ask(question, now, interrupt_token()));
  speech::Answer answer;
  answer.question = question;
  answer.route = "llm";
  answer.looked_for = joined(said.looked_for);
  if (said.is_known) {
    answer.text = said.text;
    // It was shown what it names; whether that says so, it alone has judged.
    answer.confidence = 0.5;
    for (const ltm::MemoryId& id : said.evidence) answer.evidence.push_back({id, "shown"});
    answer.value = speech::answers::Reason{said.text, said.evidence};
  } else {
    answer.text = "I do not know.";
    answer.looked_for +=
        (answer.looked_for.empty() ? "" : "; ") +
        fmt::format("the answer of the language model is withheld: {}", said.withheld);
  }
  answer.took_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}

}  // namespace

void add_route_options(CLI::App& command, RouteArguments& arguments) {
  command
      .add_option("--route", arguments.route,
                  "Who reads the question: the rules of the grammar alone, the network of "
                  "learn-answers, a language model, or one after the other until one reads it")
      ->check(CLI::IsMember({"auto", "program", "attention", "llm"}))
      ->capture_default_str();
  command
      .add_option("--attention", arguments.attention,
                  "A network of engram learn-answers (without: the store's own, if it has one)")
      ->check(CLI::ExistingFile);
  command.add_option("--llm", arguments.url,
                     "A server of a language model, such as http://127.0.0.1:8080/v1 of llama.cpp; "
                     "its token is in ENGRAM_LLM_TOKEN");
  command.add_option("--llm-model", arguments.model, "Which of its models");
}

Status check_route(const RouteArguments& arguments) {
  if (arguments.route == "llm" && arguments.url.empty())
    return invalid_argument("--route llm needs --llm with the URL of a language model");
  if (!arguments.url.empty()) return speech::ChatRoute::Options{.url = arguments.url}.validate();
  return {};
}

Result<std::shared_ptr<speech::QuestionReader>> reader_of(const RouteArguments& arguments,
                                                          const std::string& store) {
  std::shared_ptr<speech::QuestionReader> reader;
  if (arguments.route == "program" || arguments.route == "llm") return reader;
  const std::filesystem::path own = speech::attention_file(store);
  std::error_code error;
  const bool has_own = !store.empty() && std::filesystem::exists(own, error);
  if (arguments.attention.empty() && !has_own) {
    if (arguments.route == "attention")
      return invalid_argument(
          "--route attention needs --attention with a file of engram learn-answers");
    return reader;
  }
  ENGRAM_ASSIGN_OR_RETURN(const LearningModule* module, learning_module());
  auto network = module->load_attention(
      arguments.attention.empty() ? own : std::filesystem::path(arguments.attention));
  if (network.ok()) {
    reader = speech::make_attention_reader(*std::move(network));
    return reader;
  }
  // What a store learned in another version is learned anew; until then the grammar reads.
  if (!arguments.attention.empty() || arguments.route == "attention") return network.status();
  log::warning("{}; engram consolidate --answers learns anew", network.status().message());
  return reader;
}

Result<speech::Answer> ask_by_route(const RouteArguments& arguments, Memory& memory,
                                    const std::shared_ptr<speech::Asker>& asker,
                                    const std::string& question, Time now) {
  if (arguments.route == "llm") return ask_model(arguments, memory, asker, question, now);
  const speech::AskRoute route = arguments.route == "program"     ? speech::AskRoute::kProgram
                                 : arguments.route == "attention" ? speech::AskRoute::kReader
                                                                  : speech::AskRoute::kAuto;
  ENGRAM_ASSIGN_OR_RETURN(speech::Answer answer, asker->ask(question, now, route));
  if (answer.program || arguments.route != "auto" || arguments.url.empty()) return answer;
  return ask_model(arguments, memory, asker, question, now);
}

}  // namespace engram::cli
