// SPDX-License-Identifier: Apache-2.0
#include "cli/kitchen_skill_driver.h"

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cli/kitchen_drive.h"
#include "cli/remote.h"
#include "cli/remote_client.h"
#include "cli/stepped_skills.h"
#include "datasets/kitchen/kitchen_skills.h"
#include "server/client/skill_provider.h"
#include "server/kitchen/body_client.h"

namespace engram::cli {

namespace {

namespace kitchen = datasets::kitchen;
using kitchen::KitchenSkills;

using KitchenSkill = Result<kitchen::SkillResult> (KitchenSkills::*)(const kitchen::SkillRequest&,
                                                                     const std::stop_token&);

struct ProvidedSkill {
  std::string description;
  KitchenSkill function;
};

/// All but `look` move the platform or an arm: they are of a hand, and whoever hears a stop stops
/// the robot.
std::string moving(std::string_view head, std::string_view what, std::string_view more,
                   std::string_view resources) {
  return fmt::format(R"({}
parameters:
  {}
  hand: {{type: string, choices: [left, right], default: right}}
  speed: {{type: double, min: 0.2, max: 2, default: 1, doc: How much quicker than usual.}}
conditions:
  hold: {{not: {{entity: Speech, path: text, matches: '(?i)stop.*', new: true}}}}
{}resources: [{}]
timeout: 60s
)",
                     head, what, more, resources);
}

std::vector<ProvidedSkill> provided_skills() {
  constexpr std::string_view kObject =
      "object: {type: link, doc: An object on the counter or the table.}";
  constexpr std::string_view kSurface = "surface: {type: string, choices: [counter, table]}";
  // They turn the head too: to where they drive, and to what they grasp.
  constexpr std::string_view kDrives = "head, platform";
  constexpr std::string_view kGrasps = "arm/$hand, head, platform";
  // Objects are told at 5 Hz, so a second shows who holds them.
  constexpr std::string_view kIsHeld =
      "  post: {entity: $object, path: held_by, equals: $hand}\n  post_within: 1s\n";
  return {{R"(name: look
doc: Turns the head to an object; succeeds if it is in sight.
parameters:
  object: {type: link, doc: 'An object, such as Objects/Instances/kitchen/salt_box_1.'}
resources: [head]
timeout: 10s
)",
           &KitchenSkills::look},
          {moving("name: approach\ndoc: Drives to where a hand reaches an object.", kObject, "",
                  kDrives),
           &KitchenSkills::navigate},
          {moving("name: navigate\ndoc: Drives to the counter or the table; with something in the "
                  "hand, to where it can be put down.",
                  kSurface, "", kDrives),
           &KitchenSkills::navigate},
          {moving("name: pick\ndoc: Grasps an object within reach and lifts it.", kObject, kIsHeld,
                  kGrasps),
           &KitchenSkills::pick},
          {moving("name: place\ndoc: Puts what a hand holds on a free place of a surface within "
                  "reach.",
                  kSurface, "", kGrasps),
           &KitchenSkills::place}};
}

/// The text of a parameter; empty where the skill has no such one.
std::string text_at(const idf::Data& parameters, std::string_view name) {
  const idf::Data* value = parameters.at(name);
  const auto* text = value == nullptr ? nullptr : std::get_if<std::string>(&value->value());
  return text == nullptr ? "" : *text;
}

Result<kitchen::SkillRequest> read_request(const idf::Data& parameters) {
  kitchen::SkillRequest request;
  if (const std::string link = text_at(parameters, "object"); !link.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId object, ltm::MemoryId::parse(link));
    if (object.names().size() != ltm::MemoryId::kNameLevels)
      return invalid_argument("object '{}': needs one such as Objects/Instances/kitchen/salt_box_1",
                              link);
    request.object = object.names().back();
  }
  const std::string surface = text_at(parameters, "surface");
  if (surface == "counter") request.surface = kitchen::Surface::kCounter;
  if (surface == "table") request.surface = kitchen::Surface::kTable;
  if (text_at(parameters, "hand") == "left") request.hand = kitchen::Side::kLeft;
  if (const idf::Data* speed = parameters.at("speed"))
    if (const auto* number = std::get_if<double>(&speed->value())) request.speed = *number;
  return request;
}

Result<kitchen::SkillResult> carry_out(const server::Endpoint& bus, KitchenSkill function,
                                       SkillRun& run) {
  ENGRAM_ASSIGN_OR_RETURN(const kitchen::SkillRequest request, read_request(run.parameters()));
  // A bus is of one thread, and each execution has its own.
  ENGRAM_ASSIGN_OR_RETURN(const auto body,
                          server::connect_body(bus, std::string(kitchen::RobotBus::kSkills)));
  KitchenSkills skills(*body);
  return (skills.*function)(request, run.stop());
}

SkillEnd end_of(const Result<kitchen::SkillResult>& result) {
  if (!result.ok()) return SkillEnd::failure(result.status().message());
  SkillEnd end;
  end.outcome = result->end == kitchen::SkillEnd::kSuccess ? SkillOutcome::kSuccess
                : result->end == kitchen::SkillEnd::kStop  ? SkillOutcome::kStop
                                                           : SkillOutcome::kFailure;
  end.reason = result->reason;
  idf::Dict measured;
  for (const auto& [name, number] : result->measured) measured.set(name, number);
  end.result = std::move(measured);
  return end;
}

