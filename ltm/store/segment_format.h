// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/layout.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/segment_column.h"

namespace engram::ltm {

/// Newest format of segment files, and that of files without shared groups.
/// Source: docs/format.md, section "Segment".
inline constexpr int kSegmentFormatVersion = 2;
inline constexpr int kFirstSegmentFormatVersion = 1;

/// Path of the dataset with the types of a file's entities. No memory can have this name.
inline constexpr const char* kSegmentTypes = "/#types";

/// Max number of rows whose remainders are packed together, and approximate max plain size of such
/// a block in bytes.
inline constexpr size_t kRemainderBlockRows = 128;
inline constexpr size_t kRemainderBlockBytes = size_t{8} << 20;

/// The path of an entity's group in a segment: its four names, each escaped by segment_name.
[[nodiscard]] std::string segment_group(const MemoryId& entity);

/// Escapes a name for HDF5 and file systems: `/`, `%`, `#`, a leading `.` and control characters
/// become %XX.
[[nodiscard]] std::string segment_name(std::string_view name);

/// The path of a member below a group: each part of `path`, escaped by segment_name.
[[nodiscard]] std::string segment_member(std::string_view path);

/// The number of "segments/000012.h5"; 0 for other names.
[[nodiscard]] uint64_t segment_number(const std::string& file);

/// True for scalar members. Those of one element type share a matrix.
[[nodiscard]] bool is_scalar(const idf::TensorMember& member);

/// The name of that matrix below `columns`: "float64", "bool", ...
[[nodiscard]] std::string scalar_group(const idf::TensorMember& member);

}  // namespace engram::ltm
