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
  std::string path;  ///< Where the string stands, as Data::at reads it.
  MemoryId id;

  friend bool operator==(const Link&, const Link&) = default;
};

/// All links of a value of `type`, in walk order: its MemoryLink members that are not empty. Where
/// the value is not of its type, and where a text is no MemoryId, there is none (see check_links).
[[nodiscard]] std::vector<Link> find_links(const idf::Data& value, const idf::Type& type);

/// All strings that read as the ID of a snapshot or an instance, in walk order. Without a type this
/// is a guess: text that looks like such an ID is taken for one, a link to an entity is not found.
[[nodiscard]] std::vector<Link> find_links(const idf::Data& value);

/// The MemoryLink members whose text is no MemoryId; empty texts are fine.
[[nodiscard]] std::vector<idf::Mismatch> check_links(const idf::Data& value, const idf::Type& type);

/// What a link becomes; nothing: it stays as it is, its text included.
using Rewrite = std::function<std::optional<MemoryId>(const MemoryId&)>;

/// `value` with its links replaced by what `rewrite` says.
[[nodiscard]] idf::Data rewrite_links(idf::Data value, const idf::Type& type,
                                      const Rewrite& rewrite);
[[nodiscard]] idf::Data rewrite_links(idf::Data value, const Rewrite& rewrite);

/// Finds what an ID means.
using Lookup = std::function<Result<idf::Data>(const MemoryId&)>;

/// A link and what it leads to, or why that is not to be had.
struct ResolvedLink {
  Link link;
  Result<idf::Data> target;
};

/// Follows every link one step; `lookup` is asked once for each ID.
[[nodiscard]] std::vector<ResolvedLink> resolve_links(const std::vector<Link>& links,
                                                      const Lookup& lookup);

}  // namespace engram::ltm
