// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "augmentation/blender/scene.h"
#include "ltm/memory/snapshot.h"
#include "ltm/store/store_reader.h"

namespace engram::datasets {

/// What one camera saw at a moment, reconstructed from memory.
struct RememberedScene {
  augmentation::Scene scene;
  std::vector<std::string> things_in_sight;
};

/// Reconstructs remembered moments as scenes. Each kind of recording needs its own source, which
/// knows how its things look from other sides.
///
/// Threading: one thread.
/// Source: docs/augmentation.md, section "Moments rendered anew".
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  /// A name for the user: "a simulated kitchen".
  [[nodiscard]] virtual std::string name() const = 0;

  /// Returns what instance `index` of a recorded snapshot shows. Returns nothing if the recording
  /// is not of this kind, or if the store does not have everything that was visible at that moment.
  /// Errors: those of the store.
  virtual Result<std::optional<RememberedScene>> scene(ltm::StoreReader& store,
                                                       const ltm::Snapshot& snapshot,
                                                       size_t index) = 0;

  /// Returns the value that would have been recorded if `camera` had seen `image`, which has as
  /// many pixels as the recorded one. Errors: kInvalidArgument if `recorded` is not such a value.
  [[nodiscard]] virtual Result<idf::Data> seen(const idf::Data& recorded,
                                               const augmentation::SceneCamera& camera,
                                               const idf::NdArray& image) const = 0;
};

/// Returns the value of an entity at a moment: the first instance that was recorded at exactly that
/// time; nothing if there is none. Errors: those of the store.
Result<std::optional<idf::Data>> recorded_at(ltm::StoreReader& store, const ltm::MemoryId& entity,
                                             Time time);

}  // namespace engram::datasets
