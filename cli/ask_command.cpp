// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iostream>

#include "cli/ask_model.h"
#include "cli/command.h"
#include "cli/speech_options.h"
#include "ltm/core/printable.h"
#include "speech/language/asker.h"

namespace engram::cli {

namespace {

constexpr const char* kAskFooter =
    R"(A question in English about what the robot did, saw, held and was told: what, when, where, who,
why, how long, how far, how often, what went wrong, and what it would have done. It becomes a
program, which is executed; the answer is what was found, with the snapshots that it was read from.
Where the memory has nothing, the answer is "I do not know", with what was looked for.
Words of objects, places and persons come from the memory. Days and clock times are UTC, or those of
TZ where that is set.

--program takes a program in place of a question (docs/verbalisation.md):
  executions skill=pick thing=salt outcome=failure during=yesterday | last | why

--questions reads a file with one JSON object a line, {"question": "...", "now": TIME}, where "now"
may be missing, and answers each with one line of JSON, in order; '-' is standard input.

--llm names a language model of your own, which is asked where the question fits no program, or always
with --route llm. It has the tools of engram mcp, and what it says is told only with snapshots that
the memory showed it (docs/assistants.md).

Examples:
  engram ask kitchen.engram 'Where have you seen the salt?'
  engram ask kitchen.engram 'Why did you move to the table?' --json
  engram ask kitchen.engram 'What did you do yesterday?' --now '2026-01-02 09:00'
  engram ask kitchen.engram --program 'executions outcome=failure | count'
  engram ask kitchen.engram 'Was it a good day?' --llm http://127.0.0.1:8080/v1
  engram ask --server unix:engram.sock 'What are you holding?')";

struct AskArguments {
  SpeechArguments memory;
  std::string question;
  std::string questions;
  RouteArguments route;
  bool is_program = false;
  bool is_json = false;
};

/// The memory that is asked, and who answers.
struct Asked {
  std::unique_ptr<Memory> memory;
  std::shared_ptr<speech::Asker> asker;
};

Result<speech::Answer> answer_to(const AskArguments& arguments, const Asked& asked,
                                 const std::string& question, Time now) {
  if (!arguments.is_program)
    return ask_by_route(arguments.route, *asked.memory, asked.asker, question, now);
  ENGRAM_ASSIGN_OR_RETURN(const speech::Program program, speech::Program::parse(question));
  return asked.asker->ask_program(program, now);
}

std::string answer_text(const speech::Answer& answer) {
  std::string text = answer.text;
  for (const speech::Evidence& evidence : answer.evidence)
    text += fmt::format("\n  {:<10} {}", evidence.role, evidence.id.printable());
  return text;
}

/// The question of a line, and when it is asked.
struct QuestionLine {
  std::string question;
  std::string now;
};

Result<QuestionLine> question_line(const std::string& line, size_t number) {
  const Json json = Json::parse(line, nullptr, false);
  const auto wrong = [number](const char* needed) {
    return invalid_argument("questions: line {} needs {}", number, needed);
  };
  if (!json.is_object()) return wrong("a JSON object");
  const auto question = json.find("question");
  if (question == json.end() || !question->is_string()) return wrong("a member 'question', a text");
  QuestionLine read{question->get<std::string>(), {}};
  const auto now = json.find("now");
  if (now == json.end() || now->is_null()) return read;
  if (!now->is_string() || !parse_time(now->get<std::string>()).ok())
    return wrong("a member 'now' that is a time");
  read.now = now->get<std::string>();
  return read;
}

Status answer_lines(const AskArguments& arguments, const Asked& asked_of, Time now,
                    std::istream& lines) {
  std::string line;
  for (size_t number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ENGRAM_ASSIGN_OR_RETURN(const QuestionLine asked, question_line(line, number));
    const Time when = asked.now.empty() ? now : *parse_time(asked.now);
    ENGRAM_ASSIGN_OR_RETURN(const speech::Answer answer,
                            answer_to(arguments, asked_of, asked.question, when));
    // One line each, as it came, whatever the options.
    std::cout << answer.to_json().dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  }
  std::cout.flush();
  return {};
}

Status ask(const AskArguments& arguments) {
  Asked asked;
  ENGRAM_ASSIGN_OR_RETURN(asked.memory, open_to_ask(arguments.memory));
  ENGRAM_ASSIGN_OR_RETURN(auto reader, reader_of(arguments.route, arguments.memory.store));
  ENGRAM_ASSIGN_OR_RETURN(
      asked.asker,
      speech::Asker::create(*asked.memory, {.zone = day_zone(), .reader = std::move(reader)}));
  ENGRAM_ASSIGN_OR_RETURN(const Time now, now_of(arguments.memory, asked.asker->facts()));
  if (arguments.questions == "-") return answer_lines(arguments, asked, now, std::cin);
  if (!arguments.questions.empty()) {
    std::ifstream file(arguments.questions);
    if (!file) return not_found("questions '{}': cannot be read", arguments.questions);
    return answer_lines(arguments, asked, now, file);
  }
  ENGRAM_ASSIGN_OR_RETURN(const speech::Answer answer,
                          answer_to(arguments, asked, arguments.question, now));
  if (arguments.is_json)
    print_json(answer.to_json());
  else
    print(answer_text(answer));
  return {};
}

ExitCode run(AskArguments arguments) {
  // A single argument is a question to a server.
  if (arguments.question.empty() && arguments.questions.empty())
    std::swap(arguments.memory.store, arguments.question);
  if (arguments.question.empty() == arguments.questions.empty())
    return wrong_usage(invalid_argument("needs a question, or a file of them (--questions)"));
  if (const Status named = check_source(arguments.memory.store, arguments.memory.remote);
      !named.ok())
    return wrong_usage(named);
  if (const Status route = check_route(arguments.route); !route.ok()) return wrong_usage(route);
  if (arguments.is_program && arguments.questions.empty())
    if (const auto program = speech::Program::parse(arguments.question); !program.ok())
      return wrong_usage(program.status());
  return done_or_failed(ask(arguments));
}

}  // namespace

void add_ask_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<AskArguments>();
  CLI::App* command = app.add_subcommand("ask", "Ask in English what the robot did and why");
  command->footer(kAskFooter);
  command->add_option("store", arguments->memory.store, "Store; none where a server is asked");
  command->add_option("question", arguments->question, "A question in English");
  command->add_option("--questions", arguments->questions,
                      "A file of questions, one JSON object a line; '-': standard input");
  command->add_flag("--program", arguments->is_program, "The question is a program");
  add_route_options(*command, arguments->route);
  add_speech_options(*command, arguments->memory);
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
