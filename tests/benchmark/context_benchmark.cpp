// SPDX-License-Identifier: Apache-2.0
// What conditions on place and context cost on a million snapshots, and what reading the index of
// them does.
#include <benchmark/benchmark.h>

#include <map>
#include <random>

#include "ltm/context/meet_conditions.h"
#include "ltm/context/stored_context.h"

namespace engram::ltm {
namespace {

constexpr int64_t kWorldStep = 10'000'000;  // 100 Hz.

MemoryId named_thing(const std::string& name) {
  return *MemoryId::from_names({"Objects", "Instances", "tracker", name});
}

/// Things that wander, or are anywhere; a camera that turns; actions.
class BenchmarkWorld final : public KnownContexts {
 public:
  BenchmarkWorld(size_t count, bool wanders) {
    for (const char* name : {"cup", "mug", "table", "camera", "pick"}) {
      auto context = std::make_shared<EntityContext>();
      context->frames = {"world"};
      contexts_[named_thing(name)] = context;
    }
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-2, 2);
    std::normal_distribution<double> step(0, 0.002);
    std::array<double, 3> at{};
    EntityContext& cup = *contexts_[named_thing("cup")];
    std::bernoulli_distribution is_visible(0.75);
    EntityContext& table = *contexts_[named_thing("table")];
    EntityContext& camera = *contexts_[named_thing("camera")];
    EntityContext& pick = *contexts_[named_thing("pick")];
    camera.intrinsics = {{600, 600, 320, 240, 640, 480}};
    for (size_t i = 0; i < count; ++i) {
      const auto row = static_cast<uint32_t>(i);
      const Time time = time_from_ns(static_cast<int64_t>(i) * kWorldStep);
      for (double& x : at) x = wanders ? std::clamp(x + step(random), -2.0, 2.0) : any(random);
      for (EntityContext* thing : {&cup, &table}) {
        thing->times.push_back(time);
        thing->places.snapshot.push_back(row);
        thing->places.frame.push_back(0);
        for (const double x : at)
          thing->places.position.push_back(thing == &cup ? x : wanders ? 0.5 : any(random));
        thing->visibility.push_back(is_visible(random) ? EntityContext::Visibility::kVisible
                                                       : EntityContext::Visibility::kHidden);
      }
      if (i % 5 == 0) {
        const double turned = static_cast<double>(i) * 1e-4;
        camera.times.push_back(time);
        camera.cameras.snapshot.push_back(row / 5);
        camera.cameras.instance.push_back(0);
        camera.cameras.frame.push_back(0);
        camera.cameras.calibration.push_back(-1);
        for (const double x : {0.0, 0.0, -3.0}) camera.cameras.position.push_back(x);
        for (const double x : {std::cos(turned), 0.0, std::sin(turned), 0.0})
          camera.cameras.orientation.push_back(x);
      }
      if (i % 1000 == 0) {
        pick.times.push_back(time);
        pick.spans.snapshot.push_back(row / 1000);
        pick.spans.started.push_back(to_ns(time));
        pick.spans.ended.push_back(to_ns(time) + 500 * kWorldStep);
      }
    }
    link_to_images(cup, camera, *contexts_[named_thing("mug")]);
    for (const auto& [id, context] : contexts_) context->find_runs();
  }

  Result<std::shared_ptr<const EntityContext>> of(const MemoryId& entity) override {
    return std::shared_ptr<const EntityContext>(contexts_.at(entity));
  }
  Result<std::optional<Intrinsics>> intrinsics(const MemoryId& /*link*/) override {
    return std::optional<Intrinsics>();
  }
  Result<bool> has_depths(const MemoryId& /*camera*/) override { return false; }
  Result<std::optional<bool>> is_hidden(const MemoryId& /*image*/, double /*x*/, double /*y*/,
                                        double /*z*/) override {
    return std::optional<bool>();
  }

 private:
  /// The same thing, whose snapshots link to the images that they were found in.
  static void link_to_images(const EntityContext& thing, const EntityContext& camera,
                             EntityContext& linking) {
    linking = thing;
    linking.targets = {named_thing("camera")};
    for (uint32_t i = 0; i < thing.times.size(); ++i) {
      linking.links.snapshot.push_back(i);
      linking.links.instance.push_back(0);
      linking.links.target.push_back(0);
      linking.links.time.push_back(to_ns(camera.times[i / 5]));
      linking.links.index.push_back(0);
    }
  }

  std::map<MemoryId, std::shared_ptr<EntityContext>> contexts_;
};

BenchmarkWorld& million(bool wanders) {
  static BenchmarkWorld wandering(1'000'000, true);
  static BenchmarkWorld random(1'000'000, false);
  return wanders ? wandering : random;
}

/// Argument: whether things wander, as robots do, or are anywhere at any time.
void meet(benchmark::State& state, const Condition& condition, const char* asked = "cup") {
  BenchmarkWorld& world = million(state.range(0) != 0);
  const MemoryId entity = named_thing(asked);
  size_t met = 0;
  for (auto _ : state) {
    const auto times = moments_meeting(entity, {&condition, 1}, true, world);
    met = times->size();
    benchmark::DoNotOptimize(times);
  }
  state.counters["met"] = static_cast<double>(met);
  state.SetItemsProcessed(state.iterations() *
                          static_cast<int64_t>((*world.of(entity))->times.size()));
}

using Sighting = where::InView::Sighting;

void BM_Near(benchmark::State& state) {
  meet(state, {where::Near{{0.5, 0.5, 0.5}, 0.3}});
}
void BM_Within(benchmark::State& state) {
  meet(state, {where::Within{named_thing("table"), 0.3}});
}
void BM_InView(benchmark::State& state) {
  meet(state, {where::InView{named_thing("camera")}});
}
void BM_SeenWith(benchmark::State& state) {
  meet(state, {where::InView{named_thing("camera"), Sighting::kSeen}});
}
void BM_InVain(benchmark::State& state) {
  meet(state, {where::InView{named_thing("camera"), Sighting::kInVain}});
}
/// The snapshots link to images.
void BM_LinkedInView(benchmark::State& state) {
  meet(state, {where::InView{named_thing("camera")}}, "mug");
}
void BM_LinkedSeenWith(benchmark::State& state) {
  meet(state, {where::InView{named_thing("camera"), Sighting::kSeen}}, "mug");
}
/// The camera is asked, which has 200,000 images.
void BM_ImagesInView(benchmark::State& state) {
  meet(state, {where::InView{named_thing("cup")}}, "camera");
}
void BM_While(benchmark::State& state) {
  meet(state, {where::While{named_thing("pick")}});
}
BENCHMARK(BM_Near)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Within)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_InView)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_SeenWith)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_InVain)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_LinkedInView)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_LinkedSeenWith)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_ImagesInView)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_While)->Arg(1)->Unit(benchmark::kMillisecond);

/// Argument: as above.
void BM_UnpackContext(benchmark::State& state) {
  const auto context = *million(state.range(0) != 0).of(named_thing("cup"));
  const auto bytes = pack_contexts({{named_thing("cup"), *context}});
  for (auto _ : state) benchmark::DoNotOptimize(unpack_context(bytes, named_thing("cup")));
  state.counters["bytes_per_snapshot"] = static_cast<double>(bytes.size()) / 1e6;
}
BENCHMARK(BM_UnpackContext)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::ltm
