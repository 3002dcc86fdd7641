// SPDX-License-Identifier: Apache-2.0
// Numbers of lanes and plots, as bytes.
#include <algorithm>
#include <bit>

#include "ltm/core/buffer.h"
#include "ltm/core/not_a_number.h"
#include "reports/plain/shown_value.h"
#include "viewer/sampled_series.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are sent as they are in memory");

constexpr size_t kMaxLanes = 256;
constexpr size_t kMaxSeries = 64;
/// Numbers of an answer: 12 MB.
constexpr size_t kMaxBinnedNumbers = size_t{3} << 20;
/// Snapshots that a server is asked for, to be counted.
constexpr uint64_t kMaxListedSnapshots = 1'000'000;

Result<ltm::TimeBins> bins_of(const RequestTarget& target, size_t lanes) {
  ENGRAM_ASSIGN_OR_RETURN(const Time from, target.time("from"));
  ENGRAM_ASSIGN_OR_RETURN(const Time to, target.time("to"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t pixels,
                          target.integer("pixels", 1, ltm::TimeBins::kMaxCount));
  const auto count = static_cast<size_t>(pixels);
  if (3 * lanes * count > kMaxBinnedNumbers)
    return resource_exhausted("{} lanes of {} pixels: needs at most {} pixels in all", lanes, count,
                              kMaxBinnedNumbers / 3);
  return ltm::TimeBins::create(from, to, count);
}

/// Counts what a server lists. Its working memory is bounded, but a store below it is not.
Result<std::vector<ltm::FormCounts>> counts_on_server(ViewedMemory& viewed,
                                                      const ltm::MemoryId& entity,
                                                      const ltm::TimeBins& bins) {
  const Time last = time_from_ns(to_ns(bins.begin(bins.count())) - 1);
  const ltm::Query whole =
      ltm::Query::of_entity(entity, ltm::select::TimeRange{bins.begin(0), last});
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::create(whole.memories(), true));
  ltm::EntityTimes times;
  uint64_t listed = 0;
  ENGRAM_RETURN_IF_ERROR(
      viewed.memory().query_parts(query, [&](const ltm::QueryResult& part) -> Status {
        for (const ltm::EntityResult* found : part.entities()) {
          for (const ltm::SnapshotResult& snapshot : found->snapshots) {
            const Time time = snapshot.time;
            times.add({&time, 1}, snapshot.source == ltm::Source::kReconstructed,
                      snapshot.source == ltm::Source::kAugmented);
          }
          listed += found->snapshots.size();
        }
        if (listed > kMaxListedSnapshots)
          return resource_exhausted("'{}' has more than {} snapshots there: ask for a shorter span",
                                    entity.to_string(), kMaxListedSnapshots);
        return {};
      }));
  return times.count_in(bins);
}

void append_counts(const std::vector<ltm::FormCounts>& counts, std::vector<uint32_t>& numbers) {
  for (const auto form :
       {&ltm::FormCounts::recorded, &ltm::FormCounts::latent, &ltm::FormCounts::augmented})
    for (const ltm::FormCounts& one : counts) numbers.push_back(one.*form);
}

/// Counts of each lane: of the entities at its ID or below it, each counted by `count`.
template <typename Count>
Result<std::vector<uint32_t>> count_lanes(const std::vector<ltm::MemoryId>& lanes,
                                          const std::vector<ltm::MemoryId>& entities, size_t bins,
                                          const Count& count) {
  std::vector<uint32_t> numbers;
  numbers.reserve(3 * lanes.size() * bins);
  for (const ltm::MemoryId& lane : lanes) {
    // IDs are sorted, so what lies below an ID follows it.
    auto entity = std::ranges::lower_bound(entities, lane);
    if (entity == entities.end() || !lane.is_prefix_of(*entity))
      return not_found("'{}': there is no such entity or segment", lane.to_string());
    std::vector<ltm::FormCounts> sums(bins);
    for (; entity != entities.end() && lane.is_prefix_of(*entity); ++entity) {
      ENGRAM_ASSIGN_OR_RETURN(const std::vector<ltm::FormCounts> counts, count(*entity));
      for (size_t i = 0; i < bins; ++i) {
        sums[i].recorded += counts[i].recorded;
        sums[i].latent += counts[i].latent;
        sums[i].augmented += counts[i].augmented;
      }
    }
    append_counts(sums, numbers);
  }
  return numbers;
}

}  // namespace

