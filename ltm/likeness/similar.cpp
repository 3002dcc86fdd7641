// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/similar.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ltm/likeness/nearest_moments.h"
#include "ltm/memory/select.h"
#include "ltm/recall/list_moments.h"
#include "ltm/recall/seen_past.h"

namespace engram::ltm {

namespace {

/// Codes of a million images take forty megabytes.
/// More than one question may name.
constexpr size_t kMaxKeptEntities = 32;
constexpr Duration kMaxContext = std::chrono::hours(24);
constexpr double kMaxWeight = 1e6;

/// The moment of the request among those with codes.
Result<size_t> moment_of(const CodedMoments& coded, const MemoryId& entity, Time moment) {
  const auto at = coded.at_or_before(moment);
  if (at && coded.times[*at] == moment) return *at;
  if (coded.size() == 0)
    return not_found("'{}': no moment of it can be compared", entity.to_string());
  const std::string before = at ? to_string(coded.times[*at]) : "none";
  const size_t next = at ? *at + 1 : 0;
  const std::string after = next < coded.size() ? to_string(coded.times[next]) : "none";
  return not_found("'{}': has nothing to compare at {}; the moment before it is {}, after it {}",
                   entity.to_string(), to_string(moment), before, after);
}

Result<std::vector<float>> image_distances(const CodedMoments& coded,
                                           const SimilarRequest& request) {
  const MemoryId& entity = request.entity;
  if (coded.coded_by != CodedBy::kImages)
    return invalid_argument(
        "'{}': has numbers and no images: an image cannot be compared with them",
        entity.to_string());
  const auto size = image_size_of(*request.image);
  ENGRAM_ASSIGN_OR_RETURN(const auto descriptor, describe_image(*request.image));
  if (*size != coded.space.size && !request.takes_any_size)
    return invalid_argument("'{}': its images have {} pixels and channels, found an image of {}",
                            entity.to_string(), coded.space.size.to_string(), size->to_string());
  return coded.square_distances(coded.space.code(descriptor));
}

/// Adds the weighted distances of another entity; moments that it has nothing for are out.
void add_part(const CodedMoments& coded, const CodedMoments& part, size_t moment, double weight,
              Duration context, std::vector<float>& squares) {
  const auto own = part.square_distances(moment, context);
  for (size_t i = 0; i < coded.size(); ++i) {
    const auto at = part.at_or_before(coded.times[i]);
    squares[i] = at ? squares[i] + static_cast<float>(weight) * own[*at] : kNeverNear;
  }
}

}  // namespace

Status SimilarRequest::validate() const {
  if (moment.has_value() == image.has_value())
    return invalid_argument("likeness needs a moment or an image, and not both");
  if (image && !with.empty())
    return invalid_argument("an image tells nothing of other entities: ask with a moment");
  if (count == 0) return invalid_argument("count must be at least 1");
  if (apart < Duration::zero() || context < Duration::zero())
    return invalid_argument("apart and context must not be negative");
  if (context > kMaxContext)
    return invalid_argument("context must be at most {}, found {}", to_string(kMaxContext),
                            to_string(context));
  // Sums are floats.
  for (const SimilarPart& part : with)
    if (!(part.weight > 0) || part.weight > kMaxWeight)
      return invalid_argument("the weight of '{}' must be above 0 and at most {}, found {}",
                              part.entity.to_string(), kMaxWeight, part.weight);
  return {};
}

/// One question.
class LikenessSearch::Question {
 public:
  Question(LikenessSearch& search, const SimilarRequest& request, const ProgressSink& progress,
           const std::stop_token& stop, const View* view)
      : search_(search),
        request_(request),
        progress_(progress),
        stop_(stop),
        view_(view),
        past_(search.past_, search.memory_) {}

  Result<SimilarAnswer> answer() {
    // Working memory before the store: what leaves it from now on is in the store.
    past_.held(request_.entity);
    for (const SimilarPart& part : request_.with) past_.held(part.entity);
    if (request_.among)
      for (const MemoryId& entity : request_.among->condition_entities()) past_.held(entity);
    ENGRAM_RETURN_IF_ERROR(past_.follow());
    answer_.entity = request_.entity;
    ENGRAM_ASSIGN_OR_RETURN(const auto coded, this->coded(request_.entity));
    answer_.is_stored_space = coded->is_stored_space;
    ENGRAM_ASSIGN_OR_RETURN(auto squares, distances(*coded));
    ENGRAM_RETURN_IF_ERROR(select(*coded, squares));
    answer_.compared = static_cast<uint64_t>(
        std::ranges::count_if(squares, [](float square) { return square != kNeverNear; }));
    answer_.moments = nearest_moments(*coded, squares, request_, asked_);
    return std::move(answer_);
  }

 private:
  /// The codes that may be compared.
  Result<std::shared_ptr<const CodedMoments>> coded(const MemoryId& entity) {
    const Sight sight = sight_of(view_, entity);
    const Status unseen = not_found("'{}': there is no such entity", entity.to_string());
    if (sight.times.empty()) return unseen;
    auto coded = search_.coder_of(entity).code(past_, progress_, stop_);
    if (coded.status().code() == StatusCode::kNotFound) search_.coders_.erase(entity);
    // The message names the entities that there are.
    if (coded.status().code() == StatusCode::kNotFound && view_ != nullptr) return unseen;
    ENGRAM_RETURN_IF_ERROR(coded.status());
    // Of moments that are not seen nothing is told, not even that they had to be decoded.
    if (sight.is_whole()) answer_.computed += coded->computed;
    answer_.space += (answer_.space.empty() ? "" : " + ") + coded->moments->space_name();
    const bool is_image = coded->moments->coded_by == CodedBy::kImages;
    const TimeWindows& seen = is_image ? sight.exact : sight.times;
    if (seen.is_all()) return coded->moments;
    auto some = std::make_shared<const CodedMoments>(coded->moments->only(seen));
    if (some->size() > 0) return some;
    if (is_image && coded->moments->only(sight.times).size() > 0)
      return failed_precondition("'{}': its images may be seen redacted only, and are not compared",
                                 entity.to_string());
    return unseen;
  }

