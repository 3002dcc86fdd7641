// SPDX-License-Identifier: Apache-2.0
#include "memory/live/redacted_commit.h"

#include <set>

#include "ltm/idf/value_walk.h"

namespace engram::memory {

namespace {

/// Who keeps bytes alive that must go.
using Owners = std::set<const void*>;

void copy_arrays(idf::Data& value, const Owners& of) {
  idf::walk_values(value, [&of](const std::string&, idf::Data& each) {
    auto* array = each.get_if<idf::NdArray>();
    if (array == nullptr || !of.contains(array->buffer().owner().get())) return;
    auto copy = idf::NdArray::create(array->type(), array->shape(), Buffer::copy(array->bytes()));
    ENGRAM_CHECK(copy.ok(), "{}", copy.status().message());
    *array = *std::move(copy);
  });
}

void add_owners(idf::Data& value, Owners& to) {
  idf::walk_values(value, [&to](const std::string&, idf::Data& each) {
    if (const auto* array = each.get_if<idf::NdArray>()) to.insert(array->buffer().owner().get());
  });
}

bool is_in_any(const std::vector<Buffer>& buffers, const Owners& of) {
  return std::ranges::any_of(buffers,
                             [&of](const Buffer& each) { return of.contains(each.owner().get()); });
}

}  // namespace

void redact(ltm::Redactor& redactor, ltm::Commit& commit,
            std::vector<std::vector<Buffer>>& encoded) {
  Owners owners;
  std::vector<ltm::EntityUpdate> updates;
  std::vector<std::vector<Buffer>> bytes;
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    ltm::EntityUpdate& update = commit.updates[i];
    const ltm::RedactionOutcome outcome = redactor.redact(update);
    for (const Buffer& original : outcome.originals) owners.insert(original.owner().get());
    if (outcome.is_dropped()) {
      // Other updates may lie in the same block of bytes.
      for (ltm::Instance& instance : update.instances) add_owners(instance.data, owners);
      if (!encoded.empty())
        for (const Buffer& came : encoded[i]) owners.insert(came.owner().get());
      continue;
    }
    updates.push_back(std::move(update));
    if (encoded.empty()) continue;
    bytes.push_back(outcome.redacted > 0 ? std::vector<Buffer>() : std::move(encoded[i]));
  }
  commit.updates = std::move(updates);
  encoded = std::move(bytes);
  owners.erase(nullptr);
  if (owners.empty()) return;
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    for (ltm::Instance& instance : commit.updates[i].instances) copy_arrays(instance.data, owners);
    if (!encoded.empty() && is_in_any(encoded[i], owners)) encoded[i].clear();
  }
}

}  // namespace engram::memory
