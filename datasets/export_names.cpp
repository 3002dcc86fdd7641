// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_names.h"

#include <algorithm>

#include "ltm/store/checksum.h"
#include "ltm/store/segment_format.h"

namespace engram::datasets {

namespace {

/// File systems allow 255 bytes; the rest is left for extensions and numbers.
constexpr size_t kMaxNameBytes = 200;

std::string shortened(std::string name) {
  if (name.size() <= kMaxNameBytes) return name;
  const uint64_t sum = ltm::checksum(as_bytes(name));
  size_t end = kMaxNameBytes - 18;
  // Do not cut a UTF-8 character in two.
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
  return fmt::format("{}%~{:016x}", name.substr(0, end), sum);
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
