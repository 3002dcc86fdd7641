// SPDX-License-Identifier: Apache-2.0
#include "tests/speech/remembered_kitchen.h"

#include <cmath>

#include "ltm/core/check.h"
#include "ltm/idf/type.h"

namespace engram::speech::testing {

namespace {

const std::string kThings = "Objects/Instances/kitchen/";
const std::string kSurfaces = "Objects/Surfaces/kitchen/";

idf::Data pose(double x, double y, double z, double heading) {
  return idf::Dict{
      {std::string(idf::kPositionKey), idf::NdArray::take({3}, std::vector<double>{x, y, z})},
      {std::string(idf::kOrientationKey),
       idf::NdArray::take(
           {4}, std::vector<double>{std::cos(heading / 2), 0, 0, std::sin(heading / 2)})}};
}

std::string link(const std::string& entity, Time time) {
  return (*ltm::MemoryId::parse(entity)).at(time).instance(0).to_string();
}

idf::Data optional_link(const std::string& text) {
  return text.empty() ? idf::Data() : idf::Data(text);
}

}  // namespace

Time second(double seconds, int day) {
  return *parse_time("2026-01-01 08:00:00") + std::chrono::hours(24 * day) +
         Duration(std::llround(seconds * 1e9));
}

RememberedKitchen::RememberedKitchen() {
  auto opened = Memory::open(store());
  ENGRAM_CHECK(opened.ok(), "{}", opened.status().to_string());
  memory_ = *std::move(opened);
  const Time start = second(0);
  const auto thing_class = [&](const char* name, const char* spoken) {
    commit(std::string("Objects/Classes/kitchen/") + name, start,
           {{"name", name}, {"spoken_name", spoken}});
  };
  thing_class("salt_box", "salt");
  thing_class("tea_box", "tea");
  thing_class("red_cup", "red cup");
  thing_class("oil_bottle", "oil");
  put_surface(0, "counter", 0, 1.6);
  commit(kSurfaces + "table", start,
         {{"name", "table"},
          {"pose_world_surface", pose(-1.6, 0, 0.8, M_PI)},
          {"depth", 0.8},
          {"width", 1.5}});
}

void RememberedKitchen::commit(const std::string& entity, Time time, idf::Dict value) {
  const auto id = ltm::MemoryId::parse(entity);
  ENGRAM_CHECK(id.ok(), "{}", entity);
  const Status committed = memory_->commit({{{*id, time, {{idf::Data(std::move(value)), {}}}}}});
  ENGRAM_CHECK(committed.ok(), "{}", committed.to_string());
}

std::string RememberedKitchen::say(double at, const std::string& speaker, const std::string& text,
                                   int day) {
  commit("Speech/Commands/human/text", second(at, day), {{"speaker", speaker}, {"text", text}});
  return link("Speech/Commands/human/text", second(at, day));
}

std::string RememberedKitchen::plan(double at, const std::string& thing, const std::string& from,
                                    const std::string& to, const std::string& words, int day) {
  idf::List steps;
  for (const char* skill : {"look", "navigate", "pick", "navigate", "place"}) {
    const std::string surface = steps.empty() ? "" : kSurfaces + (steps.size() < 3 ? from : to);
    steps.emplace_back(idf::Dict{
        {"skill", skill}, {"object", kThings + thing}, {"surface", optional_link(surface)}});
  }
  commit("Tasks/Plans/robot/plan", second(at, day),
         {{"goal", thing + " on " + to}, {"command", words}, {"steps", std::move(steps)}});
  return link("Tasks/Plans/robot/plan", second(at, day));
}

std::string RememberedKitchen::execute(const Done& done) {
  const Time from = second(done.from, done.day);
  const Time to = second(done.to, done.day);
  const std::string request = "Skill/ExecutionRequest/planner/" + done.skill;
  const std::string events = "Skill/Event/robot/" + done.skill;
  idf::List causes;
  if (!done.plan.empty()) causes.emplace_back(done.plan);
  commit(request, from,
         {{"skill", "robot/" + done.skill}, {"wish", int32_t{0}}, {"causes", std::move(causes)}});
  idf::Dict event{
      {"skill", "robot/" + done.skill},
      {"stage", int32_t{0}},
      {"outcome", int32_t{0}},
      {"reason", ""},
      {"started", to_ns(from)},
      {"request", link(request, from)},
      {"parameters", "{}"},
      {"hand", done.hand},
      {"plan", optional_link(done.plan)},
      {"object_before", optional_link(done.thing.empty() ? "" : link(kThings + done.thing, from))},
      {"surface", optional_link(done.surface.empty() ? "" : kSurfaces + done.surface)}};
  commit(events, from, event);
  if (!done.is_ended) return link(events, from);
  event.set("stage", int32_t{2});
  event.set("outcome", static_cast<int32_t>(done.outcome));
  event.set("reason", done.reason);
  event.set("ended", to_ns(to));
  idf::List stopped_by;
  if (!done.stopped_by.empty()) stopped_by.emplace_back(done.stopped_by);
  event.set("stopped_by", std::move(stopped_by));
  commit(events, to, event);
  return link(events, from);
}

void RememberedKitchen::see(double at, const std::string& thing, double x, double y, double z,
                            bool is_visible, const std::string& held_by, int day) {
  std::string kind = thing;
  kind.resize(kind.rfind('_'));
  commit(kThings + thing, second(at, day),
         {{"object_class", link("Objects/Classes/kitchen/" + kind, second(0))},
          {"pose_world_object", pose(x, y, z, 0)},
          {"is_visible", is_visible},
          {"held_by", held_by},
          // Nobody told those of the others.
          {"colour", thing == "salt_box_1" ? "White" : ""}});
}

void RememberedKitchen::put_surface(double at, const std::string& name, double x, double y) {
  commit(kSurfaces + name, second(at),
         {{"name", name},
          {"pose_world_surface", pose(x, y, 0.9, M_PI / 2)},
          {"depth", 0.6},
          {"width", 4.0}});
}

void RememberedKitchen::stand(double at, double x, double y, double heading, int day) {
  const std::vector<float> numbers{static_cast<float>(x), static_cast<float>(y),
                                   static_cast<float>(heading)};
  commit("RobotState/Localization/robot/platform", second(at, day),
         {{"pose_world_platform", idf::NdArray::take({3}, numbers)},
          {"velocity", idf::NdArray::take({3}, std::vector<float>(3))}});
}

void RememberedKitchen::live_one_minute(int day) {
  stand(0, 0, 0.5, 1.57, day);
  see(0, "salt_box_1", 0.5, 1.5, 0.97, true, "", day);
  see(0, "tea_box_1", -0.5, 1.5, 0.96, true, "", day);
  see(0, "red_cup_1", -1.5, 0.2, 0.85, false, "", day);
  const std::string asked = say(1, "Ada", "I need the salt on the table.", day);
  const std::string first = plan(1, "salt_box_1", "counter", "table", asked, day);
  execute({.skill = "look",
           .from = 1,
           .to = 2,
           .thing = "salt_box_1",
           .reason = "in sight",
           .plan = first,
           .day = day});
  stand(2, 0, 0.5, 1.57, day);
  execute({.skill = "navigate",
           .from = 2,
           .to = 4,
           .thing = "salt_box_1",
           .surface = "counter",
           .plan = first,
           .day = day});
  stand(4, 0.3, 0.9, 1.57, day);
  execute({.skill = "pick",
           .from = 4,
           .to = 8,
           .outcome = 2,
           .thing = "salt_box_1",
           .surface = "counter",
           .hand = "right",
           .reason = "the hand closed 0.070 m away from its grasp",
           .plan = first,
           .day = day});
  execute({.skill = "pick",
           .from = 9,
           .to = 13,
           .thing = "salt_box_1",
           .surface = "counter",
           .hand = "right",
           .reason = "lifted 0.135 m",
           .plan = first,
           .day = day});
  see(13, "salt_box_1", 0.3, 1.2, 1.1, true, "right", day);
  stand(13, 0.3, 0.9, 1.57, day);
  execute({.skill = "navigate",
           .from = 13,
           .to = 16,
           .thing = "salt_box_1",
           .surface = "table",
           .plan = first,
           .day = day});
  stand(16, -0.8, 0.1, 3.14, day);
  execute({.skill = "place",
           .from = 16,
           .to = 19,
           .thing = "salt_box_1",
           .surface = "table",
           .hand = "right",
           .reason = "stands 0.004 m from its place",
           .plan = first,
           .day = day});
  see(19, "salt_box_1", -1.5, 0, 0.87, true, "", day);
  const std::string again = say(30, "Ben", "Please bring the tea to the table.", day);
  const std::string second_plan = plan(30, "tea_box_1", "counter", "table", again, day);
  execute({.skill = "look",
           .from = 30,
           .to = 31,
           .thing = "tea_box_1",
           .plan = second_plan,
           .day = day});
  execute({.skill = "navigate",
           .from = 31,
           .to = 34,
           .thing = "tea_box_1",
           .surface = "counter",
           .plan = second_plan,
           .day = day});
  stand(34, -0.5, 0.9, 1.57, day);
  const std::string stop = say(36, "Ben", "Stop!", day);
  execute({.skill = "pick",
           .from = 34,
           .to = 36.5,
           .outcome = 3,
           .thing = "tea_box_1",
           .surface = "counter",
           .hand = "left",
           .reason = "told to stop",
           .plan = second_plan,
           .stopped_by = stop,
           .day = day});
  see(60, "tea_box_1", -0.5, 1.5, 0.96, false, "", day);
  see(60, "salt_box_1", -1.5, 0, 0.87, false, "", day);
}

}  // namespace engram::speech::testing
