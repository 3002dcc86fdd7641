// SPDX-License-Identifier: Apache-2.0
#include "cli/kitchen_skill_driver.h"

#include <array>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "cli/kitchen_drive.h"
#include "cli/remote.h"
#include "cli/remote_client.h"
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
  const char* description;
  KitchenSkill function;
};

// Whoever hears a stop stops the robot; objects are told at 5 Hz, so a second shows who holds them.
constexpr std::array<ProvidedSkill, 5> kProvided{{
    {R"(name: look
doc: Turns the head to an object; succeeds if it is in sight.
parameters:
  object: {type: link, doc: 'An object, such as Objects/Instances/kitchen/salt_box_1.'}
resources: [head]
timeout: 10s
)",
     &KitchenSkills::look},
    {R"(name: approach
doc: Drives to where a hand reaches an object.
parameters:
  object: {type: link, doc: An object on the counter or the table.}
  hand: {type: string, choices: [left, right], default: right}
  speed: {type: double, min: 0.2, max: 2, default: 1, doc: How much quicker than usual.}
conditions:
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
resources: [platform]
timeout: 60s
)",
     &KitchenSkills::navigate},
    {R"(name: navigate
doc: Drives to the counter or the table; with something in the hand, to where it can be put down.
parameters:
  surface: {type: string, choices: [counter, table]}
  hand: {type: string, choices: [left, right], default: right}
  speed: {type: double, min: 0.2, max: 2, default: 1, doc: How much quicker than usual.}
conditions:
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
resources: [platform]
timeout: 60s
)",
     &KitchenSkills::navigate},
    {R"(name: pick
doc: Grasps an object within reach and lifts it.
parameters:
  object: {type: link, doc: An object on the counter or the table.}
  hand: {type: string, choices: [left, right], default: right}
  speed: {type: double, min: 0.2, max: 2, default: 1, doc: How much quicker than usual.}
conditions:
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
  post: {entity: $object, path: held_by, equals: $hand}
  post_within: 1s
resources: [arm/$hand, head, platform]
timeout: 60s
)",
     &KitchenSkills::pick},
    {R"(name: place
doc: Puts what a hand holds on a free place of a surface within reach.
parameters:
  surface: {type: string, choices: [counter, table]}
  hand: {type: string, choices: [left, right], default: right}
  speed: {type: double, min: 0.2, max: 2, default: 1, doc: How much quicker than usual.}
conditions:
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
resources: [arm/$hand, head, platform]
timeout: 60s
)",
     &KitchenSkills::place},
}};

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
  ENGRAM_ASSIGN_OR_RETURN(const auto body, server::connect_body(bus, "skills"));
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

Result<RegisteredSkills> register_skills(const server::Endpoint& bus, const RemoteArguments& remote,
                                         const std::function<void(const std::string&)>& say) {
  RegisteredSkills registered;
  ENGRAM_ASSIGN_OR_RETURN(const auto connection, connection_of(remote));
  ENGRAM_ASSIGN_OR_RETURN(
      registered.provider,
      SkillProvider::connect(connection.endpoint, "kitchen", connection.options));
  for (const ProvidedSkill& skill : kProvided)
    ENGRAM_RETURN_IF_ERROR(registered.provider->add(
        skill.description, [bus, function = skill.function](SkillRun& run) {
          return end_of(carry_out(bus, function, run));
        }));
  ENGRAM_ASSIGN_OR_RETURN(registered.memory, connect_memory(remote));
  auto navigation = KitchenNavigation::start(*registered.memory);
  if (!navigation.ok()) {
    say(fmt::format("there is no skill 'drive': {}", navigation.status().message()));
    return registered;
  }
  registered.navigation = *std::move(navigation);
  ENGRAM_RETURN_IF_ERROR(registered.navigation->add_to(*registered.provider, bus));
  return registered;
}

}  // namespace

Status provide_kitchen_skills(const server::Endpoint& bus, const RemoteArguments& remote,
                              const std::function<void(const std::string& words)>& say,
                              const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook{100};
  constexpr Duration kBetweenTries = std::chrono::seconds(1);
  std::optional<RegisteredSkills> registered;
  std::string said;
  SteadyTime next{};
  for (; !stop.stop_requested(); std::this_thread::sleep_for(kLook)) {
    if (registered || steady_now() < next) continue;
    auto made = register_skills(bus, remote, say);
    next = steady_now() + kBetweenTries;
    if (made.ok()) {
      registered = *std::move(made);
      say(fmt::format("the skills look, approach, navigate, pick{} are registered",
                      registered->navigation ? ", place and drive" : " and place"));
      continue;
    }
    if (made.status().code() == StatusCode::kInvalidArgument) return made.status();
    if (made.status().message() != said)
      say(fmt::format("no skills are registered: {}", made.status().message()));
    said = made.status().message();
  }
  return {};
}

}  // namespace engram::cli
