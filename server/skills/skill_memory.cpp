// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_memory.h"

#include <atomic>
#include <deque>
#include <functional>
#include <thread>

#include "ltm/core/mutex.h"
#include "ltm/memory/answered_snapshots.h"

namespace engram::skills {

struct SkillMemory::State {
  /// One thing to do for the thread that owns the engine. It has no bound: providers and the memory
  /// bound what they send, and nothing of it may be dropped.
  using Task = std::function<void(SkillEngine&)>;

  Memory& memory;
  const Options options;
  std::atomic<int64_t> told_ns{0};  ///< What the clock entity told last.
  std::atomic<uint64_t> sessions{0};

  mutable Mutex mutex;
  ConditionVariable wake;
  std::deque<Task> tasks ENGRAM_GUARDED_BY(mutex);
  bool is_closing ENGRAM_GUARDED_BY(mutex) = false;
  SkillCounters counters ENGRAM_GUARDED_BY(mutex);

  SkillRecords records;
  WatchedEntities watched;
  SkillEngine engine;
  std::unique_ptr<Subscription> ticks;  ///< Of the clock entity.
  std::thread thread;

  State(Memory& of, const Options& with)
      : memory(of),
        options(with),
        records(of, clock(), with.durability),
        watched(
            of, [this](std::vector<ToldSnapshot> told) { take(std::move(told)); },
            [this] { post([](SkillEngine& one) { one.on_gap(); }); }),
        engine(records, watched, clock(), with.carries_out_since) {}

  Clock clock() {
    if (!options.clock) return system_now;
    return [this] { return time_from_ns(told_ns.load()); };
  }

  void post(Task task) {
    {
      const MutexLock lock(mutex);
      tasks.push_back(std::move(task));
    }
    wake.notify_one();
  }

  void take(std::vector<ToldSnapshot> told) {
    post([told = std::move(told)](SkillEngine& one) {
      for (const ToldSnapshot& snapshot : told)
        if (snapshot.has_data && !snapshot.snapshot.instances.empty())
          one.on_snapshot(snapshot.snapshot);
    });
  }

  Status listen_to_clock() {
    if (!options.clock) return {};
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [this](std::vector<ToldSnapshot> told) {
      for (const ToldSnapshot& one : told)
        told_ns = std::max(told_ns.load(), to_ns(one.snapshot.time));
      post([](SkillEngine& one) { one.on_time(); });
    };
    const std::string names = ltm::exact_names(*options.clock);
    ENGRAM_ASSIGN_OR_RETURN(ticks, memory.subscribe({.names = {names}}, std::move(handlers)));
    ENGRAM_ASSIGN_OR_RETURN(const auto last, watched.latest(names));
    for (const ltm::Snapshot& snapshot : last)
      told_ns = std::max(told_ns.load(), to_ns(snapshot.time));
    return {};
  }

  /// How long the thread may sleep.
  [[nodiscard]] Duration until_next() const {
    constexpr Duration kMaxSleep = std::chrono::seconds(60);
    // Where an entity tells the time, its snapshots wake the thread.
    if (options.clock) return kMaxSleep;
    const auto next = engine.next_time();
    if (!next) return kMaxSleep;
    return std::clamp<Duration>(*next - system_now(), Duration(0), kMaxSleep);
  }

  void run() {
    while (true) {
      const Duration sleep = until_next();
      std::deque<Task> some;
      bool is_over = false;
      {
        const MutexLock lock(mutex);
        wake.wait_for(mutex, sleep,
                      [this]() ENGRAM_REQUIRES(mutex) { return !tasks.empty() || is_closing; });
        std::swap(some, tasks);
        is_over = is_closing;
      }
      for (Task& task : some) task(engine);
      engine.on_time();
      {
        const MutexLock lock(mutex);
        counters = engine.counters();
      }
      if (is_over) return;
    }
  }

  /// Lets executions end, for a while; then they are lost. Called once the thread has ended.
  void end_all() {
    engine.shut_down();
    const SteadyTime until = steady_now() + options.closes_within;
    while (!engine.is_idle() && steady_now() < until) {
      std::deque<Task> some;
      {
        const MutexLock lock(mutex);
        wake.wait_for(mutex, until - steady_now(),
                      [this]() ENGRAM_REQUIRES(mutex) { return !tasks.empty(); });
        std::swap(some, tasks);
      }
      for (Task& task : some) task(engine);
    }
    engine.lose_all("the skill memory was closed while it ran");
    const MutexLock lock(mutex);
    counters = engine.counters();
  }
};

SkillMemory::SkillMemory(std::unique_ptr<State> state) : state_(std::move(state)) {}

SkillMemory::~SkillMemory() {
  close();
}

Result<std::unique_ptr<SkillMemory>> SkillMemory::start(Memory& memory, const Options& options) {
  for (const auto& [segment, type] : skill_types())
    ENGRAM_RETURN_IF_ERROR(memory.declare(segment, type));
  auto state = std::make_unique<State>(memory, options);
  ENGRAM_RETURN_IF_ERROR(state->listen_to_clock());
  ENGRAM_RETURN_IF_ERROR(state->engine.recover());
  State& running = *state;
  state->thread = std::thread([&running] { running.run(); });
  return std::unique_ptr<SkillMemory>(new SkillMemory(std::move(state)));
}

uint64_t SkillMemory::connect(std::shared_ptr<ProviderLink> link, const ProviderHello& hello) {
  const uint64_t session = ++state_->sessions;
  state_->post([session, link = std::move(link), hello](SkillEngine& engine) {
    engine.connect(session, link, hello);
  });
  return session;
}

void SkillMemory::change(uint64_t session, const ProviderChange& change) {
  state_->post([session, change](SkillEngine& engine) { engine.change(session, change); });
}

void SkillMemory::report(uint64_t session, const SkillReport& report) {
  state_->post([session, report](SkillEngine& engine) { engine.report(session, report); });
}

void SkillMemory::disconnect(uint64_t session) {
  state_->post([session](SkillEngine& engine) { engine.disconnect(session); });
}

void SkillMemory::close() {
  {
    const MutexLock lock(state_->mutex);
    if (state_->is_closing) return;
    state_->is_closing = true;
  }
  state_->wake.notify_all();
  state_->thread.join();
  state_->end_all();
}

SkillCounters SkillMemory::counters() const {
  const MutexLock lock(state_->mutex);
  return state_->counters;
}

}  // namespace engram::skills
