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

/// What one camera saw at a moment, as far as it is remembered.
struct RememberedScene {
  augmentation::Scene scene;
  std::vector<std::string> things_in_sight;
};

/// Rebuilds remembered moments. Each kind of recording has its own: it knows how what was seen
/// looks from other sides.
///
/// Threading: one thread.
/// Source: docs/augmentation.md, section "Moments rendered anew".
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  /// For people: "a simulated kitchen".
  [[nodiscard]] virtual std::string name() const = 0;

  /// What instance `index` of a recorded snapshot shows; nothing where it is no such recording, or
  /// where the store does not have everything that was there at that moment.
  /// Errors: those of the store.
  virtual Result<std::optional<RememberedScene>> scene(ltm::StoreReader& store,
                                                       const ltm::Snapshot& snapshot,
                                                       size_t index) = 0;

  /// The value that would have been recorded of another image by `camera`, which has as many pixels
  /// as the one that was there. Errors: kInvalidArgument where `recorded` is no such value.
  [[nodiscard]] virtual Result<idf::Data> seen(const idf::Data& recorded,
                                               const augmentation::SceneCamera& camera,
                                               const idf::NdArray& image) const = 0;
};

/// What an entity was at a moment: its first instance, recorded at that very time; nothing where
/// there is none. Errors: those of the store.
Result<std::optional<idf::Data>> recorded_at(ltm::StoreReader& store, const ltm::MemoryId& entity,
                                             Time time);

}  // namespace engram::datasets
