// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/running_replay.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "memory/replay/replay_clock.h"
#include "memory/replay/replay_part.h"

namespace engram::memory {

namespace {

/// How much is done before others get their turn.
constexpr size_t kEntitiesAtOnce = 1;
constexpr int kArrivalsAtOnce = 64;
constexpr int kMaxRenewals = 100;
/// How often the clock is told of while it goes, and the longest that the thread sleeps.
constexpr auto kBetweenStates = std::chrono::seconds(1);

}  // namespace

struct Replay::State {
  explicit State(const ReplayOptions& options) : clock(Time::min(), options.speed) {
    clock.set_loop(options.loop);
  }

  ReplayClock clock;
  std::vector<std::unique_ptr<ReplayPart>> parts;
  std::optional<Time> first, last;

  /// How many wait to tell the replay what to do. A mutex alone would let the thread take its turn
  /// again and again.
  std::atomic<int> commanding{0};
  /// Held by who goes on in the recorded order, or sets the clock.
  mutable Mutex going;
  Mutex waking;
  StoppableCondition wake;
  bool has_changed ENGRAM_GUARDED_BY(waking) = false;
  std::atomic<size_t> teller{SIZE_MAX};  ///< The part that is committed what the replay says.

  std::string failure ENGRAM_GUARDED_BY(going);
  std::atomic<uint64_t> told{0}, unreadable{0}, scored{0}, bounded{0}, within_bound{0};
  std::jthread thread;  ///< The last member, so it ends first.

  void notify() {
    {
      const MutexLock lock(waking);
      has_changed = true;
    }
    wake.notify_one();
  }

  [[nodiscard]] Status check_moment(Time time) const {
    if (time >= *first) return {};
    return invalid_argument("replay: found {}, which lies before the first snapshot at {}",
                            to_string(time), to_string(*first));
  }

  /// What can be known of a command before it is obeyed.
  [[nodiscard]] Status check(const ReplayCommand& command) const {
    using Kind = ReplayCommand::Kind;
    ENGRAM_RETURN_IF_ERROR(command.validate());
    if (command.kind == Kind::kSeek) return check_moment(command.time);
    if (command.kind == Kind::kLoop && command.loop) return check_moment(command.loop->first);
    return {};
  }

  void jump(Time to) ENGRAM_REQUIRES(going) {
    clock.jump(to);
    // Before the states of later moments are forgotten, so that there always is one.
    tell_state();
    for (const auto& part : parts) {
      part->rewind(to);
      part->restart(to);
    }
  }

