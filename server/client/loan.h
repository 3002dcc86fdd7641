// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "ltm/memory/commit.h"

namespace engram::server {

/// An array that a program is going to commit, as the one instance of a snapshot.
struct ArrayToLend {
  ltm::MemoryId entity;
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;
};

/// Memory that is lent for the arrays of one commit: a program writes them there, and commits
/// array(0), array(1), ... of their entities in this order.
///
/// It may be written until the commit. Afterwards what the arrays view may change at any time; it
/// stays readable as long as a copy of one lives. What was not committed goes back with the last
/// copy.
/// Threading: one thread.
/// Source: docs/sensory.md, "Nothing is copied".
class Loan {
 public:
  struct Place {
    std::span<std::byte> bytes;
    idf::NdArray array;  ///< Views these bytes.
  };

  Loan(std::vector<Place> places, bool is_in_ring)
      : places_(std::move(places)), is_in_ring_(is_in_ring) {}

  /// Needs arrays that check_loan() accepts.
  static Loan in_this_process(std::span<const ArrayToLend> arrays);

  [[nodiscard]] size_t size() const { return places_.size(); }
  /// Where the elements of an array go, aligned for any of their types.
  [[nodiscard]] std::span<std::byte> bytes(size_t i) const { return places_[i].bytes; }
  [[nodiscard]] const idf::NdArray& array(size_t i) const { return places_[i].array; }
  /// Whether the commit copies nothing, if it is committed as it was lent.
  [[nodiscard]] bool is_in_ring() const { return is_in_ring_; }

 private:
  std::vector<Place> places_;
  bool is_in_ring_;
};

/// Errors: kInvalidArgument naming the entity, for a shape that no array can have.
Status check_loan(std::span<const ArrayToLend> arrays);

/// A commit of these entities, without values.
[[nodiscard]] ltm::Commit commit_of(std::span<const ArrayToLend> arrays);

}  // namespace engram::server
