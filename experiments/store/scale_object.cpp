// SPDX-License-Identifier: Apache-2.0
#include "store/scale_object.h"

#include <cmath>
#include <vector>

namespace engram::experiments {

namespace {

// 2022-02-18 13:06:56 UTC.
constexpr int64_t kStartNs = 1645189616000000000;

/// The noise of a tracker; equal arguments give equal numbers. Unit: mm.
double noise(uint64_t step, int entity, int axis) {
  uint64_t bits = step * 0x9e3779b97f4a7c15 + static_cast<uint64_t>(entity * 3 + axis);
  bits ^= bits >> 29;
  bits *= 0xbf58476d1ce4e5b9;
  return static_cast<double>((bits >> 40) & 0xff) / 256;
}

std::vector<ltm::MemoryId> make_ids() {
  std::vector<ltm::MemoryId> ids;
  for (int i = 0; i < ScaleWorld::kMaxEntities; ++i)
    ids.push_back(
        ltm::MemoryId::parse(fmt::format("Scene/Objects/tracker/object_{:02}", i)).value());
  return ids;
}

}  // namespace

Time ScaleWorld::time_of(uint64_t step) {
  return time_from_ns(kStartNs + static_cast<int64_t>(step) * kStepNs);
}

ltm::MemoryId ScaleWorld::entity(int number) const {
  static const std::vector<ltm::MemoryId> ids = make_ids();
  return ids.at(static_cast<size_t>(number));
}

idf::Data ScaleWorld::value(int entity, uint64_t step) {
  const double phase = 1e-3 * static_cast<double>(step) + entity;
  return idf::Dict{{"x", 1000 * std::cos(phase) + noise(step, entity, 0)},
                   {"y", 1000 * std::sin(phase) + noise(step, entity, 1)},
                   {"z", 50.0 * entity + noise(step, entity, 2)},
                   {"step", static_cast<int64_t>(step)},
                   {"visible", step % 64 != static_cast<uint64_t>(entity)}};
}

ltm::Commit ScaleWorld::commit(uint64_t step) const {
  ltm::Commit commit;
  for (int i = 0; i < entities; ++i)
    commit.updates.push_back({entity(i), time_of(step), {{value(i, step), {}}}});
  return commit;
}

}  // namespace engram::experiments
