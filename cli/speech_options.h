// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/remote.h"
#include "speech/facts/known_facts.h"
#include "speech/program/period.h"

namespace engram::cli {

/// Which memory is asked, and when it is asked.
struct SpeechArguments {
  std::string store;
  RemoteArguments remote;
  std::string now;  ///< Empty: the last moment of a store, or the clock for a server.
};

/// Adds --now, --server and what goes with it.
void add_speech_options(CLI::App& command, SpeechArguments& arguments);

/// The clock of the environment where TZ is set, else UTC.
[[nodiscard]] speech::DayZone day_zone();

/// Opens the memory for reading. What is read is not noted: an index is read, and not what was
/// asked for.
Result<std::unique_ptr<Memory>> open_to_ask(const SpeechArguments& arguments);

/// Errors: kInvalidArgument where --now is no time.
Result<Time> now_of(const SpeechArguments& arguments, const speech::KnownFacts& facts);

}  // namespace engram::cli
