// SPDX-License-Identifier: Apache-2.0
#include "tests/server/navigation/drive_series.h"

#include <fmt/format.h>

#include <chrono>
#include <random>

#include "ltm/idf/json.h"
#include "server/navigation/locations.h"
#include "server/navigation/plan_check.h"
#include "server/navigation/why.h"
#include "server/skills/skill_records.h"
#include "tests/server/navigation/floor_example.h"
#include "tests/server/navigation/simulated_floor.h"

namespace engram::navigation::testing {

namespace {

struct Asked {
  DriveRequest request;
  std::string words;
  ltm::MemoryId speech;
  bool is_surrounded = false;
};

/// Of perception, memory and maps together, and of a platform.
constexpr Duration kLatency = std::chrono::milliseconds(70);
/// What arrives is this near to a place, and to the outline of a thing: places beside that are up
/// to 0.93 m away, and each is good as long as the thing goes no farther than 0.4 m.
constexpr double kAtPlaceM = 0.1;
constexpr double kBesideM = 1.35;

const ltm::MemoryId kSpeech = *ltm::MemoryId::parse("Speech/Commands/human/text");
const skills::SkillName kDrive{"robot", "drive"};
const PlanarPose kHome{-4, -4, 0.5};
const PlanarPose kBesideSofa{-1.2, 0.4, 0};

/// Somebody says where to go, and a request follows from it, as the memory of skills writes it.
Result<Asked> ask(Memory& memory, skills::SkillRecords& records, SimulatedFloor& floor,
                  std::mt19937& random, const std::string& where_it_is) {
  Asked asked;
  const std::vector<std::string> names{"table", "counter",   "shelf", "sofa",   "chair",
                                       "home",  "my corner", "salt",  "chair_2"};
  const uint32_t kind = random() % 20;
  if (kind < 13) {
    // Somewhere else than where it is.
    do {
      asked.request.goal = names[random() % names.size()];
    } while (asked.request.goal.substr(0, 5) == where_it_is.substr(0, 5));
  } else if (kind < 18) {
    asked.request.pose = floor.free_place();
  } else if (kind == 18) {
    asked.request.pose = PlanarPose{1.5, 1, 0};  // In the middle of the table.
  } else {
    asked.request.goal = "cellar";
  }
  asked.is_surrounded = random() % 12 == 0;
  asked.words = fmt::format("Please move to {}!", goal_text(asked.request));
  asked.speech = kSpeech.at(floor.now()).instance(0);
  ENGRAM_RETURN_IF_ERROR(memory.commit(
      {{{kSpeech, floor.now(), {{idf::Dict{{"speaker", "human"}, {"text", asked.words}}, {}}}}}},
      CommitDurability::kMemory));
  ::skill::ExecutionRequest request;
  request.skill = kDrive.to_string();
  request.wish = ::skill::Wish::RUN;
  ENGRAM_ASSIGN_OR_RETURN(request.parameters,
                          idf::to_json_text(idf::Dict{{"to", goal_text(asked.request)}}));
  request.causes = {asked.speech};
  ENGRAM_ASSIGN_OR_RETURN(asked.request.request, records.add_request("human", kDrive, request));
  // Every other one tells its cause beside its request, as a program without skills would.
  if (random() % 2 == 0) asked.request.cause = asked.speech;
  return asked;
}

Status commit_places(Memory& memory) {
  ::navigation::Location home;
  home.name = "charging station";
  home.aliases = {"home"};
  home.pose_world_location = kHome.to_array();
  ENGRAM_RETURN_IF_ERROR(commit_location(memory, "people", home, kBegin));
  ::navigation::Location corner;
  corner.name = "my corner";
  corner.object = surface_id("sofa");
  corner.pose_object_location = kBesideSofa.to_array();
  ENGRAM_RETURN_IF_ERROR(commit_location(memory, "people", corner, kBegin));
  return memory.commit({{class_of("salt", "cylinder", 0.05, 0.05, 0.1),
                         thing_at("salt_1", "salt", {1.5, 1.2, 0}, 0.8, kBegin)}});
}

/// How far the robot really is from where it was to be, and how far it may be from there.
struct Beside {
  double distance_m = 0;
  double max_m = kAtPlaceM;
};

/// From the place, or from the outline of the thing that the last plan was for, where that really
/// is.
Result<Beside> beside(Memory& memory, SimulatedFloor& floor, const DriveOutcome& outcome,
                      const DriveRequest& request) {
  ENGRAM_ASSIGN_OR_RETURN(const BaseState state, floor.state());
  const Eigen::Vector2d robot = state.pose_world_robot.position();
  const auto from = [&](const PlanarPose& place) {
    return Beside{(place.position() - robot).norm()};
  };
  if (request.pose) return from(*request.pose);
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, value_at(memory, outcome.plan));
  ENGRAM_ASSIGN_OR_RETURN(const auto plan, ::navigation::Plan::from_idf(value));
  const std::string& name = plan.location.names().back();
  if (name == "charging station") return from(kHome);
  if (name == "my corner") return from(floor.body("sofa")->pose_world_obstacle.times(kBesideSofa));
  const auto body = floor.body(name == "salt_1" ? "table" : name);
  if (!body)
    return not_found("the plan is for '{}', which nobody knows", plan.location.printable());
  return Beside{body->distance_m(robot), kBesideM};
}

/// Whether the answer leads from the last event to the words, which name the goal.
bool is_explained(Memory& memory, const DriveOutcome& outcome, const Asked& asked) {
  const auto steps = why(memory, outcome.event);
  return steps.ok() && steps->size() >= 4 && (*steps)[1].id == outcome.plan &&
         (*steps)[2].id == asked.request.request && (*steps)[3].id == asked.speech &&
         steps->back().says == asked.words;
}

}  // namespace

