// SPDX-License-Identifier: Apache-2.0
#include "server/names/registration.h"

#include <algorithm>
#include <set>

#include "ltm/core/utf8.h"

namespace engram::server {

namespace {

bool has_control_characters(std::string_view text) {
  return std::ranges::any_of(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

Status check_text(std::string_view what, std::string_view text, size_t max_bytes) {
  if (text.empty()) return invalid_argument("{} is empty", what);
  if (text.size() > max_bytes)
    return invalid_argument("{} has {} bytes, at most {} are taken", what, text.size(), max_bytes);
  if (!is_utf8(text)) return invalid_argument("{} is no UTF-8", what);
  return {};
}

Status check_printed(std::string_view what, std::string_view text, size_t max_bytes) {
  ENGRAM_RETURN_IF_ERROR(check_text(what, text, max_bytes));
  if (has_control_characters(text)) return invalid_argument("{} has control characters", what);
  return {};
}

Status check_count(std::string_view what, size_t count, size_t max) {
  if (count > max) return invalid_argument("has {} {}, at most {} are taken", count, what, max);
  return {};
}

Status check_unique(std::string_view what, const std::vector<std::string>& texts) {
  std::set<std::string_view> seen;
  for (const std::string& text : texts)
    if (!seen.insert(text).second) return invalid_argument("has {} '{}' twice", what, text);
  return {};
}

Status check_lists(const Registration& registration, const RegistrationLimits& limits) {
  ENGRAM_RETURN_IF_ERROR(check_count("memories", registration.memories.size(), limits.memories));
  ENGRAM_RETURN_IF_ERROR(check_count("endpoints", registration.endpoints.size(), limits.endpoints));
  if (registration.endpoints.empty()) return invalid_argument("has no endpoint, needs one");
  for (const std::string& memory : registration.memories)
    ENGRAM_RETURN_IF_ERROR(check_text("the name of a memory", memory, limits.text_bytes));
  for (const std::string& endpoint : registration.endpoints)
    ENGRAM_RETURN_IF_ERROR(check_printed("an endpoint", endpoint, limits.text_bytes));
  ENGRAM_RETURN_IF_ERROR(check_unique("memory", registration.memories));
  return check_unique("endpoint", registration.endpoints);
}

}  // namespace

Status RegistrationLimits::validate() const {
  if (memories == 0 || endpoints == 0 || text_bytes == 0)
    return invalid_argument(
        "registration limits: found {} memories, {} endpoints, {} bytes, "
        "needs more than 0 of each",
        memories, endpoints, text_bytes);
  return {};
}

bool Registration::holds(std::string_view memory) const {
  return std::ranges::find(memories, memory) != memories.end();
}

Status Registration::check(const RegistrationLimits& limits) const {
  if (Status status = check_printed("its name", server, limits.text_bytes); !status.ok())
    return status.with_context("registration of a server");
  if (Status status = check_lists(*this, limits); !status.ok())
    return status.with_context(fmt::format("registration of server '{}'", server));
  return {};
}

}  // namespace engram::server
