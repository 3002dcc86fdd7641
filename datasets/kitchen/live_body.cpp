// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/live_body.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <thread>
#include <utility>

#include "datasets/kitchen/body.h"
#include "datasets/kitchen/robot_urdf.h"
#include "datasets/kitchen/skill_steps.h"
#include "datasets/kitchen/stage.h"
#include "ltm/core/mutex.h"

namespace engram::datasets::kitchen {

namespace {

using WallClock = std::chrono::steady_clock;

constexpr size_t kRememberedStates = size_t{10} * RobotBus::kRate_hz;  ///< 4 MB.
constexpr double kMinSpeed = 0.01;
constexpr double kMaxSpeed = 100;
constexpr uint64_t kNoEnd = ~uint64_t{0};

BodyDescription description_of(const LiveBody::Options& options, const World& world) {
  const DrawingSize size = drawing_size(options.kitchen);
  const Lighting& light = world.layout().light;
  const Pose pose_head_world = world.body_pose("head").inverse();
  BodyDescription all{.seed = options.kitchen.seed,
                      .start = options.kitchen.start,
                      .seconds = options.seconds,
                      .is_stepped = options.is_stepped,
                      .is_held = options.is_held,
                      .begin = 0,
                      .width = size.width,
                      .height = size.height,
                      .samples = size.samples,
                      .lamp = light.lamp,
                      .daylight = light.daylight,
                      .warmth = light.warmth,
                      .lower = {},
                      .upper = {},
                      .urdf = robot_urdf(world),
                      .pose_head_left = pose_head_world * world.camera_pose(Side::kLeft),
                      .pose_head_right = pose_head_world * world.camera_pose(Side::kRight)};
  for (int i = kPlatformJoints; i < kRobotJoints; ++i) {
    all.lower.push_back(world.range(i).first);
    all.upper.push_back(world.range(i).second);
  }
  return all;
}

}  // namespace

Status LiveBody::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(kitchen.validate());
  if (!(speed >= kMinSpeed) || speed > kMaxSpeed)
    return invalid_argument("kitchen: speed {}, needs {} to {}", speed, kMinSpeed, kMaxSpeed);
  if (!(seconds >= 0) || seconds > 1e9)
    return invalid_argument("kitchen: {} seconds, needs 0 to 1e9", seconds);
  if (is_stepped && clients.empty())
    return invalid_argument("kitchen: stepped without clients, needs one that makes the steps");
  if (awaits_skills && !is_stepped)
    return invalid_argument("kitchen: waits for skills, and is not stepped: its clock runs");
  if (is_held && !awaits_skills)
    return invalid_argument("kitchen: held without skills, needs those who let time pass");
  return {};
}

struct LiveBody::State {
  State(const Options& given, Body made)
      : options(given),
        last(given.seconds > 0
                 ? static_cast<uint64_t>(std::llround(given.seconds * RobotBus::kRate_hz))
                 : kNoEnd),
        body(std::move(made)),
        skills(given.is_held) {
    for (const std::string& client : given.clients) drivers[client] = {};
  }

  void remember() ENGRAM_REQUIRES(mutex) {
    states.push_back(body.sense());
    states.back().images_until = images_until;
    if (states.size() > kRememberedStates) states.pop_front();
    coordinates = body.world().coordinates();
    ++counters.samples;
  }

  [[nodiscard]] bool are_drivers_waiting() const ENGRAM_REQUIRES(mutex) {
    return std::ranges::all_of(drivers, [&](const auto& one) ENGRAM_REQUIRES(mutex) {
      return one.second.until > body.sample();
    });
  }

  [[nodiscard]] bool are_all_waiting() const ENGRAM_REQUIRES(mutex) {
    return are_drivers_waiting() && (!options.awaits_skills || skills.are_done(body.sample()));
  }

