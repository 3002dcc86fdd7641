// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A made-up world of things, a camera and actions, and answers of brute force to conditions on it.
class SmallWorld {
 public:
  using Point = std::array<double, 3>;

  struct Thing {
    Time time{};
    Point at{};
    bool is_visible = false;
    int64_t image_ns = 0;  ///< Of the image that it links to.
    int32_t image_index = 0;
  };
  struct Look {
    Time time{};
    std::array<Point, 2> at{};       ///< Of both instances.
    std::array<double, 2> turned{};  ///< About the y axis of the world. Unit: rad.
  };
  struct Action {
    Time started{};
    Time ended{};
    bool has_end = true;
    Time object_ns{};  ///< The time of the thing that it links to.
  };

  static MemoryId thing(int i) { return named("Objects", "thing_" + std::to_string(i)); }
  static MemoryId camera() { return named("Vision", "camera"); }
  static MemoryId calibration() { return named("Vision", "calibration"); }
  static MemoryId action() { return named("Skills", "pick"); }

  explicit SmallWorld(uint32_t seed, int snapshots) : random_(seed) {
    things.resize(2);
    for (int64_t i = 0; i < snapshots; ++i) {
      Look look{example_time(i), {point(), point()}, {angle(), angle()}};
      looks.push_back(look);
      for (auto& each : things) {
        if (chance(0.3)) continue;
        // Somewhat later than the image that it was found in.
        each.push_back({example_time(i) + Duration(chance(0.5) ? 7 : 0), point(), chance(0.5),
                        to_ns(example_time(chance(0.2) ? std::max<int64_t>(i - 1, 0) : i)),
                        chance(0.5) ? 1 : 0});
      }
      if (i % 10 == 3)
        actions.push_back({example_time(i), example_time(i + 2 + (chance(0.3) ? 11 : 2)),
                           chance(0.8), things[0].empty() ? Time{} : things[0].back().time});
    }
  }

  /// Everything as snapshots, in the order of time.
  [[nodiscard]] std::vector<Snapshot> snapshots() const {
    std::vector<Snapshot> all;
    all.push_back({calibration(), example_time(-1), {{intrinsics(), {}}}});
    for (const Look& look : looks) {
      Snapshot snapshot{camera(), look.time, {}};
      for (size_t k = 0; k < 2; ++k)
        snapshot.instances.push_back(
            {idf::Dict{
                 {"pose_world_camera", pose(look.at[k], look.turned[k])},
                 {"calibration", calibration().to_string()},
                 {"calibration_now", calibration().at(example_time(-1)).instance(0).to_string()}},
             {}});
      all.push_back(std::move(snapshot));
    }
    for (size_t t = 0; t < things.size(); ++t)
      for (const Thing& one : things[t])
        all.push_back(
            {thing(static_cast<int>(t)),
             one.time,
             {{idf::Dict{
                   {"pose_world_object", pose(one.at, 0)},
                   {"is_visible", one.is_visible},
                   {"image",
                    camera().at(time_from_ns(one.image_ns)).instance(one.image_index).to_string()}},
               {}}}});
    for (const Action& one : actions) {
      idf::Dict value{{"started", to_ns(one.started)}, {"ended", idf::Data(idf::None())}};
      if (one.object_ns != Time{}) value.set("object", thing(0).at(one.object_ns).to_string());
      all.push_back({action(), one.started, {{value, {}}}});
      if (!one.has_end) continue;
      value.set("ended", to_ns(one.ended));
      all.push_back({action(), one.ended + Duration(1), {{value, {}}}});
    }
    std::ranges::stable_sort(all, {}, &Snapshot::time);
    return all;
  }

  [[nodiscard]] static double distance(const Point& a, const Point& b) {
    return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) +
                     std::pow(a[2] - b[2], 2));
  }

  /// Whether one of the cameras of a look has a point in its image; `only` is the instance, or -1.
  [[nodiscard]] bool sees(const Look& look, const Point& at, int32_t only = -1) const {
    for (size_t k = 0; k < 2; ++k) {
      if (only >= 0 && static_cast<size_t>(only) != k) continue;
      // The camera looks along the z axis, turned about y: the inverse takes the world to it.
      const double c = std::cos(look.turned[k]);
      const double s = std::sin(look.turned[k]);
      const double dx = at[0] - look.at[k][0];
      const double dy = at[1] - look.at[k][1];
      const double dz = at[2] - look.at[k][2];
      const double x = c * dx - s * dz;
      const double z = s * dx + c * dz;
      if (z <= 0) continue;
      const double u = kFocal * x / z + kWidth / 2;
      const double v = kFocal * dy / z + kHeight / 2;
      if (u >= -0.5 && u < kWidth - 0.5 && v >= -0.5 && v < kHeight - 0.5) return true;
    }
    return false;
  }

  /// The last one of `all` until a time; null if there is none.
  template <typename T>
  [[nodiscard]] static const T* last_until(const std::vector<T>& all, Time time) {
    const T* last = nullptr;
    for (const T& one : all)
      if (one.time <= time) last = &one;
    return last;
  }

  [[nodiscard]] bool is_acting(Time time) const {
    for (size_t i = 0; i < actions.size(); ++i) {
      const Action& one = actions[i];
      const bool is_next = i + 1 < actions.size();
      const Time end = one.has_end ? one.ended
                       : is_next   ? actions[i + 1].started - Duration(1)
                                   : Time::max();
      if (one.started <= time && time <= end) return true;
    }
    return false;
  }

  Point point() { return {any_(random_), any_(random_), any_(random_)}; }
  double angle() { return any_(random_) * 2; }
  bool chance(double share) { return std::bernoulli_distribution(share)(random_); }
  size_t below(size_t end) { return std::uniform_int_distribution<size_t>(0, end - 1)(random_); }

  std::vector<std::vector<Thing>> things;
  std::vector<Look> looks;
  std::vector<Action> actions;

 private:
  static constexpr double kFocal = 40, kWidth = 64, kHeight = 48;

  static MemoryId named(const std::string& memory, const std::string& entity) {
    return *MemoryId::from_names({memory, "core", "provider", entity});
  }
  static idf::Data pose(const Point& at, double turned) {
    return idf::Dict{{"position", idf::NdArray::take<double>({3}, {at[0], at[1], at[2]})},
                     {"orientation", idf::NdArray::take<double>(
                                         {4}, {std::cos(turned / 2), 0, std::sin(turned / 2), 0})}};
  }
  static idf::Data intrinsics() {
    return idf::Dict{{"fx", kFocal},
                     {"fy", kFocal},
                     {"cx", kWidth / 2},
                     {"cy", kHeight / 2},
                     {"width", static_cast<int32_t>(kWidth)},
                     {"height", static_cast<int32_t>(kHeight)}};
  }

  std::mt19937 random_;
  std::uniform_real_distribution<double> any_{-1, 1};
};

}  // namespace engram::ltm
