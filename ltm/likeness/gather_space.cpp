// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/gather_space.h"

#include <array>

#include <fmt/format.h>

#include "ltm/likeness/learn_space.h"
#include "ltm/likeness/seen_image.h"

namespace engram::ltm {

namespace {

constexpr size_t kMaxSamples = 3000;

/// What joints do is told by where they were: a hand that closes and one that opens look alike.
constexpr std::array<Duration, 3> kViewLags{Duration::zero(), std::chrono::milliseconds(400),
                                            std::chrono::seconds(1)};

/// Reads samples of one entity.
class Gathering {
 public:
  Gathering(KnownPast& past, const MemoryId& entity) : past_(past), entity_(entity) {}

  Status begin(std::span<const Time> times) {
    ENGRAM_ASSIGN_OR_RETURN(images_, past_.of(entity_));
    if (images_ == nullptr || times.empty())
      return failed_precondition("'{}': has no snapshots", entity_.to_string());
    ENGRAM_ASSIGN_OR_RETURN(const RecalledSnapshot example,
                            images_->read(times.back(), Prefer::kRecorded));
    ENGRAM_ASSIGN_OR_RETURN(space.views, linked_entities(past_, entity_, example.answer));
    for (const MemoryId& view : space.views) {
      ENGRAM_ASSIGN_OR_RETURN(auto linked, past_.of(view));
      views_.push_back(std::move(linked));
    }
    return {};
  }

  /// Leaves out moments without an image, or whose image has another size than the first one.
  Status add(Time time) {
    ENGRAM_ASSIGN_OR_RETURN(auto seen, see(*images_, time));
    if (!seen) return {};
    if (samples.times.empty()) space.size = seen->size;
    if (seen->size != space.size) return {};
    ENGRAM_ASSIGN_OR_RETURN(auto numbers, view_of(time));
    samples.times.push_back(time);
    samples.descriptors.push_back(std::move(seen->descriptor));
    samples.views.push_back(std::move(numbers));
    return {};
  }

  /// Cuts samples where `recordings` of all moments end.
  void cut(std::span<const Time> times, std::span<const Sequence> recordings) {
    size_t next = 0;
    for (const Sequence& recording : recordings) {
      Sequence own{next, next};
      while (own.end < samples.times.size() && samples.times[own.end] <= times[recording.end - 1])
        ++own.end;
      if (own.size() > 0) samples.recordings.push_back(own);
      next = own.end;
    }
    // Views of other lengths cannot be compared: then all go without.
    for (const auto& view : samples.views)
      if (view.size() != samples.views.front().size()) {
        samples.views.assign(samples.views.size(), {});
        space.views.clear();
        break;
      }
  }

  LikenessSamples samples;
  LikenessSpace space;

 private:
  Result<std::vector<double>> view_of(Time time) {
    std::vector<double> numbers;
    for (const auto& view : views_)
      for (const Duration lag : kViewLags) {
        ENGRAM_ASSIGN_OR_RETURN(auto then, numbers_at(*view, time - lag));
        // Nothing was known a second before the beginning: it was as it is.
        if (then.empty()) {
          ENGRAM_ASSIGN_OR_RETURN(then, numbers_at(*view, time));
        }
        numbers.insert(numbers.end(), then.begin(), then.end());
      }
    return numbers;
  }

  KnownPast& past_;
  const MemoryId& entity_;
  std::unique_ptr<EntityPast> images_;
  std::vector<std::unique_ptr<EntityPast>> views_;
};

}  // namespace

Result<LikenessSpace> learn_space(KnownPast& past, const MemoryId& entity,
                                  std::span<const Time> times, const ProgressSink& progress,
                                  const std::function<bool()>& is_over) {
  Gathering gathering(past, entity);
  ENGRAM_RETURN_IF_ERROR(gathering.begin(times));
  const size_t count = std::min(times.size(), kMaxSamples);
  for (size_t i = 0; i < count; ++i) {
    if (is_over()) return cancelled("'{}': learning its space", entity.to_string());
    if (progress) progress({"learn likeness of " + entity.to_string(), i, count, "", -1});
    ENGRAM_RETURN_IF_ERROR(gathering.add(times[i * times.size() / count]));
  }
  if (gathering.samples.times.size() < 2)
    return failed_precondition("'{}': has {} images among {} snapshots, too few to compare",
                               entity.to_string(), gathering.samples.times.size(), count);
  const auto recordings = cut_recordings(times);
  gathering.cut(times, recordings);
  LikenessSpace space = std::move(gathering.space);
  LearnedProjection learned = learn_projection(gathering.samples);
  space.snapshots = times.size();
  space.recordings = recordings.size();
  space.mean = std::move(learned.mean);
  space.projection = std::move(learned.projection);
  // Weights are rounded where they are stored, and codes must be the same before and after.
  return LikenessSpace::unpack(space.pack());
}

}  // namespace engram::ltm
