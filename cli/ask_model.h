// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "memory/memory.h"
#include "speech/language/asker.h"

namespace engram::cli {

/// Who reads a question.
struct RouteArguments {
  std::string route = "auto";  ///< "auto", "program", "attention" or "llm".
  std::string attention;       ///< The file of a network; empty: the store's, if it has one.
  std::string url;             ///< Of a language model; empty: there is none.
  std::string model;
};

/// Adds --route, --attention, --llm and --llm-model.
void add_route_options(CLI::App& command, RouteArguments& arguments);

/// Errors: kInvalidArgument where the route needs a language model and none is named.
[[nodiscard]] Status check_route(const RouteArguments& arguments);

/// The reader of the route of attention; null where the route needs none, or neither the options
/// name one nor the store has learned one.
/// Errors: kInvalidArgument where --route attention has none; those of load_attention for a file
/// that was named. Of the store's own they are logged.
Result<std::shared_ptr<speech::QuestionReader>> reader_of(const RouteArguments& arguments,
                                                          const std::string& store);

/// Answers a question by the route that was chosen: with `auto` as a program, and by the language
/// model where it could not be read and there is one.
/// Errors: those of Asker::ask and ChatRoute::ask.
Result<speech::Answer> ask_by_route(const RouteArguments& arguments, Memory& memory,
                                    const std::shared_ptr<speech::Asker>& asker,
                                    const std::string& question, Time now);

}  // namespace engram::cli
