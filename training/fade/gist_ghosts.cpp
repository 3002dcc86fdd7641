// SPDX-License-Identifier: Apache-2.0
#include "training/fade/gist_ghosts.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "encoders/gist_video.h"
#include "encoders/latent_block.h"

namespace engram::training {

namespace {

/// The kept row that stays and is nearest to `row`; -1 without one.
int nearest_staying(const std::vector<size_t>& kept, const std::set<uint32_t>& gone, int row) {
  int nearest = -1;
  for (const size_t candidate : kept) {
    const int at = static_cast<int>(candidate);
    if (gone.contains(static_cast<uint32_t>(candidate))) continue;
    if (nearest < 0 || std::abs(at - row) < std::abs(nearest - row)) nearest = at;
  }
  return nearest;
}

/// Whether a row is told from a kept row that is gone.
bool shows_gone(const std::vector<size_t>& kept, const std::set<uint32_t>& gone, size_t row) {
  const auto after = std::ranges::lower_bound(kept, row);
  if (after != kept.end() && *after == row) return false;
  const auto is_gone = [&gone](size_t at) { return gone.contains(static_cast<uint32_t>(at)); };
  return (after != kept.begin() && is_gone(*std::prev(after))) ||
         (after != kept.end() && is_gone(*after));
}

idf::NdArray grey_like(const idf::NdArray& image) {
  constexpr uint8_t kGrey = 128;
  return idf::NdArray::take(image.shape(),
                            std::vector<uint8_t>(image.values<uint8_t>().size(), kGrey));
}

}  // namespace

Result<GistGhosts> find_ghosts(const encoders::DeepModel& model, const ltm::Latent& latent,
                               const std::set<uint32_t>& gone) {
  const size_t images = model.plan.images().size();
  const size_t count = latent.place.count;
  GistGhosts ghosts;
  ghosts.instead.assign(images, std::vector<std::optional<int>>(count));
  if (images == 0) return ghosts;
  ENGRAM_ASSIGN_OR_RETURN(const auto block,
                          encoders::describe_block(latent.code.bytes(), count, images));
  // A gist is one chain.
  for (size_t image = 0; image < images && block.chains.size() == 1; ++image) {
    const encoders::ImageCode& code = block.chains.front()[image];
    if (code.form != encoders::ImageForm::kGist) continue;
    ENGRAM_ASSIGN_OR_RETURN(
        const auto kept,
        encoders::kept_rows_of_gist(code.code, model.codec.chain.frames[image], count));
    for (size_t row = 0; row < count; ++row)
      if (shows_gone(kept, gone, row))
        ghosts.instead[image][row] = nearest_staying(kept, gone, static_cast<int>(row));
  }
  return ghosts;
}

Status replace_ghosts(const encoders::DeepModel& model, const GistGhosts& ghosts,
                      const std::vector<uint32_t>& rows, std::vector<idf::Data>& values) {
  std::vector<idf::SplitValue> split;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), model.plan.split(value));
  }
  for (size_t image = 0; image < ghosts.instead.size(); ++image) {
    const size_t member = model.plan.images()[image].member;
    for (size_t i = 0; i < rows.size(); ++i) {
      const auto& instead = ghosts.instead[image][rows[i]];
      if (!instead) continue;
      const auto other = std::ranges::find(rows, static_cast<uint32_t>(*instead));
      split[i].tensors[member] =
          *instead < 0 || other == rows.end()
              ? grey_like(split[i].tensors[member])
              : split[static_cast<size_t>(other - rows.begin())].tensors[member];
    }
  }
  for (size_t i = 0; i < values.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(values[i], model.plan.layout().join(split[i]));
  }
  return {};
}

}  // namespace engram::training
