// SPDX-License-Identifier: Apache-2.0
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
using Visibility = EntityContext::Visibility;
using Point = Eigen::Vector3d;

MemoryId id_of(const std::string& name) {
  return *MemoryId::from_names({"a", "b", "c", name});
}

/// One camera of a snapshot.
struct TestEye {
  Eigen::Quaterniond orientation{1, 0, 0, 0};
  Point position{0, 0, 0};
  Intrinsics lens;
};

struct TestProjection {
  double u = 0, v = 0, z = 0;
  bool is_in_image = false;
};

/// What docs/query.md says of a camera, in doubles.
TestProjection project(const TestEye& eye, const Point& place) {
  TestProjection to;
  if (eye.orientation.squaredNorm() == 0) return to;
  const Eigen::Matrix3d to_camera = eye.orientation.normalized().conjugate().toRotationMatrix();
  const Point seen = to_camera * (place - eye.position);
  to.z = seen.z();
  if (to.z <= 0) return to;
  to.u = eye.lens.fx * seen.x() / seen.z() + eye.lens.cx;
  to.v = eye.lens.fy * seen.y() / seen.z() + eye.lens.cy;
  to.is_in_image =
      to.u >= -0.5 && to.u < eye.lens.width - 0.5 && to.v >= -0.5 && to.v < eye.lens.height - 0.5;
  return to;
}

/// Draws cameras of all kinds and places that are hard to tell.
class Draws {
 public:
  explicit Draws(uint32_t seed) : random_(seed) {}

