// SPDX-License-Identifier: Apache-2.0
#include "cli/kitchen_drive.h"

#include <array>
#include <cmath>

#include "datasets/kitchen/robot_bus.h"
#include "ltm/core/log.h"
#include "ltm/skills/skill_types.h"
#include "server/kitchen/body_client.h"
#include "server/navigation/cost_map_provider.h"
#include "server/navigation/driver.h"
#include "server/navigation/plan_check.h"

namespace engram::cli {

namespace {

namespace kitchen = datasets::kitchen;
namespace nav = engram::navigation;

constexpr const char* kDriveSkill = R"(name: drive
doc: Drives around what is in the way to a place, a thing or a piece of furniture.
parameters:
  to: {type: string, doc: 'Its name or alias, such as table, salt or chair.'}
conditions:
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
resources: [platform]
timeout: 5min
)";

/// The room is small, and the robot's arms are over the furniture: it keeps less distance than a
/// robot in a hall, and drives slowly.
constexpr double kInflation_m = 0.45;
/// Things are told five times a second, and the platform hears a command within two periods of
/// control.
constexpr double kReaction_s = 0.3;

nav::MapRules kitchen_rules() {
  nav::MapRules rules;
  rules.provider = "kitchen";
  rules.costs.robot_radius_m = kitchen::kPlatformRadius_m;
  rules.costs.inflation_radius_m = kInflation_m;
  rules.reaction_s = kReaction_s;
  return rules;
}

/// The platform of the kitchen's robot, over the bus of its body.
class BusBase final : public nav::DriveBase {
 public:
  BusBase(std::unique_ptr<kitchen::RobotBus> bus, Time start)
      : bus_(std::move(bus)), start_(start) {}

  static Result<std::unique_ptr<BusBase>> connect(const server::Endpoint& endpoint) {
    ENGRAM_ASSIGN_OR_RETURN(auto bus, server::connect_body(endpoint, "skills"));
    ENGRAM_ASSIGN_OR_RETURN(const kitchen::BodyDescription about, bus->describe());
    return std::make_unique<BusBase>(std::move(bus), about.start);
  }

  Result<nav::BaseState> state() override {
    ENGRAM_RETURN_IF_ERROR(look(0));
    constexpr double kPerSecond = kitchen::RobotBus::kRate_hz;
    const double heading = state_.positions[2];
    const double forward =
        state_.velocities[0] * std::cos(heading) + state_.velocities[1] * std::sin(heading);
    ENGRAM_ASSIGN_OR_RETURN(const Duration since,
                            duration_from_seconds(static_cast<double>(state_.sample) / kPerSecond));
    return nav::BaseState{start_ + since,
                          {state_.positions[0], state_.positions[1], heading},
                          {forward, state_.velocities[2]}};
  }

  Status move(const nav::Twist& twist) override {
    return bus_->command(kitchen::Drive{{twist.forward_m_s, 0, twist.turn_rad_s}}).status();
  }

  Status stop() override { return bus_->command(kitchen::Drive{}).status(); }

  Status wait(Duration time) override {
    const double samples = std::ceil(to_seconds(time) * kitchen::RobotBus::kRate_hz);
    return look(state_.sample + static_cast<uint64_t>(std::max(1.0, samples)));
  }

 private:
  /// Waits for a sample, and keeps the newest state.
  Status look(uint64_t until) {
    ENGRAM_ASSIGN_OR_RETURN(const auto states, bus_->wait(until, {}));
    if (states.empty()) return unavailable("the body of the kitchen told no state");
    state_ = states.back();
    return {};
  }

  const std::unique_ptr<kitchen::RobotBus> bus_;
  const Time start_;
  kitchen::BodyState state_;
};

/// Why the skill was asked for: the first cause of its request.
ltm::MemoryId cause_of(Memory& memory, const ltm::MemoryId& request) {
  const auto value = nav::value_at(memory, request);
  if (!value.ok()) return {};
  const auto asked = ::skill::ExecutionRequest::from_idf(*value);
  return asked.ok() && !asked->causes.empty() ? asked->causes.front() : ltm::MemoryId();
}

SkillEnd end_of_drive(const Result<nav::DriveOutcome>& outcome) {
  if (!outcome.ok()) return SkillEnd::failure(outcome.status().message());
  SkillEnd end;
  end.outcome = outcome->has_arrived()                              ? SkillOutcome::kSuccess
                : outcome->kind == ::navigation::EventKind::STOPPED ? SkillOutcome::kStop
                                                                    : SkillOutcome::kFailure;
  end.reason = outcome->reason;
  end.result = idf::Dict{{"travelled_m", outcome->travelled_m},
                         {"took_s", to_seconds(outcome->took)},
                         {"replans", static_cast<int64_t>(outcome->replans)}};
  for (const ltm::MemoryId& link : {outcome->event, outcome->plan})
    if (link.depth() > 0) end.links.push_back(link);
  return end;
}

class LiveNavigation final : public KitchenNavigation {
 public:
  LiveNavigation(Memory& memory, std::unique_ptr<nav::CostMapProvider> maps,
                 std::unique_ptr<nav::Driver> driver)
      : memory_(memory), maps_(std::move(maps)), driver_(std::move(driver)) {}

  Status add_to(SkillProvider& provider, const server::Endpoint& bus) override {
    return provider.add(kDriveSkill, [this, bus](SkillRun& run) {
      const auto& to = run.parameters().at("to")->get<std::string>();
      if (to.find_first_not_of(' ') == std::string::npos)
        return SkillEnd::failure("to: is empty, needs the name of a place or thing");
      auto base = BusBase::connect(bus);
      if (!base.ok()) return SkillEnd::failure(base.status().message());
      const nav::DriveRequest request{
          .goal = to, .request = run.request(), .cause = cause_of(memory_, run.request())};
      return end_of_drive(driver_->drive(
          request, **base, run.stop(), [&run](::navigation::EventKind, const std::string& text) {
            const Status told = run.report(idf::Dict{{"event", text}});
            if (!told.ok()) log::debug("drive: {}", told.message());
          }));
    });
  }

 private:
  Memory& memory_;
  const std::unique_ptr<nav::CostMapProvider> maps_;
  const std::unique_ptr<nav::Driver> driver_;
};

}  // namespace

Result<std::unique_ptr<KitchenNavigation>> KitchenNavigation::start(Memory& memory) {
  nav::Driver::Options driving;
  driving.rules = kitchen_rules();
  driving.limits.robot_radius_m = kitchen::kPlatformRadius_m;
  driving.limits.reaction_s = kReaction_s;
  driving.limits.max_speed_m_s = 0.45;
  ENGRAM_ASSIGN_OR_RETURN(auto maps, nav::CostMapProvider::start(memory, {.rules = driving.rules}));
  ENGRAM_ASSIGN_OR_RETURN(auto driver, nav::Driver::open(memory, driving));
  return std::unique_ptr<KitchenNavigation>(
      std::make_unique<LiveNavigation>(memory, std::move(maps), std::move(driver)));
}

}  // namespace engram::cli
