// SPDX-License-Identifier: Apache-2.0
#include "training/fade/gist_quality.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace engram::training {

namespace {

struct GistLevel {
  int crf = 0;
  double gain_db = 0;
};

/// From the best to the smallest: each takes some 10 to 30 % fewer bytes than the one before.
/// Source: docs/learning_methods.md, section "Gists".
constexpr std::array<GistLevel, 12> kLevels{{{44, 2.5},
                                             {48, 2.5},
                                             {52, 2.5},
                                             {55, 2.5},
                                             {57, 2.5},
                                             {60, 3},
                                             {60, 4},
                                             {61, 4},
                                             {62, 4},
                                             {62, 5},
                                             {63, 3},
                                             {63, 4}}};

encoders::GistOptions options_of(const GistLevel& level) {
  encoders::GistOptions options;
  options.crf = level.crf;
  options.gain_db = level.gain_db;
  return options;
}

/// The latents of a gist share its block.
size_t block_bytes(const std::vector<ltm::Latent>& latents) {
  return latents.empty() ? 0 : latents.front().code.size();
}

}  // namespace

// The level is in [best, end]. The first search halves that; later ones look beside the level of
// the block before, which is hardly ever wrong.
Result<std::vector<ltm::Latent>> GistQuality::find(size_t images, const Encode& encode) {
  std::map<size_t, std::vector<ltm::Latent>> tried;
  const auto try_level = [&](size_t level) -> Result<size_t> {
    ENGRAM_ASSIGN_OR_RETURN(tried[level], encode(options_of(kLevels[level])));
    return block_bytes(tried[level]);
  };
  size_t best = 0, end = kLevels.size() - 1;
  for (size_t level = level_.value_or((best + end) / 2); best < end;) {
    ENGRAM_ASSIGN_OR_RETURN(const size_t bytes, try_level(level));
    const bool fits = static_cast<double>(bytes) <= kMaxGistBytes * static_cast<double>(images);
    (fits ? end : best) = fits ? level : std::min(level + 1, end);
    if (!level_)
      level = (best + end) / 2;
    else
      level = fits && level > 0 ? level - 1 : best;
  }
  if (!tried.contains(end)) ENGRAM_RETURN_IF_ERROR(try_level(end).status());
  level_ = end;
  return std::move(tried[end]);
}

}  // namespace engram::training