  double any(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  size_t below(size_t count) {
    return std::uniform_int_distribution<size_t>(0, count - 1)(random_);
  }
  bool chance(double share) { return any(0, 1) < share; }
  double one_of(std::initializer_list<double> values) {
    return values.begin()[below(values.size())];
  }

  Point point(double size) { return {any(-size, size), any(-size, size), any(-size, size)}; }

  Intrinsics lens() {
    Intrinsics lens{any(50, 800), any(50, 800), any(0, 640), any(0, 480), 640, 480};
    if (chance(0.1)) lens.fx = -lens.fx;
    if (chance(0.1)) lens.cx = any(-2000, 2000);
    if (chance(0.05)) lens.width = one_of({0, -3, 1e-9, 1e12});
    if (chance(0.05)) lens.fy = one_of({0, 1e-9, 1e12});
    return lens;
  }

  TestEye eye() {
    TestEye eye;
    eye.lens = lens();
    eye.position = point(chance(0.2) ? 1e5 : 3);
    Eigen::Vector4d q(any(-1, 1), any(-1, 1), any(-1, 1), any(-1, 1));
    q.normalize();
    if (chance(0.2)) q *= one_of({0.6, 0.999, 1.5, 3, 1e-9, 1e-170, 1e9});
    if (chance(0.2)) q = Eigen::Vector4d::Unit(static_cast<Eigen::Index>(below(4)));
    if (chance(0.03)) q.setZero();
    eye.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    return eye;
  }

  /// Half of the places are at a side of the image, or some roundings from it.
  Point place(const TestEye& eye) {
    if (chance(0.03)) return eye.position;
    if (chance(0.03)) return point(one_of({1e-20, 1e17, 1e200}));
    if (chance(0.3)) return eye.position + point(4);
    const Intrinsics& lens = eye.lens;
    double u = any(-0.6, 1.1) * lens.width;
    double v = any(-0.1, 1.1) * lens.height;
    if (chance(0.7)) u = one_of({-0.5, lens.width - 0.5});
    if (chance(0.3)) v = one_of({-0.5, lens.height - 0.5});
    const double z = one_of({-1, 1e-12, 1e-3, 1, 2.5, 4, 1e6});
    Point seen((u - lens.cx) * z / lens.fx, (v - lens.cy) * z / lens.fy, z);
    if (chance(0.5)) seen *= 1 + one_of({-1e-7, -1e-15, 1e-15, 1e-7});
    if (chance(0.5)) seen[0] *= 1 + one_of({-1e-6, -1e-15, 1e-15, 1e-6});
    const Point at = eye.position + eye.orientation.normalized().toRotationMatrix() * seen;
    return at.allFinite() ? at : Point(0, 0, 0);
  }

 private:
  std::mt19937 random_;
};

TEST(ViewPlanes, AreSureOnlyOfWhatTheProjectionSays) {
  Draws draws(1);
  std::map<Glance, size_t> glances;
  for (int round = 0; round < 300'000; ++round) {
    const TestEye eye = draws.eye();
    const Point place = draws.place(eye);
    const Eigen::Quaterniond& q = eye.orientation;
    const std::array<double, 4> orientation{q.w(), q.x(), q.y(), q.z()};
    const ViewPlanes view = turned(planes_of(eye.lens), eye.position.data(), orientation.data());
    const Glance glance = glance_at(view, place.data());
    ++glances[glance];
    if (glance == Glance::kUnsure) continue;
    ASSERT_EQ(glance == Glance::kInside, project(eye, place).is_in_image)
        << round << ": " << place.transpose() << " from " << eye.position.transpose();
  }
  for (const Glance glance : {Glance::kOutside, Glance::kInside, Glance::kUnsure})
    EXPECT_GT(glances[glance], 10'000);
}

TEST(ViewPlanes, AreSureOfPlacesThatAreAnywhere) {
  Draws draws(2);
  size_t unsure = 0;
  for (int round = 0; round < 100'000; ++round) {
    TestEye eye = draws.eye();
    eye.lens = {600, 600, 320, 240, 640, 480};
    const Eigen::Quaterniond q = Eigen::Quaterniond::UnitRandom();
    const std::array<double, 4> orientation{q.w(), q.x(), q.y(), q.z()};
    const ViewPlanes view = turned(planes_of(eye.lens), eye.position.data(), orientation.data());
    const Point place = eye.position + draws.point(4);
    if (glance_at(view, place.data()) == Glance::kUnsure) ++unsure;
  }
  EXPECT_LT(unsure, 20);
}

/// A camera and a thing whose snapshots are of all kinds, as plain lists.
class ViewWorld final : public KnownContexts {
 public:
  struct Place {
    uint32_t frame = 0;
    Point at;
  };
  struct Image {
    int64_t instance = 0;  ///< Of the value.
    uint32_t frame = 0;
    TestEye eye;
    bool has_lens = true;
  };
  struct Link {
    bool is_to_camera = false;
    int64_t time = 0;
    int32_t index = 0;
  };
  struct ThingMoment {
    int64_t time = 0;
    std::vector<Place> places;
    std::vector<Link> links;
    Visibility told = Visibility::kUntold;
  };
  struct CameraMoment {
    int64_t time = 0;
    std::vector<Image> images;
  };

  ViewWorld(uint32_t seed, bool has_links) : draws_(seed) {
    hides_ = draws_.chance(0.5);
    const bool tells = draws_.chance(0.7);
    draw_cameras();
    draw_things(has_links, tells);
    fill(tells);
  }

  Result<std::shared_ptr<const EntityContext>> of(const MemoryId& entity) override {
    return std::shared_ptr<const EntityContext>(contexts_.at(entity));
  }
  Result<std::optional<Intrinsics>> intrinsics(const MemoryId& link) override {
    const auto found = linked_lenses_.find(link);
    return found == linked_lenses_.end() ? std::nullopt : std::optional(found->second);
  }
  Result<bool> has_depths(const MemoryId& camera) override {
    return hides_ && camera == id_of("camera");
  }
  Result<std::optional<bool>> is_hidden(const MemoryId& image, double x, double y,
                                        double z) override {
    return blocked(to_ns(*image.time()), *image.index(), x, y, z);
  }

  /// Which snapshots brute force finds: of the camera, or of the thing.
  [[nodiscard]] std::vector<Time> expected(bool is_camera, Sighting sighting) const {
    std::vector<Time> times;
    if (is_camera) {
      for (const CameraMoment& camera : cameras) {
        const ThingMoment* then = last_until(things, camera.time);
        if (then != nullptr && holds(camera, *then, sighting))
          times.push_back(time_from_ns(camera.time));
      }
      return times;
    }
    for (const ThingMoment& thing : things) {
      const CameraMoment* camera = nullptr;
      for (const Link& link : thing.links)
        for (const CameraMoment& one : cameras)
          if (camera == nullptr && link.is_to_camera && link.time == one.time) camera = &one;
      if (camera == nullptr) camera = last_until(cameras, thing.time);
      if (camera != nullptr && holds(*camera, thing, sighting))
        times.push_back(time_from_ns(thing.time));
    }
    return times;
  }

  std::vector<CameraMoment> cameras;
  std::vector<ThingMoment> things;

 private:
  static constexpr uint32_t kFrames = 3;
  static constexpr int64_t kStep = 400'000'000;

  void draw_cameras() {
    const bool is_steady = draws_.chance(0.3);
    const Intrinsics steady = draws_.lens();
    for (int64_t i = 0; i < 30; ++i) {
      CameraMoment& moment = cameras.emplace_back();
      moment.time = i * kStep + 3;
      const size_t count = draws_.chance(0.1) ? 0 : draws_.chance(0.3) ? 2 : 1;
      for (size_t k = 0; k < count; ++k) {
        Image image{static_cast<int64_t>(k), draws_.chance(0.8) ? 0U : 1U, draws_.eye(),
                    draws_.chance(0.95)};
        if (is_steady) image.eye.lens = steady;
        moment.images.push_back(image);
      }
    }
  }

  void draw_things(bool has_links, bool tells) {
    for (int64_t i = 0; i < 60; ++i) {
      ThingMoment& moment = things.emplace_back();
      moment.time = i * kStep / 2 - kStep + static_cast<int64_t>(draws_.below(7));
      const CameraMoment* camera = last_until(cameras, moment.time);
      const size_t count = draws_.chance(0.1) ? 0 : draws_.chance(0.2) ? 2 : 1;
      for (size_t k = 0; k < count; ++k) {
        const bool is_near = camera != nullptr && !camera->images.empty();
        const Point at = is_near
                             ? draws_.place(camera->images[draws_.below(camera->images.size())].eye)
                             : draws_.point(3);
        moment.places.push_back({draws_.chance(0.8) ? 0U : 1U, at});
      }
      if (tells) moment.told = static_cast<Visibility>(static_cast<int>(draws_.below(3)) - 1);
      while (has_links && draws_.chance(0.4)) {
        const CameraMoment& image = cameras[draws_.below(cameras.size())];
        moment.links.push_back({draws_.chance(0.8),
                                draws_.chance(0.1) ? image.time + 1 : image.time,
                                draws_.chance(0.5) ? EntityContext::Links::kNoInstance
                                                   : static_cast<int32_t>(draws_.below(2))});
      }
    }
  }

  void fill(bool tells) {
    EntityContext camera;
    camera.frames = {"world", "map", ""};
    camera.targets = {id_of("calibration")};
    for (uint32_t i = 0; i < cameras.size(); ++i) {
      camera.times.push_back(time_from_ns(cameras[i].time));
      for (const Image& image : cameras[i].images) add_image(i, image, camera);
    }
    EntityContext thing;
    thing.frames = {"", "world", "map"};
    thing.targets = {id_of("else"), id_of("camera")};
    for (uint32_t i = 0; i < things.size(); ++i) {
      thing.times.push_back(time_from_ns(things[i].time));
      if (tells) thing.visibility.push_back(things[i].told);
      for (const Place& place : things[i].places) {
        thing.places.snapshot.push_back(i);
        thing.places.frame.push_back(place.frame + 1);
        thing.places.position.insert(thing.places.position.end(), place.at.data(),
                                     place.at.data() + 3);
      }
      for (const Link& link : things[i].links) {
        thing.links.snapshot.push_back(i);
        thing.links.instance.push_back(0);
        thing.links.target.push_back(link.is_to_camera ? 1 : 0);
        thing.links.time.push_back(link.time);
        thing.links.index.push_back(link.index);
      }
    }
    contexts_[id_of("camera")] = std::make_shared<EntityContext>(std::move(camera));
    contexts_[id_of("thing")] = std::make_shared<EntityContext>(std::move(thing));
  }

  void add_image(uint32_t snapshot, const Image& image, EntityContext& camera) {
    auto& to = camera.cameras;
    to.snapshot.push_back(snapshot);
    to.instance.push_back(static_cast<int32_t>(image.instance));
    to.frame.push_back(image.frame);
    const Eigen::Quaterniond& q = image.eye.orientation;
    to.position.insert(to.position.end(), image.eye.position.data(), image.eye.position.data() + 3);
    to.orientation.insert(to.orientation.end(), {q.w(), q.x(), q.y(), q.z()});
    if (image.has_lens && draws_.chance(0.5)) {
      to.calibration.push_back(-1 - static_cast<int32_t>(camera.intrinsics.size()));
      camera.intrinsics.push_back(image.eye.lens);
      return;
    }
    const auto row = static_cast<int32_t>(camera.links.size());
    to.calibration.push_back(row);
    camera.links.snapshot.push_back(snapshot);
    camera.links.instance.push_back(static_cast<int32_t>(image.instance));
    camera.links.target.push_back(0);
    camera.links.time.push_back(row);
    camera.links.index.push_back(EntityContext::Links::kNoInstance);
    if (image.has_lens) linked_lenses_[id_of("calibration").at(time_from_ns(row))] = image.eye.lens;
  }

  template <typename T>
  static const T* last_until(const std::vector<T>& all, int64_t time) {
    const T* last = nullptr;
    for (const T& one : all)
      if (one.time <= time) last = &one;
    return last;
  }

  [[nodiscard]] bool was_seen(const CameraMoment& camera, const ThingMoment& thing) const {
    if (thing.told != Visibility::kUntold) return thing.told == Visibility::kVisible;
    for (const ThingMoment& one : things)
      for (const Link& link : one.links)
        if (link.is_to_camera && std::abs(link.time - camera.time) <= 1'000'000'000) return true;
    return false;
  }

  /// Something is before some places, and of some nothing is known.
  [[nodiscard]] std::optional<bool> blocked(int64_t time, int64_t instance, double x, double y,
                                            double z) const {
    if (!hides_ || (time / kStep + instance) % 3 == 0) return std::nullopt;
    return static_cast<int64_t>(std::abs(x * 64)) % 2 != static_cast<int64_t>(y * 64) % 2 || z > 3;
  }

  [[nodiscard]] bool holds(const CameraMoment& camera, const ThingMoment& thing,
                           Sighting sighting) const {
    if (sighting != Sighting::kAny && was_seen(camera, thing) != (sighting == Sighting::kSeen))
      return false;
    const bool names_any = std::ranges::any_of(thing.links, [](const Link& link) {
      return link.is_to_camera && link.index != EntityContext::Links::kNoInstance;
    });
    for (const Image& image : camera.images) {
      const bool is_named = std::ranges::any_of(thing.links, [&](const Link& link) {
        return link.is_to_camera && link.index == image.instance;
      });
      if (!image.has_lens || (sighting != Sighting::kAny && names_any && !is_named)) continue;
      for (const Place& place : thing.places) {
        if (place.frame != image.frame) continue;
        const TestProjection at = project(image.eye, place.at);
        if (!at.is_in_image) continue;
        const Intrinsics& lens = image.eye.lens;
        if (sighting != Sighting::kInVain ||
            !blocked(camera.time, image.instance, (at.u + 0.5) / lens.width,
                     (at.v + 0.5) / lens.height, at.z)
                 .value_or(false))
          return true;
      }
    }
    return false;
  }

  Draws draws_;
  bool hides_ = false;  ///< There are depth images.
  std::map<MemoryId, std::shared_ptr<const EntityContext>> contexts_;
  std::map<MemoryId, Intrinsics> linked_lenses_;
};

TEST(MeetView, IsWhatBruteForceSays) {
  size_t found = 0;
  for (uint32_t seed = 0; seed < 600; ++seed) {
    ViewWorld world(seed, seed % 2 == 1);
    for (const bool is_camera : {false, true})
      for (const Sighting sighting : {Sighting::kAny, Sighting::kSeen, Sighting::kInVain}) {
        const Condition condition{where::InView{id_of(is_camera ? "thing" : "camera"), sighting}};
        // A thing that tells nothing of what was seen meets nothing, as it is not named.
        const auto times =
            moments_meeting(id_of(is_camera ? "camera" : "thing"), {&condition, 1}, false, world);
        ASSERT_OK(times);
        const auto& thing = **world.of(id_of("thing"));
        const bool tells = !thing.visibility.empty() ||
                           std::ranges::any_of(thing.links.target, [](auto t) { return t == 1; });
        const std::vector<Time> expected = sighting != Sighting::kAny && !tells
                                               ? std::vector<Time>()
                                               : world.expected(is_camera, sighting);
        ASSERT_EQ(*times, expected) << "seed " << seed << ", " << to_string(condition);
        found += expected.size();
      }
  }
  EXPECT_GT(found, 5'000);
}

TEST(MomentsMeeting, AreThoseThatMeetAllConditionsOrDoNot) {
  ViewWorld world(3, false);
  const auto ask = [&](std::vector<Condition> conditions) {
    const auto times = moments_meeting(id_of("thing"), conditions, false, world);
    EXPECT_OK(times);
    return *times;
  };
  const Condition in_view{where::InView{id_of("camera")}};
  const Condition out_of_view{where::InView{id_of("camera")}, true};
  std::vector<Time> both = ask({in_view});
  const std::vector<Time> others = ask({out_of_view});
  EXPECT_FALSE(both.empty());
  EXPECT_FALSE(others.empty());
  both.insert(both.end(), others.begin(), others.end());
  std::ranges::sort(both);
  EXPECT_EQ(both, ask({}));
  EXPECT_EQ(both.size(), world.things.size());
  EXPECT_TRUE(ask({in_view, out_of_view}).empty());
}

}  // namespace
}  // namespace engram::ltm
