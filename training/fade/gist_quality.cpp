// SPDX-License-Identifier: Apache-2.0
#include "training/fade/gist_quality.h"

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

Result<std::vector<ltm::Latent>> GistQuality::find(size_t images, const Encode& encode) {
  std::map<size_t, std::vector<ltm::Latent>> tried;
  const auto fits = [&](size_t level) -> Result<bool> {
    if (!tried.contains(level)) {
      ENGRAM_ASSIGN_OR_RETURN(tried[level], encode(options_of(kLevels[level])));
    }
    return static_cast<double>(block_bytes(tried[level])) <=
           kMaxGistBytes * static_cast<double>(images);
  };
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_small, fits(level_));
    if (!is_small && level_ + 1 < kLevels.size()) {
      ++level_;
      // The better one did not fit.
      if (tried.contains(level_)) break;
    } else if (is_small && level_ > 0 && !tried.contains(level_ - 1)) {
      --level_;
    } else {
      break;
    }
  }
  return std::move(tried[level_]);
}

}  // namespace engram::training
