// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace engram::datasets::lerobot {

/// Returns the text of parquet_to_csv.py.
[[nodiscard]] std::string_view parquet_script();

}  // namespace engram::datasets::lerobot
