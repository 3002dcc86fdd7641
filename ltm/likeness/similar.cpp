// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/similar.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "ltm/memory/select.h"
#include "ltm/recall/list_moments.h"

namespace engram::ltm {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

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

Result<std::vector<double>> image_distances(const CodedMoments& coded,
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
  const auto bytes = coded.space.code(descriptor);
  return coded.square_distances(std::vector<float>(bytes.begin(), bytes.end()));
}

/// Which moments a query selects of the entity. Shape: [N].
Result<std::vector<bool>> selected(StorePast& past, const SimilarRequest& request,
                                   const CodedMoments& coded) {
  std::vector<bool> is_selected(coded.size(), !request.among.has_value());
  if (!request.among) return is_selected;
  ENGRAM_ASSIGN_OR_RETURN(const auto entity, past.of(request.entity));
  const auto queries = request.among->snapshots_of(request.entity);
  if (queries.empty())
    return invalid_argument("the query '{}' selects nothing of '{}', whose moments are searched",
                            request.among->to_string(), request.entity.to_string());
  for (const SnapshotQuery& query : queries) {
    if (!query.conditions.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(
          const auto met,
          select_snapshots(
              {&query, 1}, *entity,
              list_moments(past, request.entity, request.among->named_entities().has_value())));
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
  return is_selected;
}

/// Adds the weighted distances of another entity; moments that it has nothing for are out.
void add_part(const CodedMoments& coded, const CodedMoments& part, size_t moment, double weight,
              Duration context, std::vector<double>& squares) {
  const auto own = part.square_distances(moment, context);
  for (size_t i = 0; i < coded.size(); ++i) {
    const auto at = part.at_or_before(coded.times[i]);
    squares[i] = at ? squares[i] + weight * own[*at] : kNever;
  }
}

/// Chooses the nearest moments.
class Choice {
 public:
  Choice(const CodedMoments& coded, const SimilarRequest& request)
      : coded_(coded), request_(request), recording_of_(coded.size()) {
    for (size_t i = 0; i < coded.recordings.size(); ++i)
      for (size_t j = coded.recordings[i].first; j < coded.recordings[i].end; ++j)
        recording_of_[j] = i;
  }

  /// Leaves out what lies around the moment that was asked with.
  void leave_out(size_t moment) {
    taken_.push_back(coded_.times[moment]);
    if (request_.is_elsewhere) used_.push_back(recording_of_[moment]);
  }

  std::vector<SimilarMoment> nearest(const std::vector<double>& squares) {
    const auto is_farther = [&squares](size_t a, size_t b) {
      return squares[a] != squares[b] ? squares[a] > squares[b] : a > b;
    };
    std::vector<size_t> heap;
    for (size_t i = 0; i < squares.size(); ++i)
      if (squares[i] != kNever) heap.push_back(i);
    std::ranges::make_heap(heap, is_farther);
    std::vector<SimilarMoment> moments;
    while (!heap.empty() && moments.size() < request_.count) {
      std::ranges::pop_heap(heap, is_farther);
      const size_t at = heap.back();
      heap.pop_back();
      if (!is_free(at)) continue;
      const Sequence& recording = coded_.recordings[recording_of_[at]];
      taken_.push_back(coded_.times[at]);
      if (request_.is_one_per_recording) used_.push_back(recording_of_[at]);
      moments.push_back({coded_.times[at], std::sqrt(squares[at]), coded_.times[recording.first],
                         coded_.times[recording.end - 1]});
    }
    return moments;
  }

 private:
  bool is_free(size_t at) const {
    if (std::ranges::find(used_, recording_of_[at]) != used_.end()) return false;
    return std::ranges::none_of(taken_, [&](Time taken) {
      const Duration away =
          taken > coded_.times[at] ? taken - coded_.times[at] : coded_.times[at] - taken;
      return away == Duration::zero() || away < request_.apart;
    });
  }

  const CodedMoments& coded_;
  const SimilarRequest& request_;
  std::vector<size_t> recording_of_;
  std::vector<Time> taken_;
  std::vector<size_t> used_;  ///< Recordings that may not be answered any more.
};

std::string name_of_space(const CodedMoments& coded) {
  return coded.coded_by == CodedBy::kNumbers ? "numbers" : "images " + coded.space.name();
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
  for (const SimilarPart& part : with)
    if (!(part.weight > 0) || !std::isfinite(part.weight))
      return invalid_argument("the weight of '{}' must be above 0, found {}",
                              part.entity.to_string(), part.weight);
  return {};
}

Result<std::shared_ptr<const CodedMoments>> LikenessSearch::coded(const MemoryId& entity,
                                                                  const ProgressSink& progress,
                                                                  const std::stop_token& stop) {
  // Codes of a million images take a tenth of a gigabyte.
  constexpr size_t kMaxKept = 8;
  if (const auto found = kept_.find(entity); found != kept_.end()) return found->second;
  ENGRAM_ASSIGN_OR_RETURN(CodedMoments coded, code_moments(past_, entity, progress, stop));
  if (kept_.size() >= kMaxKept) kept_.clear();
  return kept_.emplace(entity, std::make_shared<const CodedMoments>(std::move(coded)))
      .first->second;
}

Result<std::vector<double>> LikenessSearch::distances(const SimilarRequest& request,
                                                      const CodedMoments& coded,
                                                      SimilarAnswer& answer,
                                                      const ProgressSink& progress,
                                                      const std::stop_token& stop) {
  if (request.image) return image_distances(coded, request);
  ENGRAM_ASSIGN_OR_RETURN(const size_t moment, moment_of(coded, request.entity, *request.moment));
  auto squares = coded.square_distances(moment, request.context);
  double weights = 1;
  for (const SimilarPart& one : request.with) {
    ENGRAM_ASSIGN_OR_RETURN(const auto part, this->coded(one.entity, progress, stop));
    const auto at = part->at_or_before(*request.moment);
    if (!at)
      return not_found("'{}': has nothing to compare at or before {}", one.entity.to_string(),
                       to_string(*request.moment));
    add_part(coded, *part, *at, one.weight, request.context, squares);
    answer.computed += part->computed;
    answer.space += " + " + name_of_space(*part);
    weights += one.weight;
  }
  for (double& square : squares) square /= weights;
  return squares;
}

Result<SimilarAnswer> LikenessSearch::find(const SimilarRequest& request,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(request.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto coded, this->coded(request.entity, progress, stop));
  SimilarAnswer answer{
      request.entity, name_of_space(*coded), coded->is_stored_space, 0, coded->computed, {}};
  ENGRAM_ASSIGN_OR_RETURN(auto squares, distances(request, *coded, answer, progress, stop));
  ENGRAM_ASSIGN_OR_RETURN(const auto is_selected, selected(past_, request, *coded));
  for (size_t i = 0; i < squares.size(); ++i)
    if (!is_selected[i]) squares[i] = kNever;
  answer.compared = static_cast<uint64_t>(
      std::ranges::count_if(squares, [](double square) { return square != kNever; }));
  Choice choice(*coded, request);
  if (request.moment) choice.leave_out(*coded->at_or_before(*request.moment));
  answer.moments = choice.nearest(squares);
  return answer;
}

Result<SimilarAnswer> StoreLikeness::similar(const SimilarRequest& request) {
  const MutexLock lock(mutex_);
  // Taken before the store is opened, so that a change between the two is noticed the next time.
  StoreMark now = look_at_store(store_);
  if (search_ == nullptr || now != mark_) {
    search_.reset();
    ENGRAM_ASSIGN_OR_RETURN(past_, StorePast::open(store_, loader_, {}));
    search_ = std::make_unique<LikenessSearch>(*past_);
    mark_ = std::move(now);
  }
  return search_->find(request);
}

}  // namespace engram::ltm
