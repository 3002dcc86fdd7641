// SPDX-License-Identifier: Apache-2.0
#include "cli/speech_options.h"

#include <cstdlib>

namespace engram::cli {

void add_speech_options(CLI::App& command, SpeechArguments& arguments) {
  command
      .add_option("--now", arguments.now,
                  "When it is asked (without: the last moment of a store, the clock for a server)")
      ->check(time_text());
  add_remote_options(command, arguments.remote);
}

speech::DayZone day_zone() {
  // Read once, before any thread could change the environment.
  const char* zone = std::getenv("TZ");
  return zone != nullptr && *zone != '\0' ? speech::DayZone::kLocal : speech::DayZone::kUtc;
}

Result<std::unique_ptr<Memory>> open_to_ask(const SpeechArguments& arguments) {
  return open_memory(arguments.store, {.is_read_only = true, .notes_reads = false},
                     arguments.remote);
}

Result<Time> now_of(const SpeechArguments& arguments, const speech::KnownFacts& facts) {
  if (!arguments.now.empty()) return parse_time(arguments.now);
  return arguments.store.empty() ? system_now() : facts.last_moment();
}

}  // namespace engram::cli
