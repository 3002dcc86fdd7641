// SPDX-License-Identifier: Apache-2.0
#include "memory/live/redacted_commit.h"

#include <set>

namespace engram::memory {

namespace {

/// Who keeps bytes alive that must go.
using Owners = std::set<const void*>;

void copy_arrays(idf::Data& value, const Owners& of) {
  if (auto* array = value.get_if<idf::NdArray>()) {
    if (!of.contains(array->buffer().owner().get())) return;
    auto copy = idf::NdArray::create(array->type(), array->shape(), Buffer::copy(array->bytes()));
    ENGRAM_CHECK(copy.ok(), "{}", copy.status().message());
    *array = *std::move(copy);
  } else if (auto* list = value.get_if<idf::List>()) {
    for (idf::Data& each : *list) copy_arrays(each, of);
  } else if (auto* dict = value.get_if<idf::Dict>()) {
    // A dict gives values to be changed by their keys alone, which takes linear time for each.
    for (const idf::DictEntry& entry : *dict) copy_arrays(const_cast<idf::Data&>(entry.value), of);
  }
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
