// SPDX-License-Identifier: Apache-2.0
#include "server/robot/skill_host.h"

#include "ltm/core/log.h"
#include "ltm/skills/skill_ids.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

/// Notes that somebody asked for a skill.
class SkillHost::FirstRequest final : public memory::EventListener {
 public:
  void offer(std::span<const memory::SharedEvent> /*events*/) override {
    {
      const MutexLock lock(mutex_);
      is_asked_ = true;
    }
    asked_.notify_all();
  }
  void forget(const memory::IsForgotten& /*is_forgotten*/) override {}

  /// False if a stop was requested first.
  bool wait(const std::stop_token& stop) {
    const MutexLock lock(mutex_);
    return asked_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return is_asked_; });
  }

 private:
  Mutex mutex_;
  StoppableCondition asked_;
  bool is_asked_ ENGRAM_GUARDED_BY(mutex_) = false;
};

SkillHost::~SkillHost() {
  if (hub_ != nullptr) hub_->unsubscribe(first_.get());
}

void SkillHost::start_on_request(memory::EventHub& hub) {
  hub_ = &hub;
  first_ = std::make_shared<FirstRequest>();
  hub.subscribe_uncounted(first_, [](const ltm::MemoryId& entity) {
    return entity.names()[0] == skills::kSkillMemory &&
           entity.names()[1] == skills::kRequestSegment;
  });
  starting_ = std::jthread([this](const std::stop_token& stop) {
    if (!first_->wait(stop)) return;
    hub_->unsubscribe(first_.get());
    if (const auto started = get(); !started.ok())
      log::warning("skills: somebody asked for one, but: {}", started.status().message());
  });
}

Result<skills::SkillMemory*> SkillHost::get() {
  // Its memory may be reached over the network, and a handler of a stream may be waiting here.
  const BlockingScope blocking;
  const MutexLock lock(mutex_);
  if (is_closed_) return unavailable("the skill memory is closed");
  if (skills_) return skills_.get();
  ENGRAM_ASSIGN_OR_RETURN(memory_, open_());
  ENGRAM_ASSIGN_OR_RETURN(skills_, skills::SkillMemory::start(*memory_, options_));
  started_ = skills_.get();
  return skills_.get();
}

void SkillHost::close() {
  {
    const MutexLock lock(mutex_);
    is_closed_ = true;
  }
  if (skills::SkillMemory* running = started_; running != nullptr) running->close();
}

}  // namespace engram::server
