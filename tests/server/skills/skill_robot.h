// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/skills/skill_ids.h"
#include "memory/memory.h"
#include "server/skills/skill_call.h"
#include "server/skills/skill_memory.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// A provider without a network. It notes what it is told, and ends by itself what `ends` says.
class PlainProvider final : public skills::ProviderLink {
 public:
  explicit PlainProvider(skills::SkillMemory& memory) : memory_(memory) {}

  void come(const std::string& name, std::vector<std::string> descriptions) {
    session_ = memory_.connect(self_, {name, std::move(descriptions)});
  }
  static std::shared_ptr<PlainProvider> create(skills::SkillMemory& memory) {
    auto made = std::make_shared<PlainProvider>(memory);
    made->self_ = std::shared_ptr<ProviderLink>(made.get(), [](ProviderLink*) {});
    return made;
  }
  void go() { memory_.disconnect(session_); }

  void welcome(const Status& status) override {
    const MutexLock lock(mutex_);
    welcome_ = status;
    is_welcomed_ = true;
    changed_.notify_all();
  }
  void start(const skills::SkillStart& start) override {
    const MutexLock lock(mutex_);
    starts_.push_back(start);
    changed_.notify_all();
  }
  void stop(const std::string& execution, const std::string& reason) override {
    const MutexLock lock(mutex_);
    stops_.emplace_back(execution, reason);
    changed_.notify_all();
  }

  Status welcomed() {
    const MutexLock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(mutex_, std::chrono::seconds(20),
                                  [&]() ENGRAM_REQUIRES(mutex_) { return is_welcomed_; }));
    return welcome_;
  }
  /// The n-th start, from 0; waits for it.
  skills::SkillStart started(size_t n = 0) {
    const MutexLock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(mutex_, std::chrono::seconds(20),
                                  [&]() ENGRAM_REQUIRES(mutex_) { return starts_.size() > n; }));
    return starts_.size() > n ? starts_[n] : skills::SkillStart{};
  }
  std::pair<std::string, std::string> told_to_stop(size_t n = 0) {
    const MutexLock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(mutex_, std::chrono::seconds(20),
                                  [&]() ENGRAM_REQUIRES(mutex_) { return stops_.size() > n; }));
    return stops_.size() > n ? stops_[n] : std::pair<std::string, std::string>();
  }
  size_t starts() {
    const MutexLock lock(mutex_);
    return starts_.size();
  }

  void report(const std::string& execution, const std::string& data,
              std::vector<std::string> links = {}) {
    memory_.report(session_,
                   {.execution = execution, .data_json = data, .links = std::move(links)});
  }
  void end(const std::string& execution,
           skills::SkillOutcome outcome = skills::SkillOutcome::kSuccess,
           const std::string& reason = "done") {
    memory_.report(session_, {.execution = execution,
                              .data_json = "{}",
                              .is_end = true,
                              .outcome = outcome,
                              .reason = reason});
  }

 private:
  skills::SkillMemory& memory_;
  std::shared_ptr<ProviderLink> self_;
  std::atomic<uint64_t> session_{0};
  Mutex mutex_;
  ConditionVariable changed_;
  bool is_welcomed_ ENGRAM_GUARDED_BY(mutex_) = false;
  Status welcome_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<skills::SkillStart> starts_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<std::pair<std::string, std::string>> stops_ ENGRAM_GUARDED_BY(mutex_);
};

/// A memory with a skill memory, in a scratch directory.
struct SkillRobot {
  SkillRobot() { open(); }
  ~SkillRobot() { close(); }

  void open() {
    auto opened = Memory::open(scratch.path() / "robot.engram");
    ENGRAM_CHECK(opened.ok(), "{}", opened.status().message());
    memory = *std::move(opened);
    auto started =
        skills::SkillMemory::start(*memory, {.closes_within = std::chrono::milliseconds(50)});
    ENGRAM_CHECK(started.ok(), "{}", started.status().message());
    skills = *std::move(started);
  }
  void close() {
    skills.reset();
    if (memory) EXPECT_OK(memory->close());
    memory.reset();
  }

  void say(const std::string& text) {
    commit("Speech/Commands/human/text", idf::Dict{{"text", text}});
  }
  void commit(const std::string& entity, idf::Data value) {
    EXPECT_OK(memory->commit(
        {{{*ltm::MemoryId::parse(entity), system_now(), {{std::move(value), {}}}}}}));
  }

  /// All values of a segment, in the order of time.
  template <typename T>
  std::vector<T> all(const std::string& segment) {
    std::vector<T> values;
    const auto answer = memory->query("Skill/" + segment + " @ all");
    if (!answer.ok()) return values;
    for (const ltm::EntityResult* entity : answer->entities())
      for (const ltm::SnapshotResult& one : entity->snapshots) {
        auto value = T::from_idf(one.instances.front().data);
        EXPECT_OK(value);
        if (value.ok()) values.push_back(*std::move(value));
      }
    return values;
  }

  ScratchDirectory scratch;
  std::unique_ptr<Memory> memory;
  std::unique_ptr<skills::SkillMemory> skills;
};

}  // namespace engram::testing
