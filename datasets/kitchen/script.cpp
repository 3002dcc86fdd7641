// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/script.h"

#include <fmt/format.h>

#include <array>

namespace engram::datasets::kitchen {

namespace {

constexpr size_t kNever = ~size_t{0};
constexpr uint64_t kStream = 1'000'003;  // Separates these random numbers from the layout's.

std::string words_for(const Task& task, const Layout& layout, Random& random) {
  const std::string_view name = layout.things[task.thing].type->spoken_name;
  const std::string_view to = place_of(task.to).spoken_name;
  switch (random.below(4)) {
    case 0:
      return fmt::format("Please bring the {} to {}.", name, to);
    case 1:
      return fmt::format("Put the {} on {}, please.", name, to);
    case 2:
      return fmt::format("Can you move the {} over to {}?", name, to);
    default:
      return fmt::format("I need the {} on {}.", name, to);
  }
}

}  // namespace

Script::Script(const Layout& layout) : layout_(layout), random_(layout.seed + kStream) {
  for (const Thing& thing : layout.things) standing_.push_back({thing.surface, thing.slot});
  fault_at_ = random_.chance(0.7) ? random_.below(2) : kNever;
  stop_at_ = random_.chance(0.5) ? 1 + random_.below(2) : kNever;
}

std::vector<int> Script::free_slots(Surface surface) const {
  std::array<bool, kSlots> is_taken{};
  for (const Standing& one : standing_)
    if (one.surface == surface) is_taken.at(static_cast<size_t>(one.slot)) = true;
  std::vector<int> free;
  for (int slot = 0; slot < kSlots; ++slot)
    if (!is_taken.at(static_cast<size_t>(slot))) free.push_back(slot);
  return free;
}

std::optional<Task> Script::next() {
  std::vector<size_t> candidates;
  for (size_t i = 0; i < standing_.size(); ++i)
    if (!standing_[i].is_lost && last_ != i && !free_slots(other(standing_[i].surface)).empty())
      candidates.push_back(i);
  if (candidates.empty()) return std::nullopt;
  Task task;
  task.thing = candidates[random_.below(candidates.size())];
  task.from = standing_[task.thing].surface;
  task.to = other(task.from);
  const std::vector<int> free = free_slots(task.to);
  task.slot = free[random_.below(free.size())];
  task.hand = random_.chance(0.65) ? Side::kRight : Side::kLeft;
  task.words = words_for(task, layout_, random_);
  if (count_ == fault_at_)
    task.fault = random_.chance(0.5) ? GraspFault::kShort : GraspFault::kSlip;
  task.is_stopped = count_ == stop_at_;
  ++count_;
  last_ = task.thing;
  return task;
}

void Script::done(const Task& task) {
  standing_[task.thing].surface = task.to;
  standing_[task.thing].slot = task.slot;
}

void Script::lose(size_t thing) {
  standing_[thing].is_lost = true;
}

}  // namespace engram::datasets::kitchen
