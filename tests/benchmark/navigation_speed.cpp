// SPDX-License-Identifier: Apache-2.0
// Prints how soon a cost map of 10 x 10 m at 5 cm follows the commit of an object, what the parts
// of that cost, and how long and how good plans are. Usage: engram_navigation_speed FOLDER
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <vector>

#include "server/navigation/cost_map_provider.h"
#include "server/navigation/map_feed.h"
#include "server/navigation/path_planner.h"
#include "server/navigation/plan_check.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using testing::kBegin;

double milliseconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

void print_times(std::string_view what, std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const auto share = [&](double of) { return ms[static_cast<size_t>(of * (ms.size() - 1.0))]; };
  fmt::print("{:44} {:5} times: p50 {:7.3f} ms, p99 {:7.3f} ms, max {:7.3f} ms\n", what, ms.size(),
             share(0.5), share(0.99), ms.back());
}

Obstacle random_box(std::mt19937& random, double size_m) {
  std::uniform_real_distribution<double> place(-4.5, 4.5);
  Obstacle box;
  const double x = place(random);
  const double y = place(random);
  box.pose_world_obstacle = {x, y, place(random)};
  box.size_m = {size_m, 0.5 * size_m};
  return box;
}

void measure_window() {
  std::mt19937 random(1);
  ObstacleMap map = ObstacleMap::create({}, {}).value();
  std::vector<Obstacle> boxes;
  for (int i = 0; i < 30; ++i) {
    boxes.push_back(random_box(random, 0.6));
    map.set(testing::thing_id(std::to_string(i)), boxes.back());
  }
  map.update();
  std::vector<double> window;
  std::vector<double> whole;
  for (int i = 0; i < 3000; ++i) {
    const Obstacle box = random_box(random, 0.6);
    boxes[static_cast<size_t>(i % 30)] = box;
    window.push_back(milliseconds_of([&] {
      map.set(testing::thing_id(std::to_string(i % 30)), box);
      map.update();
    }));
    whole.push_back(milliseconds_of([&] {
      ObstacleMap made = ObstacleMap::create({}, {}).value();
      for (size_t j = 0; j < boxes.size(); ++j)
        made.set(testing::thing_id(std::to_string(j)), boxes[j]);
      ENGRAM_CHECK(!made.update().empty(), "no map");
    }));
  }
  print_times("map: the window of one moved object", window);
  print_times("map: all of it anew", whole);
}

void measure_chain(const std::filesystem::path& store) {
  const auto memory = Memory::open(store).value();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-4.5, 4.5);
  ltm::Commit first{{testing::class_of("chair", "box", 0.5, 0.5, 0.9)}};
  const auto chair = [&](int i, Time time) {
    const double x = place(random);
    const double y = place(random);
    return testing::thing_at("chair_" + std::to_string(i), "chair", {x, y, place(random)}, 0.45,
                             time);
  };
  for (int i = 0; i < 30; ++i) first.updates.push_back(chair(i, kBegin));
  ENGRAM_CHECK(memory->commit(first).ok(), "not committed");
  const auto provider = CostMapProvider::start(*memory, {}).value();
  const auto feed = MapFeed::open(*memory, MapRules{}.entity()).value();
  std::vector<double> chain;
  std::vector<double> check;
  for (int i = 1; i <= 3000; ++i) {
    const Time time = kBegin + std::chrono::milliseconds(50 * i);
    const ltm::Commit commit{{chair(i % 30, time)}};
    chain.push_back(milliseconds_of([&] {
      ENGRAM_CHECK(memory->commit(commit, CommitDurability::kMemory).ok(), "not committed");
      ENGRAM_CHECK(feed->wait_for(time, std::chrono::seconds(10)), "no map");
    }));
    if (i % 10 == 0)
      check.push_back(milliseconds_of(
          [&] { ENGRAM_CHECK(check_map(*memory, *feed->latest(), {}).ok(), "stale"); }));
  }
  print_times("object commit -> map that a robot was told of", chain);
  print_times("check of a map against 30 objects", check);
}

void measure_plans() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-4.5, 4.5);
  for (const uint32_t tries : {1U, 2U, 4U, 8U, 16U, 64U}) {
    random.seed(3);
    const PathPlanner planner = PathPlanner::create({.tries = tries}).value();
    std::vector<double> ms;
    double length_m = 0;
    while (ms.size() < 60) {
      ObstacleMap made = ObstacleMap::create({}, {}).value();
      for (int i = 0; i < 25; ++i)
        made.set(testing::thing_id(std::to_string(i)), random_box(random, 0.8));
      CostMap map;
      map.frame = made.frame();
      map.costs = made.update();
      map.inscribed_m = made.rules().inscribed_m();
      const PlanarPose start{place(random), place(random), 0};
      const PlanarPose goal{place(random), place(random), 0};
      FoundPath path;
      const double took = milliseconds_of([&] { path = planner.plan(map, start, goal); });
      // Nothing is searched for a straight way.
      if (path.path.size() <= 2) continue;
      ms.push_back(took);
      length_m += path.length_m;
    }
    print_times(fmt::format("plan by {} tries", tries), ms);
    fmt::print("{:44} mean length {:.2f} m\n", "", length_m / 60);
  }
}

}  // namespace
}  // namespace engram::navigation

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: {} FOLDER\n", argv[0]);
    return 2;
  }
  engram::navigation::measure_window();
  engram::navigation::measure_chain(std::filesystem::path(argv[1]) / "speed.engram");
  engram::navigation::measure_plans();
  return 0;
}