  void run(const std::stop_token& stop) {
    const auto begin = WallClock::now();
    const MutexLock lock(mutex);
    while (!stop.stop_requested() && !is_over) {
      if (options.is_stepped) {
        if (!clients_changed.wait(mutex, stop, [this]() ENGRAM_REQUIRES(mutex) {
              return is_over || are_all_waiting();
            }))
          break;
      } else {
        const auto next =
            begin +
            std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(
                static_cast<double>(body.sample() + 1) / (RobotBus::kRate_hz * options.speed)));
        clients_changed.wait_until(mutex, stop, next, [] { return false; });
        counters.behind_s = std::chrono::duration<double>(WallClock::now() - next).count();
      }
      if (stop.stop_requested() || is_over) break;
      if (body.sample() >= last) {
        is_over = true;
      } else {
        body.advance();
        remember();
        skills.note(body.sample());
      }
      advanced.notify_all();
    }
    is_over = true;
    advanced.notify_all();
  }

  /// Waits for a sample as a client. Returns false if it has not come yet. Errors: kCancelled.
  Result<bool> wait_for(const Client& client, uint64_t until, const Patience& patience)
      ENGRAM_REQUIRES(mutex) {
    const auto driver = drivers.find(client.name);
    const bool is_skill =
        driver == drivers.end() && options.awaits_skills && client.name == RobotBus::kSkills;
    if (driver != drivers.end()) driver->second = {until, until};
    if (is_skill) skills.wait(client.bus, until);
    notify_clients();
    advanced.wait_for(mutex, patience.stop, patience.max,
                      [&]() ENGRAM_REQUIRES(mutex) { return is_over || body.sample() >= until; });
    if (patience.stop.stop_requested()) return cancelled("the client '{}' stopped", client.name);
    const bool is_there = body.sample() >= until;
    if (!is_there && is_over) return ended();
    // What a client does at this sample must be done before the next one.
    if (is_there && driver != drivers.end()) driver->second.until = body.sample();
    if (is_there && is_skill) skills.wait(client.bus, body.sample());
    return is_there;
  }

  /// Time may pass, or stand still, because of what a client did.
  void notify_clients() ENGRAM_REQUIRES(mutex) {
    clients_changed.notify_all();
    // Whoever lets held time pass waits until all others are done.
    if (options.is_held) advanced.notify_all();
  }

  static Status ended() { return cancelled("the robot's body has ended"); }

  /// How far a driver is.
  struct Driver {
    uint64_t until = 0;  ///< The sample that it waits for.
    uint64_t begin = 0;  ///< It is done with all before.
  };

  const Options options;
  const uint64_t last;  ///< The last sample.
  BodyDescription description;
  std::unique_ptr<Stage> stage;

  mutable Mutex mutex;
  StoppableCondition clients_changed;
  StoppableCondition advanced;
  Body body ENGRAM_GUARDED_BY(mutex);
  std::deque<BodyState> states ENGRAM_GUARDED_BY(mutex);
  std::vector<double> coordinates ENGRAM_GUARDED_BY(mutex);  ///< Of the newest state.
  std::map<std::string, Driver> drivers ENGRAM_GUARDED_BY(mutex);
  SkillSteps skills ENGRAM_GUARDED_BY(mutex);
  uint64_t buses ENGRAM_GUARDED_BY(mutex) = 0;  ///< Of clients in this process.
  uint64_t images_until ENGRAM_GUARDED_BY(mutex) = 0;
  bool is_over ENGRAM_GUARDED_BY(mutex) = false;
  Counters counters ENGRAM_GUARDED_BY(mutex);
  std::jthread thread;
};

LiveBody::LiveBody(std::unique_ptr<State> state) : state_(std::move(state)) {}

LiveBody::~LiveBody() {
  if (state_->thread.joinable()) {
    state_->thread.request_stop();
    state_->thread.join();
  }
}

Result<std::unique_ptr<LiveBody>> LiveBody::start(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  const DrawingSize size = drawing_size(options.kitchen);
  ENGRAM_ASSIGN_OR_RETURN(Body body, Body::create(options.kitchen, size));
  for (const std::string& what : options.pokes) {
    const auto poked = body.poke(what);
    if (!poked.ok()) return poked.status();
  }
  auto state = std::make_unique<State>(options, std::move(body));
  {
    const MutexLock lock(state->mutex);
    ENGRAM_ASSIGN_OR_RETURN(state->stage, Stage::open(state->body.world(), size));
    state->description = description_of(options, state->body.world());
    state->remember();
    if (options.start) state->description.start = options.start();
  }
  state->thread =
      std::jthread([raw = state.get()](const std::stop_token& stop) { raw->run(stop); });
  return std::unique_ptr<LiveBody>(new LiveBody(std::move(state)));
}

