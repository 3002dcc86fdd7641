// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <map>
#include <optional>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/memory/query_builder.h"

namespace engram::ltm {

namespace {

constexpr std::string_view kIdsOnly = "?ids";

/// True where a backslash makes the last character, a space, a part of a name.
bool is_end_escaped(std::string_view text) {
  text.remove_suffix(1);
  size_t backslashes = 0;
  for (; text.ends_with('\\'); text.remove_suffix(1)) ++backslashes;
  return backslashes % 2 == 1;
}

std::string_view trim_unescaped(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ') && !is_end_escaped(text)) text.remove_suffix(1);
  return text;
}

/// Splits at each `separator` without a backslash before it.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  size_t start = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == separator) {
      parts.push_back(text.substr(start, i - start));
      start = i + 1;
    }
  }
  parts.push_back(text.substr(start));
  return parts;
}

/// Splits at commas, but not at those of the point of `near 1,2,3 0.5m`.
std::vector<std::string_view> split_selectors(std::string_view text) {
  std::vector<std::string_view> selectors;
  for (const std::string_view part : split(text, ',')) {
    if (!selectors.empty() && ends_in_a_point(selectors.back())) {
      std::string_view& last = selectors.back();
      last = {last.data(), static_cast<size_t>(part.data() + part.size() - last.data())};
    } else {
      selectors.push_back(part);
    }
  }
  return selectors;
}

/// The position of the `@` that starts the selectors: at the start, or after a space. npos where
/// there is none. An `@` inside a name, as in an e-mail address, starts none.
size_t find_selectors(std::string_view branch) {
  bool is_after_space = true;
  for (size_t i = 0; i < branch.size(); ++i) {
    if (branch[i] == '@' && is_after_space) return i;
    is_after_space = branch[i] == ' ';
    if (branch[i] == '\\') ++i;
  }
  return std::string_view::npos;
}

class QueryParser {
 public:
  explicit QueryParser(std::string_view text) : text_(text) {}

  Result<Query> parse() {
    std::string_view rest = trim_unescaped(text_);
    const std::string_view flagged = rest.substr(0, kIdsOnly.size() + 1);
    const bool is_ids_only = flagged == kIdsOnly || flagged == "?ids ";
    if (is_ids_only) rest = trim_unescaped(rest.substr(kIdsOnly.size()));
    QueryBuilder builder(is_ids_only);
    const std::vector<std::string_view> branches = split(rest, ';');
    for (const std::string_view branch : branches) {
      if (branches.size() > 1 && trim_unescaped(branch).empty())
        return at(branch, invalid_argument("nothing beside ';': needs NAMES @ SELECTOR"));
      ENGRAM_RETURN_IF_ERROR(parse_branch(trim_unescaped(branch), builder));
    }
    return std::move(builder).take();
  }

  /// Reads the whole text as selectors of the entities that `names` match.
  Status parse_selectors(const QueryPath& names, QueryBuilder& builder) {
    return parse_selectors(text_, names, builder);
  }

 private:
  /// Adds the text and the position to an error; positions count bytes from 1.
  /// A part is a view of the text, so its address gives its position.
  [[nodiscard]] Status at(std::string_view part, const Status& status) const {
    return status.with_context(
        fmt::format("query '{}' at {}", text_, part.data() - text_.data() + 1));
  }

  Status parse_branch(std::string_view branch, QueryBuilder& builder) {
    const size_t selectors = find_selectors(branch);
    ENGRAM_ASSIGN_OR_RETURN(const QueryPath names,
                            parse_names(trim_unescaped(branch.substr(0, selectors))));
    if (selectors == std::string_view::npos) return add(branch, names, {}, builder);
    return parse_selectors(branch.substr(selectors + 1), names, builder);
  }

  Status parse_selectors(std::string_view selectors, const QueryPath& names,
                         QueryBuilder& builder) {
    for (const std::string_view selector : split_selectors(selectors)) {
      ENGRAM_ASSIGN_OR_RETURN(SnapshotQuery snapshots, parse_snapshots(trim_unescaped(selector)));
      ENGRAM_RETURN_IF_ERROR(add(selector, names, std::move(snapshots), builder));
    }
    return {};
  }

