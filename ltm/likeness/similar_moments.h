// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/query.h"

namespace engram::ltm {

/// Another entity that counts when moments are compared.
struct SimilarPart {
  MemoryId entity;
  double weight = 1;  ///< Beside that of the searched entity, which is 1.
};

/// Asks when it was like this before.
struct SimilarRequest {
  MemoryId entity;  ///< Whose moments are searched.
  /// Like this moment of the entity, or like `image`: one of both.
  std::optional<Time> moment{};
  std::optional<idf::NdArray> image{};
  /// What else must be alike. Needs `moment`.
  std::vector<SimilarPart> with{};
  /// Only moments of the entity that this query selects.
  std::optional<Query> among{};
  size_t count = 10;
  /// A moment that is as near in time to one before it in the answer, or to `moment`, is left out:
  /// neighbours of a moment are like it, and tell nothing new.
  Duration apart = std::chrono::seconds(1);
  /// Only the nearest moment of each recording.
  bool is_one_per_recording = false;
  /// No moments of the recording that `moment` is in.
  bool is_elsewhere = false;
  /// What came before is compared, too, as far back as this. With zero one image tells all. Of an
  /// `image` nothing is known before.
  Duration context = std::chrono::seconds(2);
  /// Takes an image of any size.
  bool takes_any_size = false;

  /// Errors: kInvalidArgument.
  [[nodiscard]] Status validate() const;
};

/// A moment like another one.
struct SimilarMoment {
  Time time{};
  /// 0: equal codes. 1: as different as two moments of this memory at random.
  double distance = 0;
  /// The first and the last moment of its recording.
  Time recording_first{};
  Time recording_last{};
};

struct SimilarAnswer {
  MemoryId entity;
  /// The space of its codes: "images 8c21fe03", "numbers".
  std::string space;
  bool is_stored_space = false;  ///< False also where numbers are compared, which need none.
  uint64_t compared = 0;         ///< Moments that were compared.
  uint64_t computed =
      0;  ///< Images that had to be decoded for it, because no night had coded them.
  std::vector<SimilarMoment> moments;  ///< The nearest first.
};

}  // namespace engram::ltm
