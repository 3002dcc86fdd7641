// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/front_door.h"

#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "ltm/core/log.h"
#include "python/bindings/bound_commit.h"
#include "python/bindings/errors.h"
#include "python/bindings/query_result.h"
#include "python/bindings/values.h"
#include "speech/attention/attention_files.h"
#include "speech/learning/attention_file.h"
#include "speech/telling/tell_period.h"

namespace engram::python {

namespace {

namespace py = pybind11;

CommitDurability durability_of(const std::string& name) {
  if (name == "default") return CommitDurability::kDefault;
  if (name == "memory") return CommitDurability::kMemory;
  if (name == "journal") return CommitDurability::kJournal;
  raise(invalid_argument("durability '{}': needs 'default', 'memory' or 'journal'", name));
}

/// Returns the result of `make`, which is called without the GIL.
template <typename F>
std::unique_ptr<Memory> made(F make) {
  auto memory = [&] {
    const py::gil_scoped_release released;
    return make();
  }();
  return value_or_raise(std::move(memory));
}

/// What the store has learned of questions; null: nothing, or in another version, which is learned
/// anew at night.
std::shared_ptr<speech::QuestionReader> reader_of(const std::string& store) {
  std::error_code error;
  if (store.empty() || !std::filesystem::exists(speech::attention_file(store), error)) return {};
  auto network = speech::load_attention(speech::attention_file(store));
  if (network.ok()) return speech::make_attention_reader(*std::move(network));
  log::warning("{}", network.status().message());
  return {};
}

}  // namespace

FrontDoor::FrontDoor(std::unique_ptr<Memory> memory, std::string store, bool is_past)
    : store_(std::move(store)),
      is_past_(is_past),
      process_(::getpid()),
      memory_(std::move(memory)) {}

std::unique_ptr<FrontDoor> FrontDoor::read(const std::string& store) {
  const OpenOptions options{.is_read_only = true, .notes_reads = false};
  return std::unique_ptr<FrontDoor>(
      new FrontDoor(made([&] { return Memory::open(store, options); }), store, true));
}

std::unique_ptr<FrontDoor> FrontDoor::open(const std::string& store, const OpenOptions& options) {
  return std::unique_ptr<FrontDoor>(
      new FrontDoor(made([&] { return Memory::open(store, options); }), store));
}

std::unique_ptr<FrontDoor> FrontDoor::connect(const std::string& endpoint,
                                              const ConnectOptions& options) {
  return std::unique_ptr<FrontDoor>(
      new FrontDoor(made([&] { return Memory::connect(endpoint, options); }), {}));
}

std::unique_ptr<FrontDoor> FrontDoor::replay(const std::string& store,
                                             const ReplayOptions& options) {
  return std::unique_ptr<FrontDoor>(
      new FrontDoor(made([&] { return Memory::replay(store, options); }), store, true));
}

FrontDoor::~FrontDoor() {
  if (process_ != ::getpid()) {
    // A forked process lacks the threads that closing would wait for, so the memory is leaked.
    static_cast<void>(new std::shared_ptr<Memory>(std::move(memory_)));
    return;
  }
  const py::gil_scoped_release released;
  memory_.reset();
}

/// Calls `work`, which returns a Result or a Status, without the GIL.
template <typename F>
auto FrontDoor::with_memory(F work) {
  using Answer = decltype(work(*memory_));
  Answer result = [&]() -> Answer {
    const py::gil_scoped_release released;
    if (process_ != ::getpid())
      return failed_precondition("the memory was opened by another process: open it in this one");
    const auto memory = [&] {
      const MutexLock lock(mutex_);
      return memory_;
    }();
    if (memory == nullptr) return failed_precondition("the memory is closed");
    return work(*memory);
  }();
  if constexpr (std::is_same_v<Answer, Status>) {
    if (!result.ok()) raise(result);
  } else {
    return value_or_raise(std::move(result));
  }
}

Result<std::vector<int64_t>> FrontDoor::times_of(Memory& memory, const std::string& entity,
                                                 const std::vector<ltm::Selector>& selectors) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query data, ltm::Query::of_entity(id, selectors));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query ids, ltm::Query::create(data.memories(), true));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, memory.query(ids));
  return times_in(answer, id);
}

