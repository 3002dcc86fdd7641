// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/segment_column.h"

namespace engram::ltm {

/// Format of segment files. Source: docs/format.md, section "Segment".
inline constexpr int kSegmentFormatVersion = 1;

/// The dataset with the types of a file's entities. No memory can have this name.
inline constexpr const char* kSegmentTypes = "/#types";

/// Most rows whose remainders are packed together, and about the most plain bytes of them.
inline constexpr size_t kRemainderBlockRows = 128;
inline constexpr size_t kRemainderBlockBytes = size_t{8} << 20;

/// The path of an entity's group in a segment: its four names, each as segment_name.
[[nodiscard]] std::string segment_group(const MemoryId& entity);

/// A name as HDF5 and file systems carry it: `/`, `%`, `#`, a leading `.` and control characters
/// become %XX.
[[nodiscard]] std::string segment_name(std::string_view name);

/// The path of a member below a group: each part of `path` as segment_name.
[[nodiscard]] std::string segment_member(std::string_view path);

/// The number of "segments/000012.h5"; 0 for other names.
[[nodiscard]] uint64_t segment_number(const std::string& file);

/// True for members that share a matrix per element type.
[[nodiscard]] bool is_scalar(const idf::TensorMember& member);

/// The name of that matrix below `columns`: "float64", "bool", ...
[[nodiscard]] std::string scalar_group(const idf::TensorMember& member);

}  // namespace engram::ltm
