// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/similar_options.h"
#include "ltm/codec/image_file.h"
#include "ltm/core/file.h"
#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/seen_image.h"
#include "ltm/likeness/similar.h"
#include "memory/model_loader.h"
#include "reports/plain/similar_text.h"
#include "reports/similar_picture.h"

namespace engram::cli {

namespace {

Result<idf::NdArray> read_image(const std::string& file) {
  constexpr int64_t kMaxPixels = int64_t{1} << 27;
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  auto image = ltm::decode_any_image_file(bytes.bytes(), kMaxPixels);
  if (!image.ok())
    return Status(image.status().code(), "'" + file + "': " + image.status().message());
  return image;
}

/// The one entity with images, of those that have any.
Result<ltm::MemoryId> only_one(const std::string& place, const std::vector<ltm::MemoryId>& found) {
  if (found.size() == 1) return found.front();
  std::string names;
  for (const ltm::MemoryId& id : found) names += (names.empty() ? "" : ", ") + id.printable();
  if (found.empty()) return failed_precondition("{}: no entity has images", place);
  return invalid_argument("{} entities have images, name one by --entity: {}", found.size(), names);
}

Result<ltm::MemoryId> entity_with_images(ltm::StorePast& past) {
  std::vector<ltm::MemoryId> found;
  for (const ltm::MemoryId& id : past.store().entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, past.of(id));
    ENGRAM_ASSIGN_OR_RETURN(const auto last, entity->last());
    if (!last) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto seen, ltm::see(*entity, *last));
    if (seen) found.push_back(id);
  }
  return only_one(past.name(), found);
}

Result<ltm::MemoryId> entity_with_images(Memory& memory) {
  std::vector<ltm::MemoryId> found;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query last, ltm::Query::parse("@ latest"));
  ENGRAM_RETURN_IF_ERROR(memory.query_parts(last, [&found](const ltm::QueryResult& part) -> Status {
    for (const ltm::EntityResult* entity : part.entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        if (ltm::image_of(snapshot) != nullptr) found.push_back(entity->id);
    return {};
  }));
  return only_one("server", found);
}

/// The last snapshot of an entity that a selector finds; nothing if it finds none.
Result<std::optional<ltm::SnapshotResult>> find_snapshot(Memory& memory,
                                                         const ltm::MemoryId& entity,
                                                         const ltm::Selector& selector,
                                                         bool is_id_only) {
  const ltm::Query query = ltm::Query::of_entity(entity, selector);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked, ltm::Query::create(query.memories(), is_id_only));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, memory.query(asked));
  const ltm::EntityResult* const found = answer.find_entity(entity);
  if (found == nullptr || found->snapshots.empty()) return std::optional<ltm::SnapshotResult>();
  return std::optional(found->snapshots.back());
}

void show(const SimilarArguments& arguments, const ltm::SimilarAnswer& answer) {
  if (arguments.is_json)
    print_json(reports::similar_json(answer));
  else
    print(reports::similar_text(answer));
}

Status search_store(const SimilarArguments& arguments, ltm::SimilarRequest request) {
  ProgressLine progress;
  if (arguments.keeps_codes) {
    const auto coded =
        ltm::make_codes(arguments.store, model_loader(), {}, progress.sink(), interrupt_token());
    progress.finish();
    ENGRAM_RETURN_IF_ERROR(coded.status());
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto past,
                          ltm::StorePast::open(arguments.store, model_loader(), {}));
  if (request.image && request.entity.depth() == 0) {
    ENGRAM_ASSIGN_OR_RETURN(request.entity, entity_with_images(*past));
  }
  if (!request.image && !request.moment) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, past->store().timeline(request.entity));
    request.moment = timeline->last();
  }
  const auto answer = ltm::LikenessSearch(*past).find(request, progress.sink(), interrupt_token());
  progress.finish();
  ENGRAM_RETURN_IF_ERROR(answer.status());
  if (!arguments.picture.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, past->of(answer->entity));
    const auto seen = [&entity](Time time) -> Result<std::optional<ltm::SnapshotResult>> {
      ENGRAM_ASSIGN_OR_RETURN(const auto at, entity->at_or_before(time));
      if (!at) return std::optional<ltm::SnapshotResult>();
      ENGRAM_ASSIGN_OR_RETURN(auto snapshot, entity->read(*at, ltm::Prefer::kRecorded));
      return std::optional(std::move(snapshot.answer));
    };
    ENGRAM_RETURN_IF_ERROR(reports::draw_similar(seen, request, *answer, arguments.picture));
  }
  show(arguments, *answer);
  return {};
}

Status search_server(const SimilarArguments& arguments, ltm::SimilarRequest request) {
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, connect_memory(arguments.remote));
  if (request.image && request.entity.depth() == 0) {
    ENGRAM_ASSIGN_OR_RETURN(request.entity, entity_with_images(*memory));
  }
  if (!request.image && !request.moment) {
    ENGRAM_ASSIGN_OR_RETURN(const auto last,
                            find_snapshot(*memory, request.entity, ltm::select::Latest{}, true));
    if (!last) return not_found("'{}': has no snapshots", request.entity.to_string());
    request.moment = last->time;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::SimilarAnswer answer, memory->similar(request));
  if (!arguments.picture.empty()) {
    const auto seen = [&](Time time) {
      return find_snapshot(*memory, answer.entity, ltm::select::Before{time, true}, false);
    };
    ENGRAM_RETURN_IF_ERROR(reports::draw_similar(seen, request, answer, arguments.picture));
  }
  show(arguments, answer);
  return {};
}

ExitCode run(SimilarArguments arguments) {
  if (const Status complete = cli::complete(arguments); !complete.ok())
    return wrong_usage(complete);
  auto request = similar_request_of(arguments);
  if (!request.ok()) return wrong_usage(request.status());
  if (is_image_name(arguments.like)) {
    auto image = read_image(arguments.like);
    if (!image.ok()) return fail(image.status());
    request->image = *std::move(image);
  }
  return done_or_failed(arguments.store.empty() ? search_server(arguments, *std::move(request))
                                                : search_store(arguments, *std::move(request)));
}

}  // namespace

void add_similar_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<SimilarArguments>();
  CLI::App* command = app.add_subcommand("similar", "Find moments like another one");
  add_similar_options(*command, *arguments);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
