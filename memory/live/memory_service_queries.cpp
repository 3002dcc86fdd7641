// SPDX-License-Identifier: Apache-2.0
// What a memory service answers.
#include <algorithm>

#include "memory/live/memory_service_state.h"

namespace engram::memory {

using ltm::MemoryId;

namespace {

/// About what an answer with these moments takes. Unit: bytes.
size_t bytes_of(const ltm::SelectedEntity& selected, bool is_ids_only) {
  constexpr size_t kMoment = 256;
  size_t bytes = kMoment * (1 + selected.snapshots.size());
  if (!is_ids_only)
    for (const ltm::SharedSnapshot& snapshot : selected.snapshots) bytes += snapshot->plain_bytes();
  return bytes;
}

ltm::RecalledEntity recalled(ltm::SelectedEntity& selected, bool is_ids_only) {
  ltm::RecalledEntity entity{std::move(selected.entity), {}};
  entity.snapshots.reserve(selected.snapshots.size());
  for (size_t i = 0; i < selected.snapshots.size(); ++i) {
    ltm::RecalledSnapshot one =
        ltm::recalled(std::move(selected.snapshots[i]), selected.instances[i], is_ids_only);
    if (!one.answer.instances.empty()) entity.snapshots.push_back(std::move(one));
  }
  return entity;
}

}  // namespace

void MemoryService::State::count_answer(const ltm::Answer& answer) {
  if (answer.is_ids_only) return;
  if (options.below) options.below->answered(answer);
  for (const ltm::RecalledEntity& entity : answer.entities) {
    size_t held = 0;
    for (const ltm::RecalledSnapshot& snapshot : entity.snapshots) {
      held += snapshot.held ? 1 : 0;
      if (snapshot.answer.source == ltm::Source::kPredicted) ++counts_of_predictions;
    }
    if (held > 0) memory->count_reads(entity.id, held);
  }
}

ltm::KnownElsewhere MemoryService::State::elsewhere() const {
  if (!store) return {};
  return [this](const MemoryId& entity) { return store->recorded().known_until(entity); };
}

std::optional<ltm::Answer> MemoryService::query_memory(const ltm::Query& query, size_t max_bytes,
                                                       const ltm::View* view) {
  State& state = *state_;
  state.attend(query, view);
  if (query.has_conditions()) return std::nullopt;
  // What lies below has to be looked at, whatever is here.
  if (state.options.below) return std::nullopt;
  ltm::Answer answer{query.is_ids_only(), {}};
  auto selected = state.memory->select(query, state.elsewhere());
  size_t bytes = 0;
  for (ltm::SelectedEntity& entity : selected) {
    const ltm::Sight sight = ltm::sight_of(view, entity.entity);
    if (sight.times.empty()) continue;
    // What was selected of all moments is not what would be of some, and redacting takes long.
    if (!sight.is_whole()) return std::nullopt;
    if (entity.reaches_elsewhere || !entity.future.empty()) return std::nullopt;
    // Reading the sizes takes long where nobody wants to know.
    if (max_bytes != SIZE_MAX) bytes += bytes_of(entity, query.is_ids_only());
    if (bytes > max_bytes) return std::nullopt;
    answer.entities.push_back(recalled(entity, query.is_ids_only()));
  }
  if (answer.entities.empty()) return std::nullopt;
  if (state.store)
    for (const MemoryId& entity : state.store->recorded().matching(query))
      if (!std::ranges::binary_search(answer.entities, entity, {}, &ltm::RecalledEntity::id) &&
          !ltm::sight_of(view, entity).times.empty())
        return std::nullopt;
  ++state.queries;
  state.count_answer(answer);
  return answer;
}

Result<ltm::Answer> MemoryService::query(const ltm::Query& query, const std::string& engine) {
  if (engine.empty())
    if (auto answer = query_memory(query)) return *std::move(answer);
  State& state = *state_;
  state.attend(query, nullptr);
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.engine = engine;
  const MutexLock lock(state.recalling);
  auto answer = state.recall->answer(query, options);
  if (answer.ok()) state.count_answer(*answer);
  return answer;
}

Result<ltm::Recall::AnswerCursor> MemoryService::begin_query(
    const ltm::Query& query, const std::string& engine, ltm::SharedView view,
    std::shared_ptr<const ltm::OtherContexts> others) {
  State& state = *state_;
  state.attend(query, view.get());
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.engine = engine;
  options.view = std::move(view);
  options.others = std::move(others);
  const MutexLock lock(state.recalling);
  return state.recall->begin(query, options);
}

Result<ltm::SharedContext> MemoryService::context(const MemoryId& entity,
                                                  const ltm::SharedView& view) {
  const MutexLock lock(state_->recalling);
  return state_->recall->context(entity, view);
}

Result<ltm::Answer> MemoryService::next_part(ltm::Recall::AnswerCursor& cursor, size_t bytes) {
  const MutexLock lock(state_->recalling);
  auto part = state_->recall->next(cursor, bytes);
  if (part.ok()) state_->count_answer(*part);
  return part;
}

Result<std::vector<ltm::SnapshotResult>> MemoryService::predict(
    const MemoryId& entity, const ltm::PredictionRequest& request, ltm::SharedView view) {
  State& state = *state_;
  // What is predicted begins at the newest snapshot.
  if (!request.from) state.attend(ltm::Query::of_entity(entity, ltm::select::Latest{}), view.get());
  ++state.queries;
  ++state.queries_of_store;
  ltm::Recall::Options options = state.recalling_options;
  options.view = std::move(view);
  const MutexLock lock(state.recalling);
  auto predicted = state.recall->predict(entity, request, options);
  if (predicted.ok()) state.counts_of_predictions += predicted->size();
  return predicted;
}

Result<std::vector<ltm::EngineRecord>> MemoryService::engines(const MemoryId& entity,
                                                              Duration ahead,
                                                              std::optional<Time> at,
                                                              ltm::SharedView view) {
  ltm::Recall::Options options = state_->recalling_options;
  options.view = std::move(view);
  const MutexLock lock(state_->recalling);
  return state_->recall->records(entity, at, ahead, options);
}

Result<ltm::SimilarAnswer> MemoryService::similar(const ltm::SimilarRequest& request,
                                                  ltm::SharedView view,
                                                  const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(owns(request.entity));
  if (!state_->likeness)
    return failed_precondition(
        "server '{}': has no store, and moments are compared with those "
        "that one keeps",
        state_->options.name);
  ++state_->queries;
  ++state_->queries_of_store;
  return state_->likeness->similar(request, view.get(), stop);
}

Result<ltm::MomentMap> MemoryService::map(const ltm::MemoryId& entity, size_t max_moments) {
  ENGRAM_RETURN_IF_ERROR(owns(entity));
  if (!state_->likeness)
    return failed_precondition("memory '{}': has no store, and a map is made of what one keeps",
                               state_->options.name);
  ++state_->queries;
  ++state_->queries_of_store;
  return state_->likeness->map(entity, max_moments);
}

}  // namespace engram::memory
