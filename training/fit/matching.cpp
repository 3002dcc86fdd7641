// SPDX-License-Identifier: Apache-2.0
#include "training/fit/matching.h"

#include <algorithm>

#include "ltm/memory/query.h"

namespace engram::training {

Result<std::vector<ltm::MemoryId>> matching_entities(const ltm::StoreReader& reader,
                                                     std::span<const std::string> texts) {
  std::vector<ltm::Query> queries;
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Query query, ltm::Query::parse(text));
    queries.push_back(std::move(query));
  }
  std::vector<ltm::MemoryId> entities;
  for (const ltm::MemoryId& entity : reader.entities())
    if (queries.empty() || std::ranges::any_of(queries, [&](const ltm::Query& query) {
          return query.matches(entity);
        }))
      entities.push_back(entity);
  return entities;
}

}  // namespace engram::training
