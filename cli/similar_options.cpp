// SPDX-License-Identifier: Apache-2.0
#include "cli/similar_options.h"

#include <filesystem>

#include "ltm/core/ascii.h"

namespace engram::cli {

namespace {

constexpr const char* kSimilarFooter =
    R"(LIKE is a moment, MEMORY/CORE/PROVIDER/ENTITY/TIME; an entity, for its last moment; or an image
(PNG, JPEG). Moments of the same entity are compared with it; with an image, of the entity that
--entity names, or of the only one with images. A moment is compared with what was seen or measured
up to two seconds before it (--context), so that taking something up and putting it down differ.
Images are compared by codes of 24 bytes, which are made as images are recorded and by nights
(engram consolidate); those that are missing are computed, and --keep stores them. Numbers are compared by their values and
changes. Distances: 0 for equal codes, 1 for two moments at random.

Examples:
  engram similar kitchen.engram 'Vision/RGB/head/stereo/2026-01-01 08:00:10'
  engram similar robot.engram Vision/RGB/head/cam -k 5 --picture similar.png
  engram similar robot.engram seen.png --entity Vision/RGB/head/cam
  engram similar robot.engram Vision/RGB/head/cam 'Vision @ 2026-01-01..2026-01-02' --one-per-recording
  engram similar kitchen.engram 'Vision/RGB/head/stereo/2026-01-01 08:00:10' --elsewhere \
      --with RobotState/Proprioception/robot/joints=0.5
  engram similar robot.engram RobotState/Proprioception/robot/joints --json
  engram similar --server 127.0.0.1:50051 Vision/RGB/head/cam --elsewhere
  engram similar --names 10.0.0.2:7070 seen.png --entity Vision/RGB/head/cam)";

/// "ENTITY=WEIGHT" or "ENTITY".
Result<ltm::SimilarPart> part_of(const std::string& text) {
  const size_t equals = text.rfind('=');
  ltm::SimilarPart part;
  if (equals != std::string::npos) {
    const std::string weight = text.substr(equals + 1);
    char* end = nullptr;
    part.weight = std::strtod(weight.c_str(), &end);
    if (weight.empty() || *end != '\0')
      return invalid_argument("--with '{}': needs ENTITY=WEIGHT, and '{}' is no number", text,
                              weight);
  }
  ENGRAM_ASSIGN_OR_RETURN(part.entity, ltm::MemoryId::parse(text.substr(0, equals)));
  if (!part.entity.is_entity()) return invalid_argument("--with '{}': is no entity", text);
  return part;
}

}  // namespace

bool is_image_name(const std::string& text) {
  const std::string ending = lower_ascii(std::filesystem::path(text).extension().string());
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

Status complete(SimilarArguments& arguments) {
  const bool names_server = !arguments.remote.server.empty() || !arguments.remote.names.empty();
  // Without a store: LIKE, or LIKE and QUERY where a server is named.
  if (arguments.like.empty() || (names_server && arguments.query.empty())) {
    arguments.query = std::move(arguments.like);
    arguments.like = std::move(arguments.store);
    arguments.store.clear();
  }
  if (arguments.like.empty()) return invalid_argument("like is required");
  ENGRAM_RETURN_IF_ERROR(check_source(arguments.store, arguments.remote));
  if (arguments.store.empty() && arguments.keeps_codes)
    return invalid_argument("--keep is of stores: a server codes what it records, and its nights");
  return {};
}

Result<ltm::SimilarRequest> similar_request_of(const SimilarArguments& arguments) {
  ltm::SimilarRequest request;
  request.count = arguments.count;
  ENGRAM_ASSIGN_OR_RETURN(request.apart, parse_duration(arguments.apart));
  ENGRAM_ASSIGN_OR_RETURN(request.context, parse_duration(arguments.context));
  if (request.apart < Duration::zero() || request.context < Duration::zero())
    return invalid_argument("--apart and --context must not be negative");
  request.is_one_per_recording = arguments.is_one_per_recording;
  request.is_elsewhere = arguments.is_elsewhere;
  request.takes_any_size = arguments.takes_any_size;
  for (const std::string& text : arguments.with) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::SimilarPart part, part_of(text));
    request.with.push_back(std::move(part));
  }
  if (!arguments.query.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(request.among, ltm::Query::parse(arguments.query));
  }
  if (!arguments.entity.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(request.entity, ltm::MemoryId::parse(arguments.entity));
  }
  if (is_image_name(arguments.like)) return request;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId like, ltm::MemoryId::parse(arguments.like));
  if (!like.has_entity())
    return invalid_argument("'{}': needs a moment, an entity or an image file", arguments.like);
  if (!arguments.entity.empty() && request.entity != like.entity())
    return invalid_argument(
        "--entity '{}' is for images: the moment is one of '{}', and only moments of one entity "
        "can "
        "be compared",
        arguments.entity, like.entity().to_string());
  request.entity = like.entity();
  request.moment = like.time();
  return request;
}

void add_similar_options(CLI::App& command, SimilarArguments& arguments) {
  command.footer(kSimilarFooter);
  command.add_option("store", arguments.store, "Store; none where a server is asked");
  command.add_option("like", arguments.like, "A moment, an entity, or an image file");
  command.add_option("query", arguments.query, "Only moments that this query selects");
  add_remote_options(command, arguments.remote);
  command
      .add_option("--entity", arguments.entity, "The entity whose images an image is compared with")
      ->check(entity_text());
  command.add_option("-k,--count", arguments.count, "How many moments")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--apart", arguments.apart,
                  "Leave out moments as near in time to a nearer one, or to the one asked with")
      ->check(duration_text())
      ->capture_default_str();
  command.add_flag("--one-per-recording", arguments.is_one_per_recording,
                   "The nearest moment of each recording alone");
  command.add_flag("--elsewhere", arguments.is_elsewhere, "No moments of the same recording");
  command
      .add_option("--context", arguments.context,
                  "How far back what came before is compared, too; 0s: only the moment itself")
      ->check(duration_text())
      ->capture_default_str();
  command.add_option(
      "--with", arguments.with,
      "ENTITY=WEIGHT: compare this entity, too, beside the first, whose weight is 1");
  command.add_flag("--any-size", arguments.takes_any_size,
                   "Take an image of another size than those of the entity");
  command.add_flag("--keep", arguments.keeps_codes,
                   "Store the codes of all images of the store that have none yet");
  command.add_option("--picture", arguments.picture, "Draw the moments (PNG)");
  command.add_flag("--json", arguments.is_json, "As JSON");
}

}  // namespace engram::cli