  /// Whether all parts know where they go on.
  Result<bool> prepare(size_t max) ENGRAM_REQUIRES(going) {
    for (const auto& part : parts) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_done, part->prepare(max));
      if (!is_done) return false;
    }
    return true;
  }

  /// The part whose next snapshot arrived first; null behind the last. Needs prepared parts.
  ReplayPart* next() ENGRAM_REQUIRES(going) {
    ReplayPart* first_one = nullptr;
    for (const auto& part : parts)
      if (part->next() && (first_one == nullptr || *part->next() < *first_one->next()))
        first_one = part.get();
    return first_one;
  }

  void pass(ReplayPart& part) ENGRAM_REQUIRES(going) {
    const ReplayPart::Passed passed = part.pass();
    told += passed.snapshots;
    unreadable += passed.unreadable;
  }

  /// Passes what had arrived at `now`, and is told of all parts' next snapshots.
  Result<ReplayPart*> next_after(Time now) ENGRAM_REQUIRES(going) {
    for (int renewals = 0; renewals < kMaxRenewals;) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_prepared, prepare(SIZE_MAX));
      if (!is_prepared) {
        ++renewals;  // A store was replaced meanwhile.
        continue;
      }
      ReplayPart* const part = next();
      if (part == nullptr || *part->next() > now) return part;
      pass(*part);
    }
    return unavailable("replay: the stores changed {} times meanwhile; ask again", kMaxRenewals);
  }

  /// Goes on playing if there is nothing to step to.
  Status step() ENGRAM_REQUIRES(going) {
    const bool was_playing = clock.course().is_playing;
    clock.set_playing(false);
    const Time now = clock.now();
    const auto part = next_after(now);
    if (!part.ok() || *part == nullptr) {
      clock.set_playing(was_playing);
      ENGRAM_RETURN_IF_ERROR(part.status());
      return not_found("replay: nothing was recorded after {}", to_string(now));
    }
    const Time arrived = *(*part)->next();
    clock.advance(arrived);
    return next_after(arrived).status();
  }

  Status obey(const ReplayCommand& command) ENGRAM_REQUIRES(going) {
    using Kind = ReplayCommand::Kind;
    switch (command.kind) {
      case Kind::kPlay:
      case Kind::kPause:
        clock.set_playing(command.kind == Kind::kPlay);
        break;
      case Kind::kStep:
        return step();
      case Kind::kSeek:
        jump(command.time);
        break;
      case Kind::kSpeed:
        clock.set_speed(command.speed);
        break;
      case Kind::kLoop:
        clock.set_loop(command.loop);
        // A loop that lies before is entered at its beginning.
        if (command.loop && clock.now() > command.loop->last) jump(command.loop->first);
        break;
    }
    return {};
  }

  Status score() ENGRAM_REQUIRES(going) {
    const Time now = clock.now();
    for (const auto& part : parts) {
      ENGRAM_ASSIGN_OR_RETURN(const auto scores, part->score(now));
      tell_scores(scores, now);
    }
    return {};
  }

  void tell_scores(const std::vector<PredictionScore>& scores, Time now) ENGRAM_REQUIRES(going) {
    for (const PredictionScore& score : scores) {
      ++scored;
      bounded += score.has_bound() ? 1 : 0;
      within_bound += score.has_bound() && score.is_within_bound() ? 1 : 0;
    }
    tell(commit_of(scores, now));
  }

  void tell(ltm::Commit commit) ENGRAM_REQUIRES(going) {
    const size_t part = teller;
    if (part < parts.size() && !commit.updates.empty()) parts[part]->commit(std::move(commit));
  }

  /// With the lock, so that nobody tells of an earlier state behind a later one.
  void tell_state() ENGRAM_REQUIRES(going) {
    const ReplayState now = state();
    tell({{{replay_clock_entity(),
            now.now,
            {{now.to_data(), {.created = now.now, .sent = now.now, .provider = "engram"}}}}}});
  }

  /// Logs an error once, however often it comes again.
  void note(const Status& status) ENGRAM_REQUIRES(going) {
    if (failure == status.message()) return;
    failure = status.message();
    if (!status.ok()) log::warning("{}", status.to_string());
  }

  [[nodiscard]] ReplayState state() const {
    const ReplayClock::Course course = clock.course();
    ReplayState state;
    for (const auto& part : parts) {
      state.stores.push_back(part->store().string());
      state.unscored += part->predictions().unscored();
    }
    state.now = course.now;
    state.speed = course.speed;
    state.is_playing = course.is_playing;
    state.loop = course.loop;
    state.first = *first;
    state.last = *last;
    state.jumps = course.jumps;
    state.told = told;
    state.unreadable = unreadable;
    state.scored = scored;
    state.bounded = bounded;
    state.within_bound = within_bound;
    return state;
  }

  /// Tells what the clock has passed. Returns how long nothing is to be done.
  /// Errors: if a store cannot be read any more.
  Result<Duration> tell_passed() ENGRAM_REQUIRES(going) {
    const ReplayClock::Course course = clock.course();
    ENGRAM_ASSIGN_OR_RETURN(bool is_prepared, prepare(kEntitiesAtOnce));
    for (int i = 0; is_prepared && i < kArrivalsAtOnce; ++i) {
      ReplayPart* const part = next();
      if (part == nullptr || *part->next() > course.now) break;
      pass(*part);
      ENGRAM_ASSIGN_OR_RETURN(is_prepared, prepare(kEntitiesAtOnce));
    }
    // Not all entities are looked up, or the store was replaced meanwhile.
    if (!is_prepared) return Duration(0);
    ENGRAM_RETURN_IF_ERROR(score());
    ReplayPart* const part = next();
    Duration wait = kBetweenStates;
    if (part != nullptr) wait = std::min(wait, clock.until(*part->next()));
    if (wait == Duration(0) || !course.loop || !course.is_playing) return wait;
    if (course.now < course.loop->last) return std::min(wait, clock.until(course.loop->last));
    if (course.now == course.loop->last) jump(course.loop->first);
    return course.now == course.loop->last ? Duration(0) : wait;
  }

  Duration go_on() ENGRAM_EXCLUDES(going) {
    const MutexLock lock(going);
    const auto wait = tell_passed();
    note(wait.status());
    return wait.ok() ? *wait : kBetweenStates;
  }

  void run(const std::stop_token& stop) {
    SteadyTime told_at = steady_now() - kBetweenStates;
    while (!stop.stop_requested()) {
      for (int others = commanding; others > 0; others = commanding) commanding.wait(others);
      const uint64_t jumps = clock.course().jumps;
      const Duration wait = go_on();
      const bool is_due = clock.course().is_playing && steady_now() - told_at >= kBetweenStates;
      if (is_due || clock.course().jumps != jumps) {
        const MutexLock lock(going);
        tell_state();
        told_at = steady_now();
      }
      if (wait == Duration(0)) continue;
      const MutexLock lock(waking);
      wake.wait_for(waking, stop, wait, [this]() ENGRAM_REQUIRES(waking) { return has_changed; });
      has_changed = false;
    }
  }
};

/// The past below one service.
class Replay::Below final : public PastBelow {
 public:
  Below(std::shared_ptr<Replay> replay, size_t part, bool tells)
      : replay_(std::move(replay)),
        part_(*replay_->state_->parts.at(part)),
        number_(part),
        tells_(tells) {}

