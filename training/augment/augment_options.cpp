// SPDX-License-Identifier: Apache-2.0
#include "training/augment/augment_options.h"

namespace engram::training {

Status AugmentOptions::validate() const {
  ENGRAM_RETURN_IF_ERROR(AugmentedStoreOptions::validate());
  if (label < 0 || label > 65535)
    return invalid_argument("label: found {}, needs 0 (any) to 65535", label);
  if (mask_entity && !mask_entity->is_entity())
    return invalid_argument("mask '{}' is no entity: needs four names", mask_entity->to_string());
  for (const augmentation::ChangeChoice& choice : changes)
    if (choice.kind->needs_mask() && !mask_entity && members.labels.empty())
      return invalid_argument("change '{}': needs to be told where the object is (a mask)",
                              choice.kind->name());
  return {};
}

}  // namespace engram::training