BodyDescription LiveBody::describe(const std::string& client) const {
  BodyDescription description = state_->description;
  const MutexLock lock(state_->mutex);
  if (const auto driver = state_->drivers.find(client); driver != state_->drivers.end())
    description.begin = driver->second.begin;
  return description;
}

Result<std::vector<BodyState>> LiveBody::wait(const Client& client, uint64_t until,
                                              const Patience& patience) {
  const MutexLock lock(state_->mutex);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, state_->wait_for(client, until, patience));
  std::vector<BodyState> since;
  if (!is_there) return since;
  // Ten seconds of states, many times a second, would be too much for whoever only steers.
  if (!state_->drivers.contains(client.name)) return std::vector{state_->states.back()};
  for (const BodyState& one : state_->states)
    if (one.sample >= until && since.size() < RobotBus::kMaxStates) since.push_back(one);
  return since;
}

BodyState LiveBody::now() const {
  const MutexLock lock(state_->mutex);
  return state_->states.back();
}

void LiveBody::leave(const Client& client) {
  const MutexLock lock(state_->mutex);
  state_->skills.leave(client.bus);
  state_->notify_clients();
}

Status LiveBody::step(SkillStep step) {
  const MutexLock lock(state_->mutex);
  if (!state_->options.awaits_skills)
    return failed_precondition("kitchen: it does not wait for skills: it is not stepped");
  if (state_->is_over) return State::ended();
  const Status status = state_->skills.take(step);
  state_->notify_clients();
  return status;
}

Result<std::optional<uint64_t>> LiveBody::pass(const PassWish& wish, const Patience& patience) {
  const MutexLock lock(state_->mutex);
  ENGRAM_RETURN_IF_ERROR(state_->skills.pass(wish, state_->body.sample()));
  state_->clients_changed.notify_all();
  const auto has_passed = [&]() ENGRAM_REQUIRES(state_->mutex) {
    return state_->skills.has_passed(wish.id) && state_->are_drivers_waiting() &&
           state_->skills.are_waiting(state_->body.sample());
  };
  state_->advanced.wait_for(
      state_->mutex, patience.stop, patience.max,
      [&]() ENGRAM_REQUIRES(state_->mutex) { return state_->is_over || has_passed(); });
  if (has_passed()) return std::optional(state_->body.sample());
  if (state_->is_over) return State::ended();
  return std::optional<uint64_t>();
}

Result<std::optional<BodyPicture>> LiveBody::draw(const Client& client, uint64_t until,
                                                  uint64_t committed, const Patience& patience) {
  std::vector<double> coordinates;
  uint64_t sample = 0;
  {
    const MutexLock lock(state_->mutex);
    // An object links to this image, so nobody may say that one of the future is there.
    if (committed > state_->body.sample() + 1)
      return invalid_argument("the client '{}' committed images until {}, needs {} at most",
                              client.name, committed, state_->body.sample() + 1);
    state_->images_until = std::max(state_->images_until, committed);
    ENGRAM_ASSIGN_OR_RETURN(const bool is_there, state_->wait_for(client, until, patience));
    if (!is_there) return std::optional<BodyPicture>();
    coordinates = state_->coordinates;
    sample = state_->body.sample();
    ++state_->counters.pictures;
  }
  return std::optional(state_->stage->draw(coordinates, sample));
}

Result<double> LiveBody::command(const BodyCommand& command) {
  const MutexLock lock(state_->mutex);
  return state_->body.command(command);
}

Result<std::string> LiveBody::poke(const std::string& what) {
  const MutexLock lock(state_->mutex);
  return state_->body.poke(what);
}

LiveBody::Counters LiveBody::counters() const {
  const MutexLock lock(state_->mutex);
  return state_->counters;
}

void LiveBody::end() {
  {
    const MutexLock lock(state_->mutex);
    state_->is_over = true;
  }
  state_->advanced.notify_all();
  state_->clients_changed.notify_all();
}

bool LiveBody::has_ended() const {
  const MutexLock lock(state_->mutex);
  return state_->is_over;
}

bool LiveBody::wait_for_end(const std::stop_token& stop) {
  const MutexLock lock(state_->mutex);
  return state_->advanced.wait(state_->mutex, stop,
                               [this]() ENGRAM_REQUIRES(state_->mutex) { return state_->is_over; });
}

uint64_t LiveBody::next_bus() {
  const MutexLock lock(state_->mutex);
  return ++state_->buses;
}

}  // namespace engram::datasets::kitchen
