// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "ltm/recording/recorder.h"
#include "ltm/reflection/reflect.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {

inline constexpr int64_t kArmStart_ns = 1'700'000'000'000'000'000;

/// An arm of three joints at 100 Hz that swings for 20 s, with a clock that is right, in a store.
class ExampleArm {
 public:
  static constexpr int kRows = 2000;

  /// Joint `j` at row `i`, and its velocity.
  static double position(int i, int j) { return std::sin(0.8 * 0.01 * i + j) * (0.5 + 0.1 * j); }
  static double velocity(int i, int j) {
    return 0.8 * std::cos(0.8 * 0.01 * i + j) * (0.5 + 0.1 * j);
  }

  ExampleArm() {
    for (int i = 0; i < kRows; ++i) {
      std::vector<double> positions, velocities;
      for (int j = 0; j < 3; ++j) {
        positions.push_back(position(i, j));
        velocities.push_back(velocity(i, j));
      }
      add(id(), arm_time(i),
          idf::Dict{{"positions", idf::NdArray::take<double>({3}, positions)},
                    {"velocities", idf::NdArray::take<double>({3}, velocities)}});
    }
  }

  static MemoryId id(const std::string& name = "Robot/State/arm/joints") {
    return MemoryId::parse(name).value();
  }
  static Time arm_time(int i) { return time_from_ns(kArmStart_ns + int64_t{10'000'000} * i); }

  void add(const MemoryId& entity, Time time, idf::Data value, Duration latency = {}) {
    InstanceMetadata metadata;
    metadata.created = metadata.sent = time;
    metadata.arrived = time + latency;
    updates.push_back({entity, time, {{std::move(value), std::move(metadata)}}});
  }

  /// Changes one joint of some rows of the arm.
  void change(int first, int last, int joint, const std::function<double(int, double)>& make,
              const char* member = "positions") {
    for (int i = first; i <= last; ++i) {
      idf::Data& place = *updates[static_cast<size_t>(i)].instances[0].data.at(member);
      const auto old = place.get<idf::NdArray>().values<double>();
      std::vector<double> values(old.begin(), old.end());
      values[static_cast<size_t>(joint)] = make(i, values[static_cast<size_t>(joint)]);
      place = idf::NdArray::take<double>({3}, std::move(values));
    }
  }

  [[nodiscard]] std::filesystem::path store() const { return scratch_ / "store"; }

  void write(const std::vector<std::pair<std::string, idf::Type>>& types = {}) {
    auto recorder = Recorder::open(store(), {});
    ASSERT_OK(recorder);
    for (const EntityUpdate& update : updates) ASSERT_OK(recorder->commit({{update}}));
    // Declared afterwards: a recorder would refuse what does not fit.
    for (const auto& [segment, type] : types)
      ASSERT_OK(recorder->declare(MemoryId::parse(segment).value(), type));
    ASSERT_OK(recorder->close());
  }

  /// Writes the store and reflects on it.
  Reflection reflect(const std::vector<std::pair<std::string, idf::Type>>& types = {},
                     const ReflectOptions& options = {}) {
    write(types);
    auto found = ltm::reflect(store(), options);
    EXPECT_OK(found);
    return found.value_or({});
  }

  std::vector<EntityUpdate> updates;

 private:
  ScratchDirectory scratch_;
};

/// The findings of a kind.
inline std::vector<ReflectionFinding> of_kind(const Reflection& reflection, ReflectionKind kind) {
  std::vector<ReflectionFinding> found;
  for (const ReflectionFinding& finding : reflection.findings)
    if (finding.kind == kind) found.push_back(finding);
  return found;
}

}  // namespace engram::ltm
