// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// Answers the conditions of a query on a store for who goes through the timelines of its entities
/// and needs no Recall. The store is opened, once, when the first condition is asked.
///
/// Threading: one thread.
class StoreConditions {
 public:
  StoreConditions(std::filesystem::path store, const Query& query)
      : store_(std::move(store)), is_named_(query.named_entities().has_value()) {}

  /// What lists the moments of an entity. Valid as long as this. It returns the errors of
  /// StoreReader::open and list_moments().
  [[nodiscard]] ListMoments of(const MemoryId& entity);

 private:
  const std::filesystem::path store_;
  const bool is_named_;
  std::unique_ptr<StorePast> past_;
};

}  // namespace engram::ltm
