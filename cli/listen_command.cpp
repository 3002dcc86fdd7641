// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/ask_model.h"
#include "cli/interrupt.h"
#include "cli/remote_client.h"
#include "cli/served_text.h"
#include "cli/server_commands.h"
#include "cli/speech_options.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "speech/listening/answer_skill.h"

namespace engram::cli {

namespace {

constexpr const char* kListenFooter =
    R"(Answers what a living robot is asked, until Ctrl-C: it has the skill speech/answer of the server,
which the memory starts for all words in Speech/Commands that end with a question mark. Answers are
committed to Speech/Answers, with links to the words and to what they were read from, and printed.
Rules read the questions, and with --attention a network, too.

Examples:
  engram listen
  engram listen --server unix:engram.sock --json
Then, elsewhere:
  engram commit Speech/Commands/human/text --data '{"speaker": "Ada", "text": "Where is the salt?"}'
  engram skill run speech/answer question='What did you do last?' --wait 5s
  engram query 'Speech/Answers @ latest')";

struct ListenArguments {
  RemoteArguments remote;
  RouteArguments route;
  bool is_json = false;
};

void show(const speech::Answer& answer, bool is_json) {
  if (is_json) {
    print_now(answer.to_json().dump(-1, ' ', false, Json::error_handler_t::replace));
    return;
  }
  print_now(printable(answer.question) + "\n  " + printable(answer.text));
}

ExitCode listen(const ListenArguments& arguments) {
  const auto connection = connection_of(arguments.remote);
  if (!connection.ok()) return fail(connection.status());
  auto reader = reader_of(arguments.route, {});
  if (!reader.ok()) return fail(reader.status());
  finish_after_interrupt();
  const auto skill = speech::AnswerSkill::provide(
      connection->endpoint,
      {.asker = {.zone = day_zone(), .reader = *std::move(reader)},
       .connect = connection->options,
       .on_answer = [is_json = arguments.is_json](const speech::Answer& answer) {
         show(answer, is_json);
       }});
  if (!skill.ok()) return fail(skill.status());
  log::info("listens to Speech/Commands; Ctrl-C ends it");
  wait_for_the_end();
  log::info("answered {} questions", (*skill)->answered());
  return ExitCode::kDone;
}

}  // namespace

void add_listen_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ListenArguments>();
  CLI::App* command = app.add_subcommand("listen", "Answer what a living robot is asked");
  command->footer(kListenFooter);
  command
      ->add_option("--attention", arguments->route.attention,
                   "A network of engram learn-answers, for what no rule of the grammar reads")
      ->check(CLI::ExistingFile);
  add_remote_options(*command, arguments->remote);
  command->add_flag("--json", arguments->is_json, "A line of JSON for each answer");
  command->callback([arguments, &exit_code] { exit_code = listen(*arguments); });
}

}  // namespace engram::cli