  Result<std::vector<float>> distances(const CodedMoments& coded) {
    if (request_.image) return image_distances(coded, request_);
    ENGRAM_ASSIGN_OR_RETURN(const size_t moment,
                            moment_of(coded, request_.entity, *request_.moment));
    asked_ = moment;
    auto squares = coded.square_distances(moment, request_.context);
    double weights = 1;
    for (const SimilarPart& one : request_.with) {
      ENGRAM_ASSIGN_OR_RETURN(const auto part, this->coded(one.entity));
      const auto at = part->at_or_before(*request_.moment);
      if (!at)
        return not_found("'{}': has nothing to compare at or before {}", one.entity.to_string(),
                         to_string(*request_.moment));
      add_part(coded, *part, *at, one.weight, request_.context, squares);
      weights += one.weight;
    }
    for (float& square : squares) square /= static_cast<float>(weights);
    return squares;
  }

  /// Takes out what the query of the request does not select.
  Status select(const CodedMoments& coded, std::vector<float>& squares) {
    if (!request_.among) return {};
    const auto queries = request_.among->snapshots_of(request_.entity);
    if (queries.empty())
      return invalid_argument("the query '{}' selects nothing of '{}', whose moments are searched",
                              request_.among->to_string(), request_.entity.to_string());
    ENGRAM_ASSIGN_OR_RETURN(auto entity, past_.of(request_.entity));
    if (view_ != nullptr) {
      ENGRAM_ASSIGN_OR_RETURN(entity,
                              seen_past(std::move(entity), sight_of(view_, request_.entity).times));
    }
    std::vector<bool> is_selected(coded.size(), false);
    for (const SnapshotQuery& query : queries) {
      if (entity == nullptr) break;
      if (!query.conditions.empty()) {
        ENGRAM_ASSIGN_OR_RETURN(const auto met,
                                select_snapshots({&query, 1}, *entity, list_meeting(*entity)));
        for (const SelectedSnapshot& one : met) {
          const auto found = std::ranges::lower_bound(coded.times, one.time);
          if (found != coded.times.end() && *found == one.time)
            is_selected[static_cast<size_t>(found - coded.times.begin())] = true;
        }
        continue;
      }
      ENGRAM_ASSIGN_OR_RETURN(const Selection selection, select_times(query.selector, *entity));
      if (!selection.snapshots) continue;  // Nothing, or a prediction.
      const auto first = std::ranges::lower_bound(coded.times, selection.snapshots->first);
      const auto end = std::ranges::upper_bound(coded.times, selection.snapshots->last);
      std::fill(is_selected.begin() + (first - coded.times.begin()),
                is_selected.begin() + (end - coded.times.begin()), true);
    }
    for (size_t i = 0; i < squares.size(); ++i)
      if (!is_selected[i]) squares[i] = kNeverNear;
    return {};
  }

  /// What answers the conditions of the query, as the view sees them.
  ListMoments list_meeting(EntityPast& own) {
    return list_moments(past_,
                        [this](const MemoryId& entity) -> Result<std::unique_ptr<EntityPast>> {
                          ENGRAM_ASSIGN_OR_RETURN(auto past, past_.of(entity));
                          if (view_ == nullptr) return past;
                          return seen_past(std::move(past), sight_of(view_, entity).times);
                        },
                        request_.entity, own, request_.among->named_entities().has_value(), {});
  }

  LikenessSearch& search_;
  const SimilarRequest& request_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  const View* const view_;
  ComparedPast past_;
  SimilarAnswer answer_;
  std::optional<size_t> asked_;
};

MomentCoder& LikenessSearch::coder_of(const MemoryId& entity) {
  const auto known = coders_.find(entity);
  if (known != coders_.end()) return known->second;
  if (coders_.size() >= kMaxKeptEntities) coders_.clear();
  return coders_.try_emplace(entity, entity).first->second;
}

Result<MomentMap> LikenessSearch::map(const MemoryId& entity, size_t max_moments,
                                      const std::stop_token& stop) {
  if (max_moments == 0) return invalid_argument("a map needs at least 1 moment");
  ComparedPast past(past_, memory_);
  past.held(entity);
  ENGRAM_RETURN_IF_ERROR(past.follow());
  auto coded = coder_of(entity).code(past, {}, stop);
  if (coded.status().code() == StatusCode::kNotFound) coders_.erase(entity);
  ENGRAM_RETURN_IF_ERROR(coded.status());
  return map_of(*coded->moments, max_moments);
}

Result<SimilarAnswer> LikenessSearch::find(const SimilarRequest& request,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop, const View* view) {
  ENGRAM_RETURN_IF_ERROR(request.validate());
  return Question(*this, request, progress, stop, view).answer();
}

}  // namespace engram::ltm
