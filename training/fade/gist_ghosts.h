// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <vector>

#include "encoders/deep_model.h"
#include "ltm/store/latent.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// The rows of a gist whose images are told from an image that is erased: they would show it.
struct GistGhosts {
  /// Per image member and row of the block, the kept row to take an image from instead; -1 if there
  /// is none, and nothing in rows that show nothing of it.
  std::vector<std::vector<std::optional<int>>> instead;
};

/// Finds them in a block of `latent`, of which the rows in `gone` are erased.
/// Errors: kDataLoss.
Result<GistGhosts> find_ghosts(const encoders::DeepModel& model, const ltm::Latent& latent,
                               const std::set<uint32_t>& gone);

/// Replaces the images of ghosts among the values of a block, which are at `rows`. Without another
/// image they become grey.
/// Errors: kInvalidArgument if a value has another layout.
Status replace_ghosts(const encoders::DeepModel& model, const GistGhosts& ghosts,
                      const std::vector<uint32_t>& rows, std::vector<idf::Data>& values);

}  // namespace engram::training
