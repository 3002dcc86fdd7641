// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace engram::server {

/// The bit of an entity of a ring, by its place.
constexpr uint64_t bit_of_place(size_t place) {
  return uint64_t{1} << place;
}

/// The place of each bit, the lowest first: `for (const size_t place : RingPlaces(bits))`. A loop
/// and not a call of a lambda, so that the compiler sees which locks are held in it.
class RingPlaces {
 public:
  class Iterator {
   public:
    explicit Iterator(uint64_t bits) : bits_(bits) {}
    size_t operator*() const { return static_cast<size_t>(std::countr_zero(bits_)); }
    Iterator& operator++() {
      bits_ &= bits_ - 1;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return bits_ != other.bits_; }

   private:
    uint64_t bits_;
  };

  explicit RingPlaces(uint64_t bits) : bits_(bits) {}
  [[nodiscard]] Iterator begin() const { return Iterator(bits_); }
  [[nodiscard]] static Iterator end() { return Iterator(0); }

 private:
  uint64_t bits_;
};

}  // namespace engram::server
