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
#include "datasets/kitchen/stage.h"
#include "ltm/core/mutex.h"

namespace engram::datasets::kitchen {

namespace {

using WallClock = std::chrono::steady_clock;

constexpr size_t kRememberedStates = RobotBus::kRate_hz;  ///< One second.
constexpr double kMinSpeed = 0.01;
constexpr double kMaxSpeed = 100;
constexpr uint64_t kNoEnd = ~uint64_t{0};

DrawingSize size_of(const KitchenOptions& options) {
  return {.width = options.width,
          .height = options.height,
          .samples = options.is_fine ? 4 : 0,
          .shadow_map = options.is_fine ? 2048 : 0};
}

BodyDescription description_of(const LiveBody::Options& options, const World& world) {
  const DrawingSize size = size_of(options.kitchen);
  const Lighting& light = world.layout().light;
  const Pose pose_head_world = world.body_pose("head").inverse();
  BodyDescription all{.seed = options.kitchen.seed,
                      .start = options.kitchen.start,
                      .seconds = options.seconds,
                      .is_stepped = options.is_stepped,
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
  return {};
}

struct LiveBody::State {
  State(const Options& given, Body made)
      : options(given),
        last(given.seconds > 0
                 ? static_cast<uint64_t>(std::llround(given.seconds * RobotBus::kRate_hz))
                 : kNoEnd),
        body(std::move(made)) {
    for (const std::string& client : given.clients) waiting[client] = 0;
  }

  void remember() ENGRAM_REQUIRES(mutex) {
    states.push_back(body.sense());
    states.back().images_until = images_until;
    if (states.size() > kRememberedStates) states.pop_front();
    coordinates = body.world().coordinates();
    ++counters.samples;
  }

  [[nodiscard]] bool are_all_waiting() const ENGRAM_REQUIRES(mutex) {
    return std::ranges::all_of(waiting, [&](const auto& one) ENGRAM_REQUIRES(mutex) {
      return one.second > body.sample();
    });
  }

  void run(const std::stop_token& stop) {
    const auto begin = WallClock::now();
    const MutexLock lock(mutex);
    while (!stop.stop_requested() && !is_over) {
      if (options.is_stepped) {
        if (!clients_changed.wait(mutex, stop,
                                  [this]() ENGRAM_REQUIRES(mutex) { return are_all_waiting(); }))
          break;
      } else {
        const auto next =
            begin +
            std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(
                static_cast<double>(body.sample() + 1) / (RobotBus::kRate_hz * options.speed)));
        clients_changed.wait_until(mutex, stop, next, [] { return false; });
        counters.behind_s = std::chrono::duration<double>(WallClock::now() - next).count();
      }
      if (stop.stop_requested()) break;
      if (body.sample() >= last) {
        is_over = true;
      } else {
        body.advance();
        remember();
      }
      advanced.notify_all();
    }
    is_over = true;
    advanced.notify_all();
  }

  /// Waits for a sample as a client. Returns false if it has not come yet. Errors: kCancelled.
  Result<bool> wait_for(const std::string& client, uint64_t until, const Patience& patience)
      ENGRAM_REQUIRES(mutex) {
    const auto own = waiting.find(client);
    if (own != waiting.end()) own->second = until;
    clients_changed.notify_all();
    advanced.wait_for(mutex, patience.stop, patience.max,
                      [&]() ENGRAM_REQUIRES(mutex) { return is_over || body.sample() >= until; });
    if (patience.stop.stop_requested()) return cancelled("the client '{}' stopped", client);
    const bool is_there = body.sample() >= until;
    if (!is_there && is_over) return cancelled("the robot's body has ended");
    // What a client does at this sample must be done before the next one.
    if (is_there && own != waiting.end()) own->second = body.sample();
    return is_there;
  }

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
  /// The sample that each client of a stepped body waits for.
  std::map<std::string, uint64_t> waiting ENGRAM_GUARDED_BY(mutex);
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
  const DrawingSize size = size_of(options.kitchen);
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
  }
  state->thread =
      std::jthread([raw = state.get()](const std::stop_token& stop) { raw->run(stop); });
  return std::unique_ptr<LiveBody>(new LiveBody(std::move(state)));
}

const BodyDescription& LiveBody::describe() const {
  return state_->description;
}

Result<std::vector<BodyState>> LiveBody::wait(const std::string& client, uint64_t until,
                                              const Patience& patience) {
  const MutexLock lock(state_->mutex);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, state_->wait_for(client, until, patience));
  std::vector<BodyState> since;
  if (!is_there) return since;
  for (const BodyState& one : state_->states)
    if (one.sample >= until) since.push_back(one);
  return since;
}

Result<std::optional<BodyPicture>> LiveBody::draw(const std::string& client, uint64_t until,
                                                  uint64_t committed, const Patience& patience) {
  std::vector<double> coordinates;
  uint64_t sample = 0;
  {
    const MutexLock lock(state_->mutex);
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

bool LiveBody::has_ended() const {
  const MutexLock lock(state_->mutex);
  return state_->is_over;
}

bool LiveBody::wait_for_end(const std::stop_token& stop) {
  const MutexLock lock(state_->mutex);
  return state_->advanced.wait(state_->mutex, stop,
                               [this]() ENGRAM_REQUIRES(state_->mutex) { return state_->is_over; });
}

namespace {

/// A client in the process of the body.
class NearBus final : public RobotBus {
 public:
  NearBus(LiveBody& body, std::string client) : body_(body), client_(std::move(client)) {}

  Result<BodyDescription> describe() override { return body_.describe(); }
  Result<std::vector<BodyState>> wait(uint64_t until, const std::stop_token& stop) override {
    while (true) {
      auto states = body_.wait(client_, until, {.stop = stop});
      if (!states.ok() || !states->empty()) return states;
    }
  }
  Result<BodyPicture> draw(uint64_t until, uint64_t committed,
                           const std::stop_token& stop) override {
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(auto picture, body_.draw(client_, until, committed, {.stop = stop}));
      if (picture) return *std::move(picture);
    }
  }
  Result<double> command(const BodyCommand& command) override { return body_.command(command); }
  Result<std::string> poke(const std::string& what) override { return body_.poke(what); }

 private:
  LiveBody& body_;
  std::string client_;
};

}  // namespace

std::unique_ptr<RobotBus> LiveBody::bus(std::string client) {
  return std::make_unique<NearBus>(*this, std::move(client));
}

}  // namespace engram::datasets::kitchen