  [[nodiscard]] Clock clock() const override {
    // Held by the parts of a service, which this outlives.
    return [state = replay_->state_.get()] { return state->clock.now(); };
  }
  [[nodiscard]] ltm::SegmentTypes types() const override { return part_.types(); }

  std::unique_ptr<ltm::KnownPast> attach(const std::string& name,
                                         ltm::WorkingMemory& above) override {
    auto past = part_.attach(name, above);
    if (tells_) {
      State& state = *replay_->state_;
      const MutexLock lock(state.going);
      state.teller = number_;
      state.tell_state();
    }
    return past;
  }
  void detach() override {
    if (tells_) replay_->state_->teller = SIZE_MAX;
    part_.detach();
  }
  void tell(PastListener listener) override { part_.tell(std::move(listener)); }

  Status check(const ltm::Commit& commit) override {
    const auto is_control = [](const ltm::EntityUpdate& update) {
      return update.entity == replay_control_entity();
    };
    if (!tells_ || std::ranges::none_of(commit.updates, is_control)) return {};
    if (commit.updates.size() != 1 || commit.updates.front().instances.size() != 1)
      return invalid_argument("'{}': found {} updates in a commit, needs one command alone",
                              replay_control_entity().to_string(), commit.updates.size());
    ENGRAM_ASSIGN_OR_RETURN(const ReplayCommand command,
                            ReplayCommand::from_data(commit.updates[0].instances[0].data));
    return replay_->state_->check(command);
  }

  Status admitted(const ltm::Admission& admission) override {
    const std::span<const ltm::SharedSnapshot> snapshots = admission.snapshots;
    Status obeyed;
    if (tells_ && !snapshots.empty() && snapshots[0]->entity == replay_control_entity())
      obeyed = obey(*snapshots[0]);
    if (obeyed.ok())
      part_.take_back_later(snapshots);
    else
      part_.take_back(snapshots);
    return obeyed;
  }
  void answered(const ltm::Answer& answer) override { part_.predictions().add(answer); }

 private:
  Status obey(const ltm::HeldSnapshot& control) {
    ENGRAM_ASSIGN_OR_RETURN(const ReplayCommand command,
                            ReplayCommand::from_data(control.instances[0].data));
    return replay_->obey(command);
  }

  const std::shared_ptr<Replay> replay_;
  ReplayPart& part_;
  const size_t number_;
  const bool tells_;
};

Replay::Replay(std::unique_ptr<State> state) : state_(std::move(state)) {}
Replay::~Replay() = default;

Result<std::shared_ptr<Replay>> Replay::open(const std::vector<std::filesystem::path>& stores,
                                             ltm::ModelLoader loader,
                                             const ReplayOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (stores.empty()) return invalid_argument("replay: found no store, needs one");
  auto state = std::make_unique<State>(options);
  State& running = *state;
  for (const std::filesystem::path& store : stores) {
    ENGRAM_ASSIGN_OR_RETURN(
        auto part, ReplayPart::open(store, loader, [&running] { return running.clock.now(); }));
    if (part->first()) {
      state->first = std::min(state->first.value_or(*part->first()), *part->first());
      state->last = std::max(state->last.value_or(*part->last()), *part->last());
    }
    state->parts.push_back(std::move(part));
  }
  if (!state->first)
    return invalid_argument("replay of '{}': found no snapshot, needs one", stores[0].string());
  Time begin = options.at.value_or(*state->first);
  // A loop that lies before is entered at its beginning, as one that is commanded.
  if (options.loop && begin > options.loop->last) begin = options.loop->first;
  state->clock.advance(begin);
  ENGRAM_RETURN_IF_ERROR(state->check_moment(state->clock.now()));
  for (const auto& part : state->parts) part->restart(state->clock.now());
  if (options.loop) ENGRAM_RETURN_IF_ERROR(state->check_moment(options.loop->first));
  state->clock.set_playing(!options.is_paused);
  auto replay = std::shared_ptr<Replay>(new Replay(std::move(state)));
  running.thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
  return replay;
}

std::shared_ptr<PastBelow> Replay::below(size_t store, bool tells_of_replay) {
  return std::make_shared<Below>(shared_from_this(), store, tells_of_replay);
}

Status Replay::obey(const ReplayCommand& command) {
  State& state = *state_;
  ENGRAM_RETURN_IF_ERROR(state.check(command));
  struct Turn {
    explicit Turn(std::atomic<int>& number) : count(number) { ++count; }
    ~Turn() {
      --count;
      count.notify_all();
    }
    std::atomic<int>& count;
  };
  Status obeyed;
  {
    const Turn turn(state.commanding);
    const MutexLock lock(state.going);
    obeyed = state.obey(command);
    state.tell_state();
  }
  state.notify();
  return obeyed;
}

ReplayState Replay::state() const {
  return state_->state();
}

}  // namespace engram::memory
