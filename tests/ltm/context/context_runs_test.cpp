// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/context_runs.h"

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "ltm/context/meet_conditions.h"
#include "ltm/context/view_planes.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using Sighting = where::InView::Sighting;
using Row = std::array<double, 3>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class RunDraws {
 public:
  explicit RunDraws(uint32_t seed) : random_(seed) {}
  double any(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  size_t below(size_t count) {
    return std::uniform_int_distribution<size_t>(0, count - 1)(random_);
  }
  double step(double size) { return std::normal_distribution<double>(0, size)(random_); }

 private:
  std::mt19937 random_;
};

TEST(RunBounds, HoldForAllRowsOfARange) {
  RunDraws draws(1);
  for (const size_t count : {1U, 15U, 16U, 17U, 100U, 2'345U}) {
    RunBounds<3> bounds;
    std::vector<Row> rows;
    for (size_t i = 0; i < count; ++i) {
      rows.push_back({0.1 * static_cast<double>(i), draws.any(-1, 1), draws.any(-1e40, 1e40)});
      bounds.add(rows.back());
    }
    bounds.finish();
    EXPECT_EQ(bounds.rows(), count);
    for (int round = 0; round < 2'000; ++round) {
      const size_t begin = draws.below(count);
      const size_t end = begin + 1 + draws.below(count - begin);
      const auto of = bounds.of(begin, end);
      for (size_t i = begin; i < end; ++i)
        for (size_t k = 0; k < 3; ++k) {
          ASSERT_LE(static_cast<double>(of.low[k]), rows[i][k]);
          ASSERT_GE(static_cast<double>(of.high[k]), rows[i][k]);
        }
      // What is beside it is less than the range, or two runs.
      const double beside = std::max(32.0, static_cast<double>(end - begin));
      ASSERT_GE(of.low[0], 0.1 * (static_cast<double>(begin) - beside) - 0.01);
      ASSERT_LE(of.high[0], 0.1 * (static_cast<double>(end) + beside) + 0.01);
    }
  }
}

TEST(RunBounds, BoundNothingWhereANumberIsNoNumber) {
  for (const double odd : {kNan, kInfinity, -kInfinity, 1e300}) {
    RunBounds<3> bounds;
    for (int i = 0; i < 40; ++i) bounds.add({1, i == 20 ? odd : 2, 3});
    bounds.finish();
    const auto of = bounds.of(16, 32);
    EXPECT_EQ(of.low[0], 1);
    EXPECT_TRUE(std::isinf(of.low[1]) || std::isinf(of.high[1])) << odd;
    EXPECT_EQ(bounds.of(0, 16).high[1], 2);
  }
}

/// A camera with two eyes that turns and moves, things that wander, and links between them.
class RunWorld final : public KnownContexts {
 public:
  RunWorld(uint32_t seed, bool has_runs) : draws_(seed), swing_(draws_.any(0, 0.02)) {
    constexpr size_t kImages = 700;
    EntityContext camera;
    camera.frames = {"world"};
    camera.intrinsics = {{300, 300, 160, 120, 320, 240}};
    camera.targets = {id("calibration")};
    const bool links_to_lens = draws_.below(2) == 0;
    for (size_t i = 0; i < kImages; ++i) {
      camera.times.push_back(time_from_ns(static_cast<int64_t>(i) * 50));
      for (int32_t eye = 0; eye < 2; ++eye) add_eye(i, eye, links_to_lens, camera);
    }
    for (const char* name : {"free", "linked"}) {
      const auto thing = std::make_shared<EntityContext>();
      thing->frames = {"", "world"};
      thing->targets = {id("camera")};
      add_moments(kImages, std::string_view(name) == "linked", *thing);
      if (has_runs) thing->find_runs();
      contexts_[id(name)] = thing;
    }
    if (has_runs) camera.find_runs();
    contexts_[id("camera")] = std::make_shared<const EntityContext>(std::move(camera));
  }

  static MemoryId id(const std::string& name) {
    return *MemoryId::from_names({"a", "b", "c", name});
  }

  Result<std::shared_ptr<const EntityContext>> of(const MemoryId& entity) override {
    return contexts_.at(entity);
  }
  Result<std::optional<Intrinsics>> intrinsics(const MemoryId& /*link*/) override {
    return std::optional(Intrinsics{300, 300, 160, 120, 320, 240});
  }
  Result<bool> has_depths(const MemoryId& /*camera*/) override { return true; }
  Result<std::optional<bool>> is_hidden(const MemoryId& /*image*/, double x, double /*y*/,
                                        double /*z*/) override {
    return std::optional(x < 0.2);
  }

 private:
  void add_eye(size_t image, int32_t eye, bool links_to_lens, EntityContext& camera) {
    const double angle = swing_ * static_cast<double>(image);
    auto& to = camera.cameras;
    to.snapshot.push_back(static_cast<uint32_t>(image));
    to.instance.push_back(eye);
    to.frame.push_back(0);
    for (const double x : {0.1 * eye + 0.5 * std::sin(angle), 0.0, -3.0}) to.position.push_back(x);
    // One that is not normalised, sometimes.
    const double length = image % 400 == 399 ? 1.5 : 1;
    for (const double x : {std::cos(angle / 2), 0.0, std::sin(angle / 2), 0.0})
      to.orientation.push_back(length * x);
    to.calibration.push_back(links_to_lens ? static_cast<int32_t>(camera.links.size()) : -1);
    if (!links_to_lens) return;
    camera.links.snapshot.push_back(static_cast<uint32_t>(image));
    camera.links.instance.push_back(eye);
    camera.links.target.push_back(0);
    camera.links.time.push_back(7);
    camera.links.index.push_back(0);
  }

  void add_moments(size_t images, bool is_linked, EntityContext& thing) {
    const double size = draws_.below(2) == 0 ? 0.002 : 0.05;
    Row at{draws_.any(-1, 1), draws_.any(-1, 1), draws_.any(-1, 1)};
    const bool tells = draws_.below(2) == 0;
    const size_t each = 1 + draws_.below(2);
    for (size_t i = 0; i < 4 * images; ++i) {
      const auto snapshot = static_cast<uint32_t>(i);
      // Some are before the first image, and some have the time of one.
      thing.times.push_back(time_from_ns(static_cast<int64_t>(i) * 13 - 130));
      for (double& x : at) x = std::clamp(x + draws_.step(size), -2.0, 2.0);
      if (i % 997 == 996) at = {draws_.any(-2, 2), draws_.any(-2, 2), draws_.any(-9, 2)};
      for (size_t k = 0; k < each; ++k) {
        thing.places.snapshot.push_back(snapshot);
        thing.places.frame.push_back(1);
        for (const double x : at)
          thing.places.position.push_back(x + 0.01 * static_cast<double>(k));
      }
      if (tells)
        thing.visibility.push_back(
            static_cast<EntityContext::Visibility>(static_cast<int>(draws_.below(3)) - 1));
      if (!is_linked) continue;
      thing.links.snapshot.push_back(snapshot);
      thing.links.instance.push_back(0);
      thing.links.target.push_back(0);
      thing.links.time.push_back(static_cast<int64_t>(std::min(i / 4, images - 1)) * 50);
      thing.links.index.push_back(static_cast<int32_t>(draws_.below(2)));
    }
  }

  RunDraws draws_;
  const double swing_;  ///< Unit: rad an image.
  std::map<MemoryId, std::shared_ptr<const EntityContext>> contexts_;
};

TEST(GlanceAtRun, IsSureOnlyOfWhatHoldsForEach) {
  RunDraws draws(5);
  size_t inside = 0;
  size_t outside = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Intrinsics lens{
        draws.any(100, 800), draws.any(100, 800), draws.any(0, 320), draws.any(0, 240), 320, 240};
    const double spread = std::pow(10, draws.any(-6, -0.5));
    const Eigen::Vector3d centre(draws.any(-3, 3), draws.any(-3, 3), draws.any(-3, 3));
    Eigen::Vector4d middle(draws.any(-1, 1), draws.any(-1, 1), draws.any(-1, 1), draws.any(-1, 1));
    EntityContext context;
    context.frames = {"world"};
    context.intrinsics = {lens};
    for (uint32_t i = 0; i < 16; ++i) {
      context.times.push_back(time_from_ns(i));
      context.places.snapshot.push_back(i);
      context.places.frame.push_back(0);
      context.cameras.snapshot.push_back(i);
      context.cameras.instance.push_back(0);
      context.cameras.frame.push_back(0);
      context.cameras.calibration.push_back(-1);
      for (int k = 0; k < 3; ++k) {
        context.places.position.push_back(centre[k] + draws.any(-spread, spread));
        context.cameras.position.push_back(draws.any(-spread, spread));
      }
      for (int k = 0; k < 4; ++k)
        context.cameras.orientation.push_back(middle[k] + draws.any(-spread, spread));
    }
    const ContextRuns runs(context);
    const Glance glance =
        glance_at_run(planes_of(lens), runs.cameras.of(0, 16), runs.places.of(0, 16));
    if (glance == Glance::kUnsure) continue;
    (glance == Glance::kInside ? inside : outside) += 1;
    for (size_t i = 0; i < 16; ++i) {
      const double* q = &context.cameras.orientation[4 * i];
      const double* p = &context.cameras.position[3 * i];
      const Eigen::Vector3d seen =
          Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().conjugate() *
          (Eigen::Vector3d(&context.places.position[3 * i]) - Eigen::Vector3d(p[0], p[1], p[2]));
      const double u = lens.fx * seen.x() / seen.z() + lens.cx;
      const double v = lens.fy * seen.y() / seen.z() + lens.cy;
      const bool is_in_image =
          seen.z() > 0 && u >= -0.5 && u < lens.width - 0.5 && v >= -0.5 && v < lens.height - 0.5;
      ASSERT_EQ(is_in_image, glance == Glance::kInside) << "round " << round;
    }
  }
  EXPECT_GT(inside, 500U);
  EXPECT_GT(outside, 10'000U);
}

TEST(ContextRuns, AnswerWhatEachSnapshotAloneAnswers) {
  size_t met = 0;
  size_t others = 0;
  for (uint32_t seed = 0; seed < 60; ++seed) {
    RunWorld with(seed, true);
    RunWorld without(seed, false);
    for (const char* asked : {"free", "linked", "camera"})
      for (const char* thing : {"free", "linked"})
        for (const Sighting sighting : {Sighting::kAny, Sighting::kSeen, Sighting::kInVain}) {
          const bool is_camera = std::string_view(asked) == "camera";
          if (!is_camera && std::string_view(asked) != thing) continue;
          const Condition condition{
              where::InView{RunWorld::id(is_camera ? thing : "camera"), sighting}};
          const MemoryId entity = RunWorld::id(asked);
          ASSERT_NE((*with.of(entity))->runs.found, nullptr);
          const auto told = moments_meeting(entity, {&condition, 1}, false, with);
          const auto needed = moments_meeting(entity, {&condition, 1}, false, without);
          ASSERT_OK(told);
          ASSERT_OK(needed);
          ASSERT_EQ(*told, *needed) << asked << ", seed " << seed << ", " << to_string(condition);
          met += needed->size();
          others += (*with.of(entity))->times.size() - needed->size();
        }
  }
  EXPECT_GT(met, 50'000U);
  EXPECT_GT(others, 50'000U);
}

TEST(ContextRuns, TellWhatIsNear) {
  RunDraws draws(2);
  size_t met = 0;
  for (uint32_t seed = 0; seed < 30; ++seed) {
    RunWorld with(seed, true);
    RunWorld without(seed, false);
    const MemoryId free = RunWorld::id("free");
    for (int round = 0; round < 20; ++round) {
      where::Near near;
      near.point = {draws.any(-2, 2), draws.any(-2, 2), draws.any(-2, 2)};
      near.frame = "world";
      near.metres = std::pow(10, draws.any(-2, 1));
      const Condition condition{near};
      const auto told = moments_meeting(free, {&condition, 1}, true, with);
      const auto needed = moments_meeting(free, {&condition, 1}, true, without);
      ASSERT_OK(told);
      ASSERT_OK(needed);
      ASSERT_EQ(*told, *needed) << "seed " << seed << ", " << to_string(condition);
      met += needed->size();
    }
  }
  EXPECT_GT(met, 100'000U);
}

TEST(ContextRuns, AreOfTheRowsThatTheyWereMadeOf) {
  RunWorld world(1, true);
  EntityContext context = **world.of(RunWorld::id("free"));
  EXPECT_TRUE(context.runs.found->is_of(context));
  context.places.snapshot.push_back(0);
  EXPECT_FALSE(context.runs.found->is_of(context));
  EntityContext few;
  few.find_runs();
  EXPECT_EQ(few.runs.found, nullptr);
}

}  // namespace
}  // namespace engram::ltm
