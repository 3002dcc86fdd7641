// SPDX-License-Identifier: Apache-2.0
#include "server/client/loan.h"

#include <memory>

#include "ltm/core/check.h"

namespace engram::server {

Status check_loan(std::span<const ArrayToLend> arrays) {
  for (const ArrayToLend& one : arrays)
    if (!idf::size_bytes(one.type, one.shape))
      return invalid_argument("loan: '{}': found a shape of {}, needs that of an array",
                              one.entity.to_string(), idf::to_string(one.shape));
  return {};
}

ltm::Commit commit_of(std::span<const ArrayToLend> arrays) {
  ltm::Commit commit;
  for (const ArrayToLend& one : arrays) commit.updates.push_back({one.entity, {}, {}});
  return commit;
}

Loan Loan::in_this_process(std::span<const ArrayToLend> arrays) {
  std::vector<Place> places;
  for (const ArrayToLend& one : arrays) {
    const size_t bytes = idf::size_bytes(one.type, one.shape).value_or(0);
    const auto memory = std::make_shared_for_overwrite<std::byte[]>(bytes);
    auto array = idf::NdArray::create(one.type, one.shape, Buffer(memory, {memory.get(), bytes}));
    ENGRAM_CHECK(array.ok(), "{}", array.status().message());
    places.push_back({{memory.get(), bytes}, *std::move(array)});
  }
  return {std::move(places), false};
}

}  // namespace engram::server
