// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/idf/type_check.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A MemoryId inside a value.
struct Link {
  std::string path;  ///< The path of the string, as Data::at reads it.
  MemoryId id;

  friend bool operator==(const Link&, const Link&) = default;
};

/// All links of a value of `type`, in walk order: its MemoryLink members that are not empty. Parts
/// of the value that are not of their type and texts that are no MemoryId are skipped (see
/// check_links).
[[nodiscard]] std::vector<Link> find_links(const idf::Data& value, const idf::Type& type);

/// All strings that read as the ID of a snapshot or an instance, in walk order. Without a type this
/// is a guess: a text that happens to look like such an ID is taken for a link, and a link to an
/// entity is not found.
[[nodiscard]] std::vector<Link> find_links(const idf::Data& value);

/// The MemoryLink members whose text is no MemoryId. Empty texts are valid.
[[nodiscard]] std::vector<idf::Mismatch> check_links(const idf::Data& value, const idf::Type& type);

/// Returns the new ID of a link; nothing leaves the link as it is, its text included.
using Rewrite = std::function<std::optional<MemoryId>(const MemoryId&)>;

/// Returns `value` with its links replaced by what `rewrite` returns.
[[nodiscard]] idf::Data rewrite_links(idf::Data value, const idf::Type& type,
                                      const Rewrite& rewrite);
[[nodiscard]] idf::Data rewrite_links(idf::Data value, const Rewrite& rewrite);

/// Returns the value at an ID.
using Lookup = std::function<Result<idf::Data>(const MemoryId&)>;

/// A link and its target, or why the target is not available.
struct ResolvedLink {
  Link link;
  Result<idf::Data> target;
};

/// Follows every link one step; `lookup` is called once for each ID.
[[nodiscard]] std::vector<ResolvedLink> resolve_links(const std::vector<Link>& links,
                                                      const Lookup& lookup);

}  // namespace engram::ltm
