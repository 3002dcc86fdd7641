// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_forget.h"

#include <functional>
#include <optional>
#include <set>
#include <string_view>
#include <variant>

#include "ltm/core/printable.h"
#include "ltm/memory/query.h"

namespace engram::datasets::vault {

namespace {

using IsNamed = std::function<bool(const ltm::MemoryId& entity, Day day, const VaultDay& kept)>;

/// True if a selector selects any moment of a day; nothing for selectors that depend on what else
/// there is.
std::optional<bool> selects(const ltm::Selector& selector, Day day, const VaultDay& kept) {
  if (std::holds_alternative<ltm::select::All>(selector)) return true;
  if (const auto* at = std::get_if<ltm::select::At>(&selector)) return day_of(at->time) == day;
  if (const auto* range = std::get_if<ltm::select::TimeRange>(&selector))
    return range->first <= kept.last && range->last >= kept.first;
  return std::nullopt;
}

Result<IsNamed> named_by_query(const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
  for (const auto& memory : query.memories())
    for (const auto& core : memory.below)
      for (const auto& provider : core.below)
        for (const auto& entity : provider.below)
          for (const auto& snapshots : entity.below)
            if (!snapshots.conditions.empty() || !selects(snapshots.selector, 0, {}))
              return invalid_argument(
                  "'{}': selects by what else there is, needs a day, a time, a range of times or "
                  "all",
                  printable(text));
  return IsNamed([query](const ltm::MemoryId& entity, Day day, const VaultDay& kept) {
    for (const auto& snapshots : query.snapshots_of(entity))
      if (selects(snapshots.selector, day, kept).value_or(false)) return true;
    return false;
  });
}

std::string_view without_spaces(std::string_view text) {
  const size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// Reads "NAMES @ DAY" and "NAMES @ DAY..DAY"; nothing if it is neither.
Result<std::optional<IsNamed>> named_by_days(const std::string& text) {
  const size_t at = text.rfind('@');
  if (at == std::string::npos) return std::optional<IsNamed>();
  const std::string_view days = without_spaces(std::string_view(text).substr(at + 1));
  const size_t dots = days.find("..");
  const auto first = parse_day(days.substr(0, dots));
  const auto last = dots == std::string_view::npos ? first : parse_day(days.substr(dots + 2));
  if (!first.ok() || !last.ok()) return std::optional<IsNamed>();
  if (*last < *first) return invalid_argument("'{}': ends before it begins", printable(text));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query names, ltm::Query::parse(text.substr(0, at) + "@ all"));
  return std::optional(IsNamed(
      [names, from = *first, to = *last](const ltm::MemoryId& entity, Day day, const VaultDay&) {
        return from <= day && day <= to && names.matches(entity);
      }));
}

std::optional<IsNamed> named_by_id(const std::string& text) {
  const auto id = ltm::MemoryId::parse(text);
  // The empty ID would be everything, which nobody means with an empty argument.
  if (!id.ok() || id->depth() == 0) return std::nullopt;
  return [id = *id](const ltm::MemoryId& entity, Day day, const VaultDay&) {
    if (!id.time()) return id.is_prefix_of(entity);
    return id.entity() == entity && day_of(*id.time()) == day;
  };
}

std::set<EntityDay> days_that(const VaultKeys& keys, const IsNamed& is_named) {
  std::set<EntityDay> found;
  for (const auto& [entity, days] : keys.days)
    for (const auto& [day, kept] : days)
      if (is_named(entity, day, kept)) found.insert({entity, day});
  return found;
}

Result<std::set<EntityDay>> days_of_text(const VaultKeys& keys, const std::string& text) {
  std::set<EntityDay> found;
  // A name may have an @ in it, so IDs come first.
  if (const auto by_id = named_by_id(text)) found = days_that(keys, *by_id);
  if (!found.empty() || text.find('@') == std::string::npos) return found;
  ENGRAM_ASSIGN_OR_RETURN(const auto by_days, named_by_days(text));
  if (by_days) return days_that(keys, *by_days);
  ENGRAM_ASSIGN_OR_RETURN(const IsNamed by_query, named_by_query(text));
  return days_that(keys, by_query);
}

}  // namespace

Result<std::vector<EntityDay>> find_vault_days(const VaultKeys& keys,
                                               const std::vector<std::string>& texts) {
  std::set<EntityDay> all;
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, days_of_text(keys, text));
    if (found.empty())
      return not_found(
          "'{}': names no day that there is a key of; needs a memory ID, or names and a day as in "
          "'Vision @ 2022-02-18'",
          printable(text));
    all.insert(found.begin(), found.end());
  }
  return std::vector<EntityDay>(all.begin(), all.end());
}

}  // namespace engram::datasets::vault
