// SPDX-License-Identifier: Apache-2.0
#include "memory/live/live_forgetting.h"

#include <algorithm>
#include <iterator>

#include "ltm/core/log.h"
#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/forget_target.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/memory/select.h"
#include "ltm/recall/access_log.h"
#include "ltm/store/night_lock.h"

namespace engram::memory {

using ltm::ForgetSet;
using ltm::MemoryId;

namespace {

/// How much is looked up at once: others ask in between. Unit: bytes of an answer without data.
constexpr size_t kLookedUpBytes = size_t{1} << 20;

uint64_t count_of(const ForgetSet& set) {
  uint64_t count = 0;
  for (const auto& [entity, times] : set) count += times.size();
  return count;
}

ltm::ForgetPlan plan_of(const ForgetSet& gone) {
  ltm::ForgetPlan plan;
  for (const auto& [entity, times] : gone) plan.entities[entity].gone = times;
  return plan;
}

Result<ltm::Erasures> nothing_to_code_anew(const std::filesystem::path& /*store*/,
                                           const ForgetSet& /*gone*/,
                                           const ProgressSink& /*progress*/,
                                           const std::stop_token& /*stop*/) {
  return ltm::Erasures();
}

/// One call of forget_live().
class LiveForgetting {
 public:
  LiveForgetting(const ForgettingParts& parts, const ForgetRequest& request)
      : parts_(parts), request_(request), progress_(request.progress) {
    // Erasing reaches what was made of it, and models of others, which the view may not see.
    if (request.view && request.progress)
      progress_ = [sink = request.progress](const Progress& progress) {
        sink({"forget", progress.done, progress.total, "", progress.seconds_left});
      };
  }

  Result<ForgetOutcome> run() {
    ENGRAM_RETURN_IF_ERROR(check_erasing());
    if (parts_.store != nullptr) filtered_ = parts_.store->waiting_times();
    ENGRAM_RETURN_IF_ERROR(ltm::check_forget_targets(request_.targets));
    for (const std::string& target : request_.targets) ENGRAM_RETURN_IF_ERROR(look_up(target));
    ENGRAM_RETURN_IF_ERROR(note());
    ENGRAM_RETURN_IF_ERROR(check_stop("nothing was changed"));
    if (request_.is_dry_run) {
      ENGRAM_RETURN_IF_ERROR(add_made_of());
      return outcome();
    }
    Status status = forget();
    // Also where something failed: what went is not to come back from what was read of it.
    const Status anew = parts_.ask([](ltm::Recall& recall) { return recall.start_anew(); });
    if (status.ok()) status = anew;
    if (status.ok()) return outcome();
    if (request_.view) {
      log::warning("{}: forgetting: {}", parts_.name, status.to_string());
      status = Status(status.code(), "it may not be told why");
    }
    return status.with_context(fmt::format(
        "{}: working memory forgot {} snapshots, and the store not all of it yet; the same request "
        "carries on",
        parts_.name, outcome_.from_memory));
  }

 private:
  [[nodiscard]] Status check_stop(std::string_view what) const {
    if (!request_.stop.stop_requested()) return {};
    return cancelled("{}: forgetting was stopped; {}", parts_.name, what);
  }

  void tell(const std::string& what) const {
    if (progress_) progress_({what, 0, 0, "", -1});
  }

  /// What would fail later fails before anything is changed.
  [[nodiscard]] Status check_erasing() const {
    if (!request_.erases || parts_.store == nullptr) return {};
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Manifest manifest, ltm::read_manifest(parts_.path));
    if (!manifest.models.empty() && !parts_.tools.code_anew)
      return failed_precondition(
          "{}: its store has {} models, and this server has no LibTorch to make new ones; needs "
          "'engram forget --erase' on the store while no server runs",
          parts_.name, manifest.models.size());
    if (parts_.tools.ready) ENGRAM_RETURN_IF_ERROR(parts_.tools.ready(parts_.path));
    if (request_.is_dry_run) return {};
    return ltm::NightLock::of_erasing(parts_.path).status();
  }