ViewAnswer answer_density(ViewedMemory& viewed, const RequestTarget& target) {
  using Counts = Result<std::vector<ltm::FormCounts>>;
  ENGRAM_ASSIGN_OR_RETURN(const auto lanes, target.names("entity", kMaxLanes));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::TimeBins bins, bins_of(target, lanes.size()));
  if (!viewed.is_store()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entities, viewed.entities());
    ENGRAM_ASSIGN_OR_RETURN(
        const auto numbers,
        count_lanes(lanes, entities, bins.count(), [&](const ltm::MemoryId& entity) {
          return counts_on_server(viewed, entity, bins);
        }));
    return binary_response(std::as_bytes(std::span(numbers)));
  }
  std::vector<uint32_t> numbers;
  ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
    const auto count = [&](const ltm::MemoryId& entity) -> Counts {
      ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, entity));
      return times->count_in(bins);
    };
    ENGRAM_ASSIGN_OR_RETURN(numbers,
                            count_lanes(lanes, view.reader.entities(), bins.count(), count));
    return {};
  }));
  return binary_response(std::as_bytes(std::span(numbers)));
}

ViewAnswer answer_members(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t instance, target.integer("instance", 0, 1 << 20, 0));
  ENGRAM_ASSIGN_OR_RETURN(const auto last,
                          find_one(viewed.memory(), entity, ltm::select::Latest{}));
  nlohmann::ordered_json members = nlohmann::ordered_json::array();
  if (!last) return json_response({{"instances", 0}, {"members", std::move(members)}});
  const ltm::InstanceResult* found = last->find(static_cast<int32_t>(instance));
  if (found == nullptr)
    return not_found("'{}': has no instance {}", entity.at(last->time).to_string(), instance);
  for (const reports::ShownMember& member :
       reports::shown_members(found->data, viewed.type_of(entity))) {
    nlohmann::ordered_json json{
        {"path", member.path}, {"kind", member.kind}, {"shape", member.shape}};
    if (member.quantity) {
      if (!member.quantity->unit.empty()) json["unit"] = member.quantity->unit;
      if (member.quantity->minimum) json["min"] = *member.quantity->minimum;
      if (member.quantity->maximum) json["max"] = *member.quantity->maximum;
    }
    members.push_back(std::move(json));
  }
  return bounded_json({{"instances", last->instances.size()}, {"members", std::move(members)}});
}

ViewAnswer answer_series(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  const std::vector<std::string> paths = target.all("path");
  if (paths.empty() || paths.size() > kMaxSeries)
    return invalid_argument("parameter 'path': found it {} times, needs it 1 to {} times",
                            paths.size(), kMaxSeries);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::TimeBins bins, bins_of(target, paths.size()));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t instance, target.integer("instance", 0, 1 << 20, 0));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t budget_ms, target.integer("budget", 1, 5000, 250));
  ENGRAM_ASSIGN_OR_RETURN(const SeriesAnswer drawn,
                          sample_series(viewed, {.entity = entity,
                                                 .paths = paths,
                                                 .instance = static_cast<size_t>(instance),
                                                 .bins = bins,
                                                 .budget = std::chrono::milliseconds(budget_ms)}));
  std::vector<float> numbers;
  numbers.reserve(3 * paths.size() * bins.count());
  for (const DrawnSeries& one : drawn.series)
    for (const std::vector<float>* row : {&one.min, &one.max, &one.last})
      numbers.insert(numbers.end(), row->begin(), row->end());
  HttpResponse response = binary_response(std::as_bytes(std::span(numbers)));
  const auto type = viewed.type_of(entity);
  std::string units;
  for (size_t i = 0; i < paths.size(); ++i)
    units += (i > 0 ? "|" : "") + reports::unit_at(type, paths[i]);
  response.headers = {{"X-Engram-Unit", header_text(units)},
                      {"X-Engram-Read", std::to_string(drawn.read)},
                      {"X-Engram-Total", std::to_string(drawn.total)}};
  return response;
}

}  // namespace engram::viewer