  Status add(std::string_view part, const QueryPath& names, SnapshotQuery snapshots,
             QueryBuilder& builder) const {
    const Status added = builder.add(names, std::move(snapshots));
    return added.ok() ? added : at(part, added);
  }

  Result<QueryPath> parse_names(std::string_view names) {
    QueryPath path;
    if (names.empty()) return path;
    const std::vector<std::string_view> levels = split(names, '/');
    if (levels.size() > path.size())
      return at(names, invalid_argument("has {} name levels, at most 4 are known; the time goes "
                                        "behind '@'",
                                        levels.size()));
    for (size_t i = 0; i < levels.size(); ++i) {
      auto pattern = parse_pattern(levels[i]);
      if (!pattern.ok()) return at(levels[i], pattern.status());
      path[i] = *std::move(pattern);
    }
    return path;
  }

  /// Compiles an expression once, also where many branches repeat it.
  Result<NamePattern> parse_pattern(std::string_view text) {
    if (const auto known = patterns_.find(text); known != patterns_.end()) return known->second;
    ENGRAM_ASSIGN_OR_RETURN(NamePattern pattern, NamePattern::parse(text));
    return patterns_.emplace(text, std::move(pattern)).first->second;
  }

  Result<SnapshotQuery> parse_snapshots(std::string_view text) {
    SnapshotQuery snapshots;
    if (const size_t begin = find_conditions(text); begin != std::string_view::npos) {
      auto conditions = parse_conditions(text.substr(begin));
      if (!conditions.ok()) return at(text.substr(begin), conditions.status());
      snapshots.conditions = *std::move(conditions);
      text = trim_unescaped(text.substr(0, begin));
    }
    const std::vector<std::string_view> parts = split(text, '#');
    auto selector = parse_selector(parts.front());
    if (!selector.ok()) return at(text, selector.status());
    snapshots.selector = *selector;
    for (size_t i = 1; i < parts.size(); ++i) {
      const std::string_view part = trim_unescaped(parts[i]);
      int32_t index = 0;
      const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc() || end != part.data() + part.size() || index < 0)
        return at(parts[i],
                  invalid_argument("'{}' is no instance index: needs a number from 0 on", part));
      snapshots.instances.push_back(index);
    }
    return snapshots;
  }

  std::string_view text_;
  std::map<std::string_view, NamePattern> patterns_;
};

/// Prints one branch per entity level.
class QueryPrinter {
 public:
  void print(const std::vector<MemoryQuery>& memories) { print_level(memories, ""); }

  std::string text;

 private:
  template <typename Below>
  void print_level(const std::vector<NameQuery<Below>>& level, const std::string& above) {
    for (const NameQuery<Below>& query : level) {
      const std::string names = above + query.name.to_string();
      if constexpr (std::is_same_v<Below, SnapshotQuery>)
        print_branch(names, query.below);
      else
        print_level(query.below, names + "/");
    }
  }

  void print_branch(const std::string& names, const std::vector<SnapshotQuery>& snapshots) {
    text += (text.empty() ? "" : " ; ") + names + " @ ";
    for (size_t i = 0; i < snapshots.size(); ++i) {
      text += (i == 0 ? "" : ", ") + to_string(snapshots[i].selector);
      for (const int32_t index : snapshots[i].instances) text += fmt::format("#{}", index);
      for (const Condition& condition : snapshots[i].conditions)
        text += " " + ltm::to_string(condition);
    }
  }
};

}  // namespace

Result<Query> Query::parse(std::string_view text) {
  return QueryParser(text).parse();
}

Result<Query> Query::of_entity(const MemoryId& entity, std::string_view snapshots,
                               bool is_ids_only) {
  if (!entity.is_entity())
    return invalid_argument("'{}' is no entity: needs memory/core/provider/entity",
                            entity.to_string());
  QueryBuilder builder(is_ids_only);
  ENGRAM_RETURN_IF_ERROR(QueryParser(snapshots).parse_selectors(path_of(entity), builder));
  return std::move(builder).take();
}

std::string Query::to_string() const {
  QueryPrinter printer;
  printer.print(memories_);
  return (is_ids_only_ ? std::string(kIdsOnly) + " " : "") + printer.text;
}

}  // namespace engram::ltm
