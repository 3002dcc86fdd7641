// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "memory/memory.h"

namespace engram::speech {

struct NoticeSightsOptions {
  Time from = Time::min();
  Time to = Time::max();
};

/// What an image showed of a thing. Of each kind there is taken to be one thing.
struct Sighting {
  ltm::MemoryId kind;   ///< The entity of its class.
  ltm::MemoryId image;  ///< The instance that it was read from.
  Time time{};
  bool is_in_sight = false;  ///< False: it was, and no longer is; the rest is as it was.
  std::string where;         ///< The entity of a place, or a hand; empty: somewhere else.
  std::string colour;        ///< By all images so far that showed it; empty: none is known.
  double probability = 0;    ///< That it is in sight, or was when it was last.
};

struct NoticedSights {
  std::vector<Sighting> sightings;  ///< In the order of time.
  size_t images = 0;                ///< That were read,
  size_t others = 0;                ///< and that are no latents of the model that is needed.
  /// Kinds of which the memory has the poses, which are known better.
  std::vector<ltm::MemoryId> known;
};

/// Looks for things in the latents of a store's images, with a network of learn_sights(). No image
/// is decoded. What is told of a moment is read from images up to it alone. Nothing is written.
/// Errors: those of opening a network; kNotFound where no images are latents of its model;
/// kCancelled; kDataLoss; those of Memory::query.
/// Threading: one thread.
/// Source: docs/verbalisation.md, section "What images show".
Result<NoticedSights> notice_sights(const std::filesystem::path& store,
                                    const std::filesystem::path& network,
                                    const NoticeSightsOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop);

/// Commits sightings as snapshots of `Objects/Sightings/seen`, one entity for each kind, so that
/// the memory can be asked where things are. A thing on a place has the pose of the middle of the
/// place. What was committed before is not committed again. Returns how many are new.
/// Errors: those of Memory::commit and Memory::query.
Result<size_t> remember_sights(Memory& memory, const std::vector<Sighting>& sightings);

/// The provider that tells of what was seen so.
inline constexpr const char* kSightsProvider = "seen";

}  // namespace engram::speech
