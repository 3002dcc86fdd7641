// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kept_commits.h"

#include <thread>
#include <utility>

namespace engram::datasets::kitchen {

namespace {

constexpr std::chrono::milliseconds kBetweenTries{100};

}  // namespace

Status KeptCommits::prepare_and_commit(const ltm::Commit& commit) {
  if (!is_prepared_) {
    ENGRAM_RETURN_IF_ERROR(options_.declare());
    // A second commit of the same time counts once.
    ENGRAM_RETURN_IF_ERROR(options_.commit(prior_));
    is_prepared_ = true;
  }
  return options_.commit(commit);
}

Result<bool> KeptCommits::commit(const ltm::Commit& commit, const std::stop_token& stop) {
  while (true) {
    const Status status = prepare_and_commit(commit);
    if (status.ok()) {
      if (std::exchange(is_away_, false))
        options_.say(fmt::format("the memory is back; {} snapshots were lost", lost_));
      return true;
    }
    if (status.code() != StatusCode::kUnavailable) return status;
    is_prepared_ = false;
    if (!std::exchange(is_away_, true)) {
      ++times_away_;
      lost_ = 0;
      options_.say(fmt::format("{}; {}", status.message(),
                               waits_ ? "time stands still until it is back"
                                      : "what is sensed is lost until it is back"));
    }
    if (!waits_) {
      lost_ += commit.updates.size();
      return false;
    }
    if (stop.stop_requested()) return cancelled("stopped");
    std::this_thread::sleep_for(kBetweenTries);
  }
}

void add_snapshot(ltm::Commit& commit, ltm::MemoryId entity, Time time,
                  std::vector<idf::Data> values, std::string_view provider) {
  ltm::EntityUpdate update{.entity = std::move(entity), .time = time};
  for (idf::Data& value : values)
    update.instances.push_back(
        {std::move(value), {.created = time, .sent = time, .provider = std::string(provider)}});
  commit.updates.push_back(std::move(update));
}

}  // namespace engram::datasets::kitchen