Result<Series> drive_series(const std::filesystem::path& store, const SeriesOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(store));
  SimulatedFloor floor(*memory, {.seed = options.seed, .latency = kLatency});
  ENGRAM_RETURN_IF_ERROR(floor.commit_first());
  ENGRAM_RETURN_IF_ERROR(commit_places(*memory));
  for (const auto& [segment, type] : skills::skill_types())
    ENGRAM_RETURN_IF_ERROR(memory->declare(segment, type));
  skills::SkillRecords records(
      *memory, [&floor] { return floor.now(); }, CommitDurability::kMemory);
  Driver::Options driver_options;
  driver_options.period = std::chrono::milliseconds(100);
  // What is seen late, the period of control, and what is heard late.
  driver_options.limits.reaction_s = to_seconds(2 * kLatency + driver_options.period);
  driver_options.rules.reaction_s = driver_options.limits.reaction_s;
  ENGRAM_ASSIGN_OR_RETURN(const auto provider,
                          CostMapProvider::start(*memory, {.rules = driver_options.rules}));
  driver_options.time_limit = std::chrono::seconds(120);
  ENGRAM_ASSIGN_OR_RETURN(const auto driver, Driver::open(*memory, driver_options));
  floor.wait_for_maps(*provider, driver->maps());
  std::mt19937 random(options.seed);
  Series series;
  std::string where_it_is = "-";
  for (int i = 0; i < options.drives; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Asked asked, ask(*memory, records, floor, random, where_it_is));
    int steps = 0;
    floor.on_step = [&] {
      if (asked.is_surrounded && ++steps == 15) floor.surround(true);
    };
    ENGRAM_ASSIGN_OR_RETURN(const DriveOutcome outcome, driver->drive(asked.request, floor));
    floor.on_step = nullptr;
    floor.surround(false);
    if (outcome.has_arrived()) {
      where_it_is = goal_text(asked.request);
      ENGRAM_ASSIGN_OR_RETURN(const Beside is, beside(*memory, floor, outcome, asked.request));
      series.max_beside_m = std::max(series.max_beside_m, is.distance_m);
      series.elsewhere += is.distance_m > is.max_m ? 1 : 0;
    }
    // Persons go on for a while before the next words, and those around the robot go away.
    for (int k = 0; k < (asked.is_surrounded ? 150 : 10); ++k)
      ENGRAM_RETURN_IF_ERROR(floor.wait(driver_options.period));
    ++series.drives;
    series.arrived += outcome.has_arrived() ? 1 : 0;
    series.replans += outcome.replans;
    series.travelled_m += outcome.travelled_m;
    series.driven_s += to_seconds(outcome.took);
    series.explained += is_explained(*memory, outcome, asked) ? 1 : 0;
    const std::string kind(to_string(outcome.kind));
    ++series.endings[kind];
    if (!outcome.has_arrived()) {
      series.without_reason += outcome.reason.empty() ? 1 : 0;
      series.failures.push_back(
          fmt::format("{} '{}': {}", kind, goal_text(asked.request), outcome.reason));
    }
    if (floor.collisions() > series.collisions && series.first_collision.empty())
      series.first_collision = fmt::format("drive {} with {}", i, floor.collided_with());
    series.collisions = floor.collisions();
    if (options.is_verbose)
      fmt::print("{:4} {:8} {:5.1f} s {:5.2f} m {:2} replans  '{}': {}\n", i, kind,
                 to_seconds(outcome.took), outcome.travelled_m, outcome.replans,
                 goal_text(asked.request), outcome.reason);
  }
  series.min_distance_m = floor.min_distance_m();
  series.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return series;
}

}  // namespace engram::navigation::testing
