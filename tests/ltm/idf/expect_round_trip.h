// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/idf/layout.h"
#include "tests/ltm/expect_status.h"

namespace engram::idf {

/// Expects that a layout splits this value into its members and joins them again.
inline void expect_round_trip(const Layout& layout, const Data& value) {
  const auto parts = layout.split(value);
  ASSERT_OK(parts);
  EXPECT_EQ(parts->tensors.size(), layout.members().size());
  const auto joined = layout.join(*parts);
  ASSERT_OK(joined);
  EXPECT_EQ(*joined, value);
}

}  // namespace engram::idf
