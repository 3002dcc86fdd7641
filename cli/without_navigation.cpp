// SPDX-License-Identifier: Apache-2.0
// Replaces the navigation of the live kitchen in a program that is built without ENGRAM_NAVIGATION.
#include "cli/kitchen_drive.h"

namespace engram::cli {

Result<std::unique_ptr<KitchenNavigation>> KitchenNavigation::start(Memory& /*memory*/) {
  return failed_precondition("this program was built without navigation");
}

}  // namespace engram::cli