  /// Adds what a target names.
  Status look_up(const std::string& text) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::ForgetTarget target, ltm::ForgetTarget::parse(text));
    tell("look up " + text);
    uint64_t found = 0;
    for (size_t i = 0; i < target.meanings.size() && found == 0; ++i) {
      if (parts_.pass) parts_.pass(target.meanings[i], request_.view.get());
      ENGRAM_ASSIGN_OR_RETURN(found, add_answer(target.meanings[i]));
      ENGRAM_ASSIGN_OR_RETURN(const uint64_t held, add_filtered(target.meanings[i]));
      found += held;
    }
    if (found > 0) return {};
    ENGRAM_RETURN_IF_ERROR(target.not_a_query);
    return not_found("{}: '{}' names no snapshot{}", parts_.name, text,
                     request_.view ? " that may be erased" : "");
  }

  /// Adds all at once, since a set takes long for each that does not come last.
  uint64_t add(const MemoryId& entity, std::vector<Time> times) {
    const uint64_t count = times.size();
    if (count > 0) gone_[entity].insert_all(TimeSet(std::move(times)));
    return count;
  }

  Result<uint64_t> add_answer(const ltm::Query& query) {
    ltm::Recall::Options options;
    options.view = request_.view;
    std::optional<ltm::Recall::AnswerCursor> cursor;
    const Status begun = parts_.ask([&](ltm::Recall& recall) -> Status {
      ENGRAM_ASSIGN_OR_RETURN(cursor, recall.begin(query, options));
      return {};
    });
    if (begun.code() == StatusCode::kNotFound) return uint64_t{0};
    ENGRAM_RETURN_IF_ERROR(begun);
    uint64_t found = 0;
    while (!cursor->is_done()) {
      ENGRAM_RETURN_IF_ERROR(check_stop("nothing was changed"));
      ltm::Answer part;
      ENGRAM_RETURN_IF_ERROR(parts_.ask([&](ltm::Recall& recall) -> Status {
        ENGRAM_ASSIGN_OR_RETURN(part, recall.next(*cursor, kLookedUpBytes));
        return {};
      }));
      for (const ltm::RecalledEntity& entity : part.entities) {
        std::vector<Time> times;
        for (const ltm::RecalledSnapshot& one : entity.snapshots)
          if (one.answer.source != ltm::Source::kPredicted) times.push_back(one.answer.time);
        found += add(entity.id, std::move(times));
      }
    }
    return found;
  }

  /// Filters hold snapshots that neither working memory nor the store has, so that no answer has
  /// them. Selectors select of them as if there were nothing else.
  Result<uint64_t> add_filtered(const ltm::Query& query) {
    uint64_t found = 0;
    for (const auto& [entity, times] : filtered_) {
      if (!query.matches(entity)) continue;
      const ltm::TimeWindows seen = ltm::sight_of(request_.view.get(), entity).times;
      std::vector<Time> visible;
      std::ranges::copy_if(times, std::back_inserter(visible),
                           [&seen](Time time) { return seen.contains(time); });
      const auto queries = query.snapshots_of(entity);
      ENGRAM_RETURN_IF_ERROR(ltm::refuse_conditions(
          queries, fmt::format("'{}', of which filters hold snapshots", entity.to_string())));
      ltm::ListedMoments moments(std::move(visible));
      ENGRAM_ASSIGN_OR_RETURN(const auto selected, ltm::select_snapshots(queries, moments));
      std::vector<Time> chosen;
      for (const ltm::SelectedSnapshot& one : selected)
        if (!one.is_future) chosen.push_back(one.time);
      found += add(entity, std::move(chosen));
    }
    return found;
  }

  Status note() {
    outcome_.notes = ltm::notes_on_targets(request_.targets);
    if (request_.erases || parts_.store == nullptr) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(parts_.path));
    ltm::ForgetPlan plan = plan_of(gone_);
    ENGRAM_RETURN_IF_ERROR(ltm::note_what_is_left(*reader, plan));
    std::ranges::move(plan.notes, std::back_inserter(outcome_.notes));
    return {};
  }

  /// Adds what is held and was made of what goes, and what was made of that.
  void add_made_of_held() {
    if (!request_.erases) return;
    const std::vector<MemoryId> entities = parts_.memory.matching(ltm::Query());
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (const MemoryId& entity : entities)
        for (const ltm::SharedSnapshot& held : parts_.memory.all_of(entity))
          if (ltm::is_made_of(*held, gone_) && gone_[entity].insert(held->time)) is_changed = true;
    }
  }

  /// The same of the store.
  Status add_made_of_stored() {
    if (!request_.erases || parts_.store == nullptr) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(parts_.path));
    ltm::ForgetPlan plan = plan_of(gone_);
    ENGRAM_RETURN_IF_ERROR(ltm::add_made_of(*reader, plan));
    gone_ = plan.to_set();
    return {};
  }

  /// The same of both: what was made of what goes may be held where that is stored, and stored
  /// where that is held.
  Status add_made_of() {
    for (uint64_t known = 0; known != count_of(gone_);) {
      known = count_of(gone_);
      add_made_of_held();
      ENGRAM_RETURN_IF_ERROR(add_made_of_stored());
    }
    return {};
  }

  Status forget() {
    // As add_made_of(), but all that is known by then goes before the next look: what is committed
    // meanwhile may be made of it, too.
    for (uint64_t known = 0; known != count_of(gone_);) {
      known = count_of(gone_);
      add_made_of_held();
      forget_held();
      if (parts_.store == nullptr) continue;
      parts_.store->forget(gone_);
      tell("seal " + parts_.path.string());
      ENGRAM_RETURN_IF_ERROR(parts_.store->seal());
      ENGRAM_RETURN_IF_ERROR(check_stop("what is stored stays"));
      ENGRAM_RETURN_IF_ERROR(add_made_of_stored());
    }
    return parts_.store == nullptr ? Status() : forget_stored();
  }

  void forget_held() {
    outcome_.from_memory +=
        parts_.memory.forget(gone_, [this](std::span<const ltm::SharedSnapshot> waited) {
          outcome_.never_stored += waited.size();
          if (parts_.unstored) parts_.unstored(waited);
        });
    if (request_.on_forgotten) request_.on_forgotten(gone_);
  }

  Status forget_stored() {
    ltm::ForgetTools tools;
    // Without models there is nothing to code anew, and side files go all the same.
    if (request_.erases)
      tools.code_anew = parts_.tools.code_anew ? parts_.tools.code_anew : nothing_to_code_anew;
    auto report = ltm::carry_out(parts_.path, plan_of(gone_), {}, progress_, request_.stop, tools);
    ENGRAM_RETURN_IF_ERROR(report.status());
    outcome_.from_store = report->rewritten.snapshots;
    outcome_.erased = std::move(report->erased);
    if (report->rewritten.is_cancelled)
      return cancelled("what was not taken out of the store by then stays in it");
    // Access logs of forgotten snapshots are useless, but failing to clear them does no harm.
    if (const Status status = ltm::merge_accesses(parts_.path, gone_); !status.ok())
      log::warning("access logs stay as they are: {}", status.message());
    std::vector<MemoryId> entities;
    for (const auto& [entity, times] : gone_) entities.push_back(entity);
    return parts_.store->note_forgotten(entities);
  }

  ForgetOutcome outcome() {
    for (const auto& [entity, times] : gone_) {
      // What was made of what goes may be where the one who asks sees nothing.
      const ltm::TimeWindows seen = ltm::sight_of(request_.view.get(), entity).times;
      std::vector<Time> told;
      std::ranges::copy_if(times, std::back_inserter(told),
                           [&seen](Time time) { return seen.contains(time); });
      if (told.empty()) continue;
      outcome_.entities.push_back({entity, told.size(), told.front(), told.back()});
      outcome_.snapshots += told.size();
    }
    if (request_.view) leave_out_hidden();
    return std::move(outcome_);
  }

  void leave_out_hidden() {
    for (uint64_t* count : {&outcome_.from_memory, &outcome_.never_stored, &outcome_.from_store})
      *count = std::min(*count, outcome_.snapshots);
    if (!outcome_.erased) return;
    std::erase_if(outcome_.erased->entities, [this](const auto& one) {
      return ltm::sight_of(request_.view.get(), one.first).times.empty();
    });
    outcome_.erased->files.clear();
  }

  const ForgettingParts& parts_;
  const ForgetRequest& request_;
  ProgressSink progress_;
  ForgetSet filtered_;  ///< What filters held when this began.
  ForgetSet gone_;
  ForgetOutcome outcome_;
};

}  // namespace

Result<ForgetOutcome> forget_live(const ForgettingParts& parts, const ForgetRequest& request) {
  return LiveForgetting(parts, request).run();
}

}  // namespace engram::memory
