// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/codec/image_file.h"
#include "ltm/core/file.h"
#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/seen_image.h"
#include "memory/model_loader.h"
#include "reports/plain/similar_text.h"
#include "reports/similar_picture.h"

namespace engram::cli {

namespace {

constexpr const char* kSimilarFooter =
    R"(LIKE is a moment, MEMORY/CORE/PROVIDER/ENTITY/TIME; an entity, for its last moment; or an image
(PNG, JPEG). Moments of the same entity are compared with it; with an image, of the entity that
--entity names, or of the only one with images. A moment is compared with what was seen or measured
up to two seconds before it (--context), so that taking something up and putting it down differ.
Images are compared by codes of 24 bytes, which a night makes (engram consolidate); those that it
has not made yet are computed, and --keep stores them. Numbers are compared by their values and
changes. Distances: 0 for equal codes, 1 for two moments at random.

Examples:
  engram similar kitchen.engram 'Vision/RGB/head/stereo/2026-01-01 08:00:10'
  engram similar robot.engram Vision/RGB/head/cam -k 5 --picture similar.png
  engram similar robot.engram seen.png --entity Vision/RGB/head/cam
  engram similar robot.engram Vision/RGB/head/cam 'Vision @ 2026-01-01..2026-01-02' --one-per-recording
  engram similar kitchen.engram 'Vision/RGB/head/stereo/2026-01-01 08:00:10' --elsewhere \
      --with RobotState/Proprioception/robot/joints=0.5
  engram similar robot.engram RobotState/Proprioception/robot/joints --json)";

struct SimilarArguments {
  std::string store;
  std::string like;
  std::string query;
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

bool is_image_name(const std::string& text) {
  std::string ending = std::filesystem::path(text).extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

Result<idf::NdArray> read_image(const std::string& file) {
  constexpr int64_t kMaxPixels = int64_t{1} << 27;
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  auto image = ltm::decode_any_image_file(bytes.bytes(), kMaxPixels);
  if (!image.ok())
    return Status(image.status().code(), "'" + file + "': " + image.status().message());
  return image;
}

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

/// The request as far as it needs no store.
Result<ltm::SimilarRequest> request_of(const SimilarArguments& arguments) {
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

/// The only entity with images.
Result<ltm::MemoryId> entity_with_images(ltm::StorePast& past) {
  std::vector<ltm::MemoryId> found;
  for (const ltm::MemoryId& id : past.store().entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, past.of(id));
    ENGRAM_ASSIGN_OR_RETURN(const auto last, entity->last());
    if (!last) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto seen, ltm::see(*entity, *last));
    if (seen) found.push_back(id);
  }
  if (found.size() == 1) return found.front();
  std::string names;
  for (const ltm::MemoryId& id : found) names += (names.empty() ? "" : ", ") + id.printable();
  if (found.empty()) return failed_precondition("{}: no entity has images", past.name());
  return invalid_argument("{} entities have images, name one by --entity: {}", found.size(), names);
}

/// Names what is not said letter by letter: the only entity, the last moment.
Status complete(ltm::StorePast& past, ltm::SimilarRequest& request) {
  if (request.image && request.entity.depth() == 0) {
    ENGRAM_ASSIGN_OR_RETURN(request.entity, entity_with_images(past));
  }
  if (request.image || request.moment) return {};
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, past.store().timeline(request.entity));
  request.moment = timeline->last();
  return {};
}

Status search(const SimilarArguments& arguments, ltm::SimilarRequest request) {
  ProgressLine progress;
  if (arguments.keeps_codes) {
    const auto coded =
        ltm::make_codes(arguments.store, model_loader(), {}, progress.sink(), interrupt_token());
    progress.finish();
    ENGRAM_RETURN_IF_ERROR(coded.status());
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto past,
                          ltm::StorePast::open(arguments.store, model_loader(), {}));
  ENGRAM_RETURN_IF_ERROR(complete(*past, request));
  const auto answer = ltm::LikenessSearch(*past).find(request, progress.sink(), interrupt_token());
  progress.finish();
  ENGRAM_RETURN_IF_ERROR(answer.status());
  if (!arguments.picture.empty())
    ENGRAM_RETURN_IF_ERROR(reports::draw_similar(*past, request, *answer, arguments.picture));
  if (arguments.is_json)
    print_json(reports::similar_json(*answer));
  else
    print(reports::similar_text(*answer));
  return {};
}

ExitCode run(const SimilarArguments& arguments) {
  auto request = request_of(arguments);
  if (!request.ok()) return wrong_usage(request.status());
  if (is_image_name(arguments.like)) {
    auto image = read_image(arguments.like);
    if (!image.ok()) return fail(image.status());
    request->image = *std::move(image);
  }
  return done_or_failed(search(arguments, *std::move(request)));
}

}  // namespace

void add_similar_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<SimilarArguments>();
  CLI::App* command = app.add_subcommand("similar", "Find moments like another one");
  command->footer(kSimilarFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("like", arguments->like, "A moment, an entity, or an image file")->required();
  command->add_option("query", arguments->query, "Only moments that this query selects");
  command
      ->add_option("--entity", arguments->entity,
                   "The entity whose images an image is compared with")
      ->check(entity_text());
  command->add_option("-k,--count", arguments->count, "How many moments")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--apart", arguments->apart,
                   "Leave out moments as near in time to a nearer one, or to the one asked with")
      ->check(duration_text())
      ->capture_default_str();
  command->add_flag("--one-per-recording", arguments->is_one_per_recording,
                    "The nearest moment of each recording alone");
  command->add_flag("--elsewhere", arguments->is_elsewhere, "No moments of the same recording");
  command
      ->add_option("--context", arguments->context,
                   "How far back what came before is compared, too; 0s: only the moment itself")
      ->check(duration_text())
      ->capture_default_str();
  command->add_option(
      "--with", arguments->with,
      "ENTITY=WEIGHT: compare this entity, too, beside the first, whose weight is 1");
  command->add_flag("--any-size", arguments->takes_any_size,
                    "Take an image of another size than those of the entity");
  command->add_flag("--keep", arguments->keeps_codes,
                    "Store the codes of all images of the store that have none yet");
  command->add_option("--picture", arguments->picture, "Draw the moments (PNG)");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