std::vector<std::string> FrontDoor::entities() {
  return with_memory([](Memory& memory) -> Result<std::vector<std::string>> {
    std::vector<std::string> names;
    const auto answer = memory.query("?ids @ latest");
    if (answer.status().code() == StatusCode::kNotFound) return names;
    ENGRAM_RETURN_IF_ERROR(answer.status());
    for (const ltm::EntityResult* found : answer->entities())
      names.push_back(found->id.to_string());
    return names;
  });
}

py::dict FrontDoor::summary(const std::string& entity) {
  const auto times =
      with_memory([&](Memory& memory) { return times_of(memory, entity, {ltm::select::All{}}); });
  if (times.empty()) raise(not_found("entity '{}': has no snapshot", entity));
  py::dict dict;
  dict["snapshots"] = times.size();
  dict["first"] = times.front();
  dict["last"] = times.back();
  return dict;
}

std::pair<int64_t, int64_t> FrontDoor::span(const std::string& entity) {
  const std::vector<ltm::Selector> ends{ltm::select::IndexRange{0, 0}, ltm::select::Latest{}};
  const auto times = with_memory([&](Memory& memory) { return times_of(memory, entity, ends); });
  if (times.empty()) raise(not_found("entity '{}': has no snapshot", entity));
  return {times.front(), times.back()};
}

std::vector<int64_t> FrontDoor::times(const std::string& entity, std::optional<int64_t> after,
                                      size_t /*count*/) {
  ltm::select::TimeRange behind{Time::min(), Time::max()};
  if (after) {
    if (time_from_ns(*after) == Time::max()) return {};
    behind.first = time_from_ns(*after) + Duration(1);
  }
  return with_memory([&](Memory& memory) { return times_of(memory, entity, {behind}); });
}

std::vector<int64_t> FrontDoor::selected_times(const std::string& entity,
                                               const std::string& selectors) {
  return with_memory([&](Memory& memory) -> Result<std::vector<int64_t>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query ids, ltm::Query::of_entity(id, selectors, true));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, memory.query(ids));
    return times_in(answer, id);
  });
}

py::list FrontDoor::select(const std::string& entity, const std::string& selector) {
  const auto result = with_memory([&](Memory& memory) -> Result<ltm::QueryResult> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::of_entity(id, selector));
    return memory.query(query);
  });
  py::list snapshots;
  for (const ltm::EntityResult* found : result.entities())
    snapshots = snapshots_of(found->id, found->snapshots);
  return snapshots;
}

py::list FrontDoor::query(const std::string& text, const std::string& engine) {
  return answer_of(with_memory([&](Memory& memory) { return memory.query(text, engine); }));
}

py::list FrontDoor::predict(const std::string& entity, const std::vector<int64_t>& horizons,
                            std::optional<int64_t> from, const std::string& engine,
                            const std::string& plan) {
  const ltm::MemoryId id = value_or_raise(entity_of(entity));
  const std::vector<Duration> ahead(horizons.begin(), horizons.end());
  PredictOptions options;
  if (from) options.at = time_from_ns(*from);
  if (!plan.empty()) options.plan = value_or_raise(entity_of(plan));
  options.engine = engine;
  return snapshots_of(
      id, with_memory([&](Memory& memory) { return memory.predict(id, ahead, options); }));
}

py::list FrontDoor::engines(const std::string& entity, int64_t ahead, std::optional<int64_t> at) {
  return engines_of(with_memory([&](Memory& memory) -> Result<std::vector<ltm::EngineRecord>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    std::optional<Time> time;
    if (at) time = time_from_ns(*at);
    return memory.engines(id, Duration(ahead), time);
  }));
}

py::dict FrontDoor::similar(const SimilarArguments& asked) {
  const ltm::SimilarRequest request = similar_request_of(asked);
  return similar_of(with_memory([&](Memory& memory) { return memory.similar(request); }));
}

py::dict FrontDoor::map(const std::string& entity, size_t max_moments) {
  return map_of(with_memory([&](Memory& memory) -> Result<ltm::MomentMap> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    return memory.map(id, max_moments);
  }));
}

void FrontDoor::declare(const std::string& segment, const py::object& type) {
  const ltm::MemoryId id = value_or_raise(ltm::MemoryId::parse(segment));
  const idf::Type read = value_or_raise(idf::type_from_data(from_python(type)));
  with_memory([&](Memory& memory) { return memory.declare(id, read); });
}

