// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/store_likeness.h"

namespace engram::ltm {

template <typename Ask>
auto StoreLikeness::ask(const MemoryId& about, const std::stop_token& stop, const Ask& question)
    -> decltype(question(std::declval<LikenessSearch&>(), stop)) {
  while (true) {
    const std::stop_token forgotten = [this] {
      const MutexLock lock(stopping_);
      return forgotten_.get_token();
    }();
    std::stop_source stops;
    const auto request_stop = [&stops] { stops.request_stop(); };
    const std::stop_callback by_caller(stop, request_stop);
    const std::stop_callback by_forgetting(forgotten, request_stop);
    auto answer = ask_once(about, stops.get_token(), question);
    const bool is_cancelled = answer.status().code() == StatusCode::kCancelled;
    if (!is_cancelled || stop.stop_requested() || !forgotten.stop_requested()) return answer;
  }
}

template <typename Ask>
auto StoreLikeness::ask_once(const MemoryId& about, const std::stop_token& stop,
                             const Ask& question)
    -> decltype(question(std::declval<LikenessSearch&>(), stop)) {
  const MutexLock lock(mutex_);
  if (stop.stop_requested()) return cancelled("'{}': comparing it", about.to_string());
  if (past_ == nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(past_, StorePast::open(path_, loader_, {.follows_changes = true}));
    search_ = std::make_unique<LikenessSearch>(*past_, memory_);
  }
  auto answer = question(*search_, stop);
  if (answer.ok() || answer.status().code() != StatusCode::kUnavailable) return answer;
  // A consolidation or a sealing replaced a segment while it was read.
  ENGRAM_RETURN_IF_ERROR(past_->renew());
  return question(*search_, stop);
}

Result<SimilarAnswer> StoreLikeness::similar(const SimilarRequest& request, const View* view,
                                             const std::stop_token& stop) {
  return ask(request.entity, stop, [&](LikenessSearch& search, const std::stop_token& stopped) {
    return search.find(request, {}, stopped, view);
  });
}

Result<MomentMap> StoreLikeness::map(const MemoryId& entity, size_t max_moments,
                                     const std::stop_token& stop) {
  return ask(entity, stop, [&](LikenessSearch& search, const std::stop_token& stopped) {
    return search.map(entity, max_moments, stopped);
  });
}

void StoreLikeness::forget_codes() {
  {
    const MutexLock lock(stopping_);
    forgotten_.request_stop();
    forgotten_ = std::stop_source();
  }
  const MutexLock lock(mutex_);
  search_.reset();
  past_.reset();
}

}  // namespace engram::ltm
