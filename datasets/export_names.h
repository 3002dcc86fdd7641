// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/memory/memory_id.h"

namespace engram::datasets {

/// A name as part of a path: `/`, `%`, `#`, a leading `.` and control characters become %XX; what
/// is longer than file systems take is cut and ends in `%~` and its checksum. Never empty, `.` or
/// `..`; different names stay different.
[[nodiscard]] std::string export_name(std::string_view name);

/// "Memory/Core/Provider/Entity", each as export_name.
[[nodiscard]] std::string export_folder(const ltm::MemoryId& entity);

/// The path of a member as one name: its keys joined by `.` (inside a key: %2E). The value itself
/// is "value".
[[nodiscard]] std::string export_member(std::string_view path);

/// "2022-02-18T13-06-56.492182": a time that every file system takes; in the order of time.
[[nodiscard]] std::string export_time(Time time);

/// "2022-02-18T13:06:56.492182Z".
[[nodiscard]] std::string iso_time(Time time);

}  // namespace engram::datasets
