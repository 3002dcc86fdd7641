// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/memory/memory_id.h"

namespace engram::datasets {

/// Turns a name into a part of a path. `/`, `%`, `#`, a leading `.` and control characters become
/// %XX. A name that is too long for file systems is cut and ends in `%~` and its checksum. The
/// result is never empty, `.` or `..`, and different names stay different.
[[nodiscard]] std::string export_name(std::string_view name);

/// Returns "Memory/Core/Provider/Entity", with export_name applied to each part.
[[nodiscard]] std::string export_folder(const ltm::MemoryId& entity);

/// Turns the path of a member into one name: its keys joined by `.` (inside a key: %2E). The path
/// of the value itself becomes "value".
[[nodiscard]] std::string export_member(std::string_view path);

/// Returns "2022-02-18T13-06-56.492182", which every file system accepts and which sorts by time.
[[nodiscard]] std::string export_time(Time time);

/// Returns "2022-02-18T13:06:56.492182Z".
[[nodiscard]] std::string iso_time(Time time);

}  // namespace engram::datasets