/// The skills, and what they stand on; the provider ends first.
struct RegisteredSkills {
  std::unique_ptr<Memory> memory;
  std::unique_ptr<KitchenNavigation> navigation;  ///< Null: there is no skill `drive`.
  std::unique_ptr<SkillProvider> provider;
};

/// The body for which skills are registered.
struct SkillBody {
  server::Endpoint bus;
  bool is_held = false;
  std::unique_ptr<kitchen::BodySteps> steps;  ///< Null: its time passes by itself.
};

Result<SkillBody> meet_body(const server::Endpoint& bus) {
  SkillBody body{.bus = bus};
  ENGRAM_ASSIGN_OR_RETURN(const auto connected,
                          server::connect_body(bus, std::string(kitchen::RobotBus::kSkills)));
  ENGRAM_ASSIGN_OR_RETURN(const kitchen::BodyDescription about, connected->describe());
  body.is_held = about.is_held;
  if (!about.is_stepped) return body;
  ENGRAM_ASSIGN_OR_RETURN(body.steps, server::connect_steps(bus));
  ENGRAM_RETURN_IF_ERROR(body.steps->tell(kitchen::SkillStep::kCome));
  return body;
}

Result<std::unique_ptr<SkillProvider>> connect_provider(const SkillBody& body,
                                                        const RemoteArguments& remote) {
  ENGRAM_ASSIGN_OR_RETURN(const auto connection, connection_of(remote));
  ENGRAM_ASSIGN_OR_RETURN(
      std::unique_ptr<SkillProvider> provider,
      SkillProvider::connect(connection.endpoint, "kitchen", connection.options));
  if (!body.steps) return provider;
  auto stepped = std::make_unique<SteppedProvider>(std::move(provider), *body.steps);
  if (body.is_held) ENGRAM_RETURN_IF_ERROR(stepped->add_pass());
  return std::unique_ptr<SkillProvider>(std::move(stepped));
}

Result<RegisteredSkills> register_skills(const SkillBody& body, const RemoteArguments& remote,
                                         const std::function<void(const std::string&)>& say) {
  RegisteredSkills registered;
  ENGRAM_ASSIGN_OR_RETURN(registered.provider, connect_provider(body, remote));
  for (const ProvidedSkill& skill : provided_skills())
    ENGRAM_RETURN_IF_ERROR(registered.provider->add(
        skill.description, [bus = body.bus, function = skill.function](SkillRun& run) {
          return end_of(carry_out(bus, function, run));
        }));
  ENGRAM_ASSIGN_OR_RETURN(registered.memory, connect_memory(remote));
  auto navigation = KitchenNavigation::start(*registered.memory);
  // A memory that is away for a moment is no reason to go without `drive` for ever.
  if (navigation.status().code() == StatusCode::kUnavailable) return navigation.status();
  if (!navigation.ok()) {
    say(fmt::format("there is no skill 'drive': {}", navigation.status().message()));
    return registered;
  }
  registered.navigation = *std::move(navigation);
  ENGRAM_RETURN_IF_ERROR(registered.navigation->add_to(*registered.provider, body.bus));
  return registered;
}

/// Whether trying again may help.
bool is_worth_trying(const Status& status) {
  return status.code() == StatusCode::kUnavailable;
}

}  // namespace

Status provide_kitchen_skills(const server::Endpoint& bus, const RemoteArguments& remote,
                              const std::function<void(const std::string& words)>& say,
                              const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook{100};
  constexpr Duration kBetweenTries = std::chrono::seconds(1);
  ENGRAM_ASSIGN_OR_RETURN(const SkillBody body, meet_body(bus));
  const auto let_pass = [&body] {
    return body.steps ? body.steps->tell(kitchen::SkillStep::kReady) : Status();
  };
  std::optional<RegisteredSkills> registered;
  std::string said;
  SteadyTime next{};
  for (; !stop.stop_requested(); std::this_thread::sleep_for(kLook)) {
    if (registered || steady_now() < next) continue;
    auto made = register_skills(body, remote, say);
    next = steady_now() + kBetweenTries;
    if (made.ok()) {
      registered = *std::move(made);
      say(fmt::format("the skills look, approach, navigate, pick{} are registered",
                      registered->navigation ? ", place and drive" : " and place"));
      ENGRAM_RETURN_IF_ERROR(let_pass());
      continue;
    }
    if (made.status().code() == StatusCode::kInvalidArgument) return made.status();
    if (made.status().message() != said)
      say(fmt::format("no skills are registered: {}", made.status().message()));
    said = made.status().message();
    // Whoever has no memory of skills has a robot all the same, but nobody to let held time pass.
    if (!is_worth_trying(made.status()) && !body.is_held) ENGRAM_RETURN_IF_ERROR(let_pass());
  }
  return {};
}

}  // namespace engram::cli
