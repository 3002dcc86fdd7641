// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/held_bytes.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <vector>

namespace engram::idf {
namespace {

/// Bytes of the heap that so many copies of a value take, each.
double measured_bytes(const Data& value) {
  constexpr size_t kCopies = 20'000;
  std::vector<Data> copies(kCopies);
  const size_t before = ::mallinfo2().uordblks;
  for (Data& copy : copies) copy = value;
  return static_cast<double>(::mallinfo2().uordblks - before) / kCopies + sizeof(Data);
}

/// The allocator rounds, and adds to each block.
TEST(HeldBytes, AreAboutWhatTheHeapGives) {
  if (::mallinfo2().uordblks == 0) GTEST_SKIP() << "another allocator tells nothing";
  Dict numbers;
  for (int i = 0; i < 20; ++i) numbers.set("joint " + std::to_string(i), 0.5 * i);
  const List texts{std::string(100, 'x'), "short", std::string(30, 'y')};
  for (const Data& value :
       {Data(1.0), Data("short"), Data(std::string(1000, 'x')), Data(numbers), Data(texts),
        Data(Dict{{"a", numbers}, {"b", texts}, {"a key that is longer than usual", 1.0}})}) {
    const double found = measured_bytes(value);
    EXPECT_GT(static_cast<double>(held_bytes(value)), 0.75 * found);
    EXPECT_LT(static_cast<double>(held_bytes(value)), 1.25 * found);
    EXPECT_EQ(element_bytes(value), 0U);
  }
}

TEST(HeldBytes, AreBesidesTheElementsOfArrays) {
  const auto array = NdArray::take<double>({100, 10}, std::vector<double>(1000));
  EXPECT_LT(held_bytes(array), 300U);
  EXPECT_EQ(element_bytes(array), 8000U);
  EXPECT_EQ(element_bytes(Dict{{"a", array}, {"b", List{array, 1.0}}}), 16'000U);
}

}  // namespace
}  // namespace engram::idf
