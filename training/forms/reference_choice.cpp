// SPDX-License-Identifier: Apache-2.0
#include "training/forms/reference_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "ltm/codec/group_codec.h"
#include "ltm/core/log.h"

namespace engram::training {

namespace {

using encoders::OpenReference;

/// The key frame of a reference is so much better than the videos that begin from it: of g1 and a
/// fixed camera it took fewer bytes than 2, 9 or more (experiments/learning/LOG.md, "references").
constexpr int kKeyBetter = 5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a sample takes, and how much it has in common with a candidate.
struct Served {
  double distance = 0;
  double bytes = 0;
};

class ReferenceChoice {
 public:
  ReferenceChoice(std::span<const ReferenceSample> samples, const ReferenceChoiceOptions& options,
                  const std::stop_token& stop)
      : samples_(samples), options_(options), stop_(stop) {}

  /// Measures key frames. Must be called first.
  Status measure_key_frames() {
    for (const ReferenceSample& sample : samples_) {
      if (stop_.stop_requested()) return cancelled("the choice of references was stopped");
      ENGRAM_ASSIGN_OR_RETURN(
          const auto codec,
          ltm::make_group_codec(fmt::format("av1:crf={},{}", options_.crf, options_.settings)));
      ENGRAM_ASSIGN_OR_RETURN(const auto group, codec->encode({&sample.image, 1}));
      ENGRAM_ASSIGN_OR_RETURN(const auto packed, encoders::pack_video(group, nullptr));
      bytes_.push_back(static_cast<double>(packed.size()));
    }
    return {};
  }

  /// Takes the reference if it saves more than it costs. `own` is the sample that it was made of,
  /// which says nothing about others.
  Result<bool> take_if_worth(OpenReference open, std::optional<size_t> own) {
    std::vector<Served> served(samples_.size());
    std::vector<size_t> order;
    for (size_t i = 0; i < samples_.size(); ++i) {
      if (stop_.stop_requested()) return cancelled("the choice of references was stopped");
      served[i].distance = encoders::reference_distance(open.picture, samples_[i].image);
      if (i == own) continue;
      ENGRAM_ASSIGN_OR_RETURN(
          const auto packed,
          encoders::encode_from(open, {&samples_[i].image, 1}, options_.crf, options_.settings));
      if (!packed) return false;
      served[i].bytes = static_cast<double>(packed->size());
      order.push_back(i);
    }
    if (order.empty() || chosen_.size() == encoders::kMaxReferences) return false;
    std::ranges::sort(order, {}, [&](size_t i) { return served[i].distance; });
    // The reach that saves the most: beyond it more is lost than saved.
    double saved = 0, best = 0, reach = 0;
    for (size_t at = 0; at < order.size(); ++at) {
      const Served& one = served[order[at]];
      saved += bytes_[order[at]] - one.bytes;
      const bool is_last = at + 1 == order.size();
      if (saved > best) {
        best = saved;
        reach = is_last ? 2 * one.distance : (one.distance + served[order[at + 1]].distance) / 2;
      }
    }
    const double cost =
        static_cast<double>(open.reference.picture.size() + open.reference.key_frame.size());
    if (best * options_.chains / static_cast<double>(order.size()) <= cost) return false;
    open.reference.reach = static_cast<float>(reach);
    for (const size_t i : order)
      if (served[i].distance <= reach) bytes_[i] = std::min(bytes_[i], served[i].bytes);
    chosen_.push_back(std::move(open));
    return true;
  }

  /// The sample that would bring the others nearest to what serves them; nothing if all were tried.
  [[nodiscard]] std::optional<size_t> next_candidate() const {
    std::optional<size_t> best;
    double best_sum = kInfinity;
    for (size_t i = 0; i < samples_.size(); ++i) {
      if (std::ranges::find(tried_, i) != tried_.end()) continue;
      double sum = 0;
      for (size_t j = 0; j < samples_.size(); ++j) sum += std::min(distance(i, j), nearest_[j]);
      if (sum < best_sum) {
        best_sum = sum;
        best = i;
      }
    }
    return best;
  }

  /// Makes a reference of a sample and takes it if it is worth its bytes.
  Status attempt(size_t sample) {
    tried_.push_back(sample);
    for (size_t j = 0; j < samples_.size(); ++j)
      nearest_[j] = std::min(nearest_[j], distance(sample, j));
    auto open = encoders::make_reference(samples_[sample].image,
                                         std::max(options_.crf - kKeyBetter, 1), options_.settings);
    // Another encoder makes no key frames that can be shared.
    if (open.status().code() == StatusCode::kFailedPrecondition) return {};
    ENGRAM_RETURN_IF_ERROR(open.status());
    open->reference.time = samples_[sample].time.time_since_epoch().count();
    return take_if_worth(*std::move(open), sample).status();
  }

  std::vector<OpenReference> take() { return std::move(chosen_); }

 private:
  [[nodiscard]] double distance(size_t a, size_t b) const {
    return encoders::reference_distance(samples_[a].image, samples_[b].image);
  }

  std::span<const ReferenceSample> samples_;
  const ReferenceChoiceOptions& options_;
  const std::stop_token& stop_;
  std::vector<double> bytes_;  ///< What each sample takes, from the best that was chosen.
  std::vector<double> nearest_ = std::vector<double>(samples_.size(), kInfinity);
  std::vector<size_t> tried_;
  std::vector<OpenReference> chosen_;
};

}  // namespace

std::vector<OpenReference> open_references(const encoders::LatentChainCodec& chain, size_t member) {
  std::vector<OpenReference> open;
  for (const encoders::VideoReference& reference : chain.references_of(member)) {
    auto opened = encoders::open_reference(reference, chain.frames[member]);
    if (opened.ok())
      open.push_back(*std::move(opened));
    else
      log::warning("a reference of videos is not used: {}", opened.status().message());
  }
  return open;
}

Result<std::vector<OpenReference>> choose_references(std::span<const ReferenceSample> samples,
                                                     std::vector<OpenReference> known,
                                                     const ReferenceChoiceOptions& options,
                                                     const std::stop_token& stop) {
  if (samples.size() < 2 || options.crf <= kKeyBetter) return std::vector<OpenReference>();
  ReferenceChoice choice(samples, options, stop);
  ENGRAM_RETURN_IF_ERROR(choice.measure_key_frames());
  for (OpenReference& reference : known)
    if (reference.reference.key < options.crf)
      ENGRAM_RETURN_IF_ERROR(choice.take_if_worth(std::move(reference), std::nullopt).status());
  for (int i = 0; i < options.max_tried; ++i) {
    const auto candidate = choice.next_candidate();
    if (!candidate) break;
    ENGRAM_RETURN_IF_ERROR(choice.attempt(*candidate));
  }
  return choice.take();
}

}  // namespace engram::training
