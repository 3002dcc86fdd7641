// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/saliency.h"

#include <algorithm>
#include <cmath>

namespace engram::ltm {

namespace {

/// Changes below this count as none, and above that all the same.
constexpr double kMinChange_s = 0.01;
constexpr double kMaxChange_s = 100;
constexpr double kMaxRatio = 100;

}  // namespace

std::string_view name_of(SaliencyPart part) {
  constexpr std::array<std::string_view, kSaliencyParts> kNames{
      "change", "surprise", "novelty", "outcome", "speech", "links", "reads"};
  return kNames.at(static_cast<size_t>(part));
}

SaliencyWeights SaliencyWeights::standard() {
  SaliencyWeights weights;
  weights.parts[SaliencyPart::kChange] = 0.5;
  weights.parts[SaliencyPart::kSurprise] = 0.05;
  weights.parts[SaliencyPart::kNovelty] = 0.05;
  weights.parts[SaliencyPart::kOutcome] = 0.15;
  weights.parts[SaliencyPart::kSpeech] = 0.15;
  weights.parts[SaliencyPart::kLinks] = 0.05;
  weights.parts[SaliencyPart::kReads] = 0.05;
  return weights;
}

Status SaliencyWeights::validate() const {
  double sum = 0;
  for (const double weight : parts.values()) {
    if (!(weight >= 0) || weight > 1)
      return invalid_argument("weights of saliency: found {}, needs 0 to 1", weight);
    sum += weight;
  }
  if (std::abs(sum - 1) > 1e-6)
    return invalid_argument("weights of saliency: their sum is {}, needs 1", sum);
  return {};
}

double saliency_of(const SaliencyParts& parts, const SaliencyWeights& weights) {
  double sum = 0;
  for (size_t i = 0; i < kSaliencyParts; ++i) sum += parts.values()[i] * weights.parts.values()[i];
  return std::clamp(sum, 0.0, 1.0);
}

double change_part(double seconds) {
  if (!(seconds > kMinChange_s)) return 0;
  return std::min(1.0, std::log(seconds / kMinChange_s) / std::log(kMaxChange_s / kMinChange_s));
}

double change_seconds(double part) {
  return kMinChange_s * std::pow(kMaxChange_s / kMinChange_s, std::clamp(part, 0.0, 1.0));
}

double surprise_part(double ratio) {
  if (!(ratio > 1)) return 0;
  return std::min(1.0, std::log10(ratio) / std::log10(kMaxRatio));
}

double reads_part(uint64_t reads) {
  return static_cast<double>(reads) / (1 + static_cast<double>(reads));
}

}  // namespace engram::ltm
