// SPDX-License-Identifier: Apache-2.0
#include "training/augment/augmented_store.h"

namespace engram::training {

Status AugmentedStoreOptions::validate() const {
  if (query.is_ids_only())
    return invalid_argument("query '{}' asks for IDs alone: needs data", query.to_string());
  if (copies < 1 || copies > kMaxCopies)
    return invalid_argument("copies: found {}, needs 1 to {}", copies, kMaxCopies);
  if (strength_percent < 1 || strength_percent > 100)
    return invalid_argument("strength: found {}, needs 1 to 100", strength_percent);
  if (hold < Duration::zero())
    return invalid_argument("time that a recipe holds: found {}, needs 0 or more", to_string(hold));
  return {};
}

}  // namespace engram::training
