// SPDX-License-Identifier: Apache-2.0
// A memory in two dimensions, and how well its images are kept.
#include <algorithm>
#include <cmath>

#include "ltm/likeness/coded_moments.h"
#include "reports/plain/shown_value.h"
#include "training/quality/quality_metrics.h"
#include "viewer/sampled_series.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using MapJson = nlohmann::ordered_json;

/// Numbers with a few digits: a map has thousands.
MapJson rounded(std::span<const float> numbers) {
  MapJson json = MapJson::array();
  for (const float number : numbers) json.push_back(std::round(number * 1e4) / 1e4);
  return json;
}

/// Moments of an entity that have both forms, evenly spread.
Result<std::vector<Time>> moments_with_both(ViewedMemory& viewed, const ltm::MemoryId& entity,
                                            size_t max_moments) {
  std::vector<Time> moments;
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
    moments.clear();
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, view.reader.timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, entity));
    const std::vector<Time>& latent = times->latent;
    const size_t count = std::min(latent.size(), max_moments);
    for (size_t i = 0; i < count; ++i) {
      const Time time = latent[i * latent.size() / count];
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(time));
      if (entry && entry->time == time && entry->recorded && entry->latent) moments.push_back(time);
    }
    return {};
  }));
  return moments;
}

/// The PSNR of the first image of a snapshot as latents have it; nothing if it has none.
/// Errors: those of Memory::query.
Result<std::optional<double>> psnr_at(ViewedMemory& viewed, const ltm::MemoryId& entity,
                                      Time time) {
  ENGRAM_ASSIGN_OR_RETURN(const auto recorded,
                          find_one(viewed.memory(), entity, ltm::select::At{time}));
  ENGRAM_ASSIGN_OR_RETURN(Memory * latents, viewed.latents());
  ENGRAM_ASSIGN_OR_RETURN(const auto latent, find_one(*latents, entity, ltm::select::At{time}));
  if (!recorded || !latent || recorded->source != ltm::Source::kRecorded ||
      latent->source != ltm::Source::kReconstructed)
    return std::optional<double>();
  double squares = 0;
  size_t images = 0;
  for (const ltm::InstanceResult& instance : recorded->instances) {
    const ltm::InstanceResult* const other = latent->find(instance.index);
    if (other == nullptr) continue;
    for (const reports::ShownMember& member : reports::shown_members(instance.data, std::nullopt)) {
      if (member.kind != "image") continue;
      const idf::NdArray* const one = reports::image_at(instance.data, member.path);
      const idf::NdArray* const two = reports::image_at(other->data, member.path);
      if (one == nullptr || two == nullptr) continue;
      ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(*one, *two));
      squares += mse;
      ++images;
    }
  }
  if (images == 0) return std::optional<double>();
  return std::optional(training::psnr_db(squares / static_cast<double>(images)));
}

}  // namespace

ViewAnswer answer_map(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxMoments = 20'000;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t max, target.integer("max", 1, kMaxMoments, 2000));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MomentMap map,
                          viewed.memory().map(entity, static_cast<size_t>(max)));
  MapJson times = MapJson::array();
  for (const Time time : map.times) times.push_back(time_text(time));
  return bounded_json({{"entity", entity.to_string()},
                       {"space", map.space},
                       {"coded_by", map.coded_by == ltm::CodedBy::kImages ? "images" : "numbers"},
                       {"known", map.known},
                       {"explained", map.explained},
                       {"times", std::move(times)},
                       {"x", rounded(map.x)},
                       {"y", rounded(map.y)},
                       {"recordings", map.recordings}});
}

ViewAnswer answer_quality(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxSample = 2000;
  constexpr double kStep = 0.5;  // dB.
  constexpr size_t kWorst = 20;
  constexpr size_t kFirstPass = 16;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t sample, target.integer("sample", 1, kMaxSample, 100));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t budget, target.integer("budget", 1, 60'000, 2000));
  ENGRAM_ASSIGN_OR_RETURN(const auto moments,
                          moments_with_both(viewed, entity, static_cast<size_t>(sample)));
  const SteadyTime end = steady_now() + std::chrono::milliseconds(budget);
  std::vector<std::pair<double, Time>> known;
  uint64_t unknown = 0;
  // Those that are asked first are spread over all, so that a part of them tells of the whole.
  visit_coarse_first(moments.size(), kFirstPass, [&](size_t index) {
    const auto psnr = psnr_at(viewed, entity, moments[index]);
    // What is damaged or changed meanwhile is not known; the inspector tells why.
    if (psnr.ok() && *psnr)
      known.emplace_back(**psnr, moments[index]);
    else
      ++unknown;
    return steady_now() < end;
  });
  std::ranges::sort(known);
  MapJson worst = MapJson::array();
  for (size_t i = 0; i < std::min(kWorst, known.size()); ++i)
    worst.push_back({{"id", entity.at(known[i].second).to_string()}, {"psnr", known[i].first}});
  const double low = known.empty() ? 0 : std::floor(known.front().first / kStep) * kStep;
  std::vector<uint64_t> counts;
  for (const auto& [psnr, time] : known) {
    const auto bar = static_cast<size_t>((psnr - low) / kStep);
    counts.resize(std::max(counts.size(), bar + 1));
    ++counts[bar];
  }
  return bounded_json({{"entity", entity.to_string()},
                       {"low", low},
                       {"step", kStep},
                       {"counts", counts},
                       {"compared", known.size()},
                       {"asked", moments.size()},
                       {"unknown", unknown},
                       {"worst", std::move(worst)}});
}

}  // namespace engram::viewer
