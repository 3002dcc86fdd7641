// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_names.h"

#include <algorithm>

#include "ltm/core/utf8.h"
#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"

namespace engram::datasets {

namespace {

/// File systems allow 255 bytes; the rest is left for extensions and numbers.
constexpr size_t kMaxNameBytes = 200;

std::string shortened(std::string name) {
  if (name.size() <= kMaxNameBytes) return name;
  const uint64_t sum = ltm::checksum(as_bytes(name));
  return fmt::format("{}%~{:016x}", cut_utf8(name, kMaxNameBytes - 18), sum);
}

}  // namespace

std::string export_name(std::string_view name) {
  return shortened(ltm::segment_name(name));
}

std::string export_folder(const ltm::MemoryId& entity) {
  std::string folder;
  for (const std::string& name : entity.names())
    folder += (folder.empty() ? "" : "/") + export_name(name);
  return folder;
}

std::string export_member(std::string_view path) {
  if (path.empty()) return "value";
  std::string member;
  for (const std::string& key : idf::split_path(path)) {
    if (!member.empty()) member += '.';
    for (const char c : ltm::segment_name(key)) member += c == '.' ? "%2E" : std::string(1, c);
  }
  return shortened(std::move(member));
}

std::string export_time(Time time) {
  std::string name = to_string(time);
  std::ranges::replace(name, ' ', 'T');
  std::ranges::replace(name, ':', '-');
  return name;
}

std::string iso_time(Time time) {
  std::string text = to_string(time) + "Z";
  std::ranges::replace(text, ' ', 'T');
  return text;
}

}  // namespace engram::datasets