void FrontDoor::commit(const py::list& updates, const std::string& durability) {
  const CommitDurability until = durability_of(durability);
  const ltm::Commit commit = commit_of(updates);
  with_memory([&](Memory& memory) { return memory.commit(commit, until); });
}

/// The days of TZ where the environment sets it, as `engram ask` does.
template <typename F>
Result<std::string> FrontDoor::with_asker(Memory& memory, std::optional<int64_t> now, F work) {
  const MutexLock lock(speech_mutex_);
  if (asker_ == nullptr) {
    const char* zone = std::getenv("TZ");
    const bool is_local = zone != nullptr && *zone != '\0';
    ENGRAM_ASSIGN_OR_RETURN(
        asker_, speech::Asker::create(
                    memory, {.zone = is_local ? speech::DayZone::kLocal : speech::DayZone::kUtc,
                             .reader = reader_of(store_)}));
  } else {
    ENGRAM_RETURN_IF_ERROR(asker_->refresh());
  }
  const Time last = is_past_ ? asker_->facts().last_moment() : system_now();
  return work(*asker_, now ? time_from_ns(*now) : last);
}

std::string FrontDoor::ask(const std::string& question, std::optional<int64_t> now,
                           bool is_program) {
  return with_memory([&](Memory& memory) {
    return with_asker(memory, now, [&](speech::Asker& asker, Time when) -> Result<std::string> {
      const auto answer = [&]() -> Result<speech::Answer> {
        if (!is_program) return asker.ask(question, when);
        ENGRAM_ASSIGN_OR_RETURN(const speech::Program program, speech::Program::parse(question));
        return asker.ask_program(program, when);
      }();
      ENGRAM_RETURN_IF_ERROR(answer.status());
      return answer->to_json().dump(-1, ' ', false,
                                    nlohmann::ordered_json::error_handler_t::replace);
    });
  });
}

std::string FrontDoor::tell(const std::string& since, const std::string& until,
                            std::optional<int64_t> now, size_t sentences) {
  return with_memory([&](Memory& memory) {
    return with_asker(memory, now, [&](speech::Asker& asker, Time when) -> Result<std::string> {
      ENGRAM_ASSIGN_OR_RETURN(const speech::Period from,
                              speech::resolve_period(since, when, asker.zone()));
      ENGRAM_ASSIGN_OR_RETURN(const speech::Period to,
                              speech::resolve_period(until, when, asker.zone()));
      ENGRAM_ASSIGN_OR_RETURN(
          const auto narration,
          speech::tell_period(asker.facts(), {from.from, std::max(from.from, to.to)}, when,
                              asker.zone(), sentences));
      nlohmann::ordered_json told = nlohmann::ordered_json::array();
      for (const speech::NarrationSentence& one : narration) {
        nlohmann::ordered_json links = nlohmann::ordered_json::array();
        for (const ltm::MemoryId& id : one.links) links.push_back(id.to_string());
        told.push_back(
            {{"level", speech::name_of(one.level)}, {"text", one.text}, {"links", links}});
      }
      return told.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    });
  });
}

std::unique_ptr<Watch> FrontDoor::watch(const SubscriptionOptions& options) {
  const auto inbox = std::make_shared<Inbox>(options.queue_bound);
  auto subscription = with_memory(
      [&](Memory& memory) { return memory.subscribe(options, Inbox::handlers(inbox)); });
  const MutexLock lock(mutex_);
  std::erase_if(watches_, [](const std::weak_ptr<Inbox>& one) { return one.expired(); });
  watches_.push_back(inbox);
  if (memory_ == nullptr) inbox->close();  // Another thread has closed it meanwhile.
  return std::make_unique<Watch>(inbox, std::move(subscription));
}

void FrontDoor::close() {
  const Status status = [&]() -> Status {
    const py::gil_scoped_release released;
    if (process_ != ::getpid()) return {};
    std::shared_ptr<Memory> memory;
    {
      const MutexLock lock(speech_mutex_);
      asker_.reset();
    }
    {
      const MutexLock lock(mutex_);
      memory.swap(memory_);
      for (const std::weak_ptr<Inbox>& one : watches_)
        if (const auto inbox = one.lock()) inbox->close();
      watches_.clear();
    }
    return memory == nullptr ? Status() : memory->close();
  }();
  if (!status.ok()) raise(status);
}

}  // namespace engram::python
