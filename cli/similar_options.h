// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/remote.h"
#include "ltm/likeness/similar_moments.h"

namespace engram::cli {

/// The options of `engram similar`, unparsed.
struct SimilarArguments {
  std::string store;  ///< Empty: a server is asked.
  std::string like;
  std::string query;
  RemoteArguments remote;
  std::string entity;
  size_t count = 10;
  std::string apart = "1s";
  std::string context = "2s";
  std::vector<std::string> with;
  bool is_one_per_recording = false;
  bool is_elsewhere = false;
  bool takes_any_size = false;
  bool keeps_codes = false;
  std::string picture;
  bool is_json = false;
};

/// Adds all of them. `arguments` must outlive the command.
void add_similar_options(CLI::App& command, SimilarArguments& arguments);

/// Sorts out which positional argument is what: with a server there is no store before the others.
/// Errors: kInvalidArgument.
Status complete(SimilarArguments& arguments);

/// Whether a text names an image file, PNG or JPEG.
[[nodiscard]] bool is_image_name(const std::string& text);

/// The request, as far as the arguments tell: without the moment if an entity was named, and
/// without the image if a file was.
/// Errors: kInvalidArgument.
Result<ltm::SimilarRequest> similar_request_of(const SimilarArguments& arguments);

}  // namespace engram::cli
