// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_format.h"

#include <gtest/gtest.h>

namespace engram::ltm {
namespace {

TEST(SegmentFormat, EscapesWhatHdf5AndFileSystemsDoNotCarry) {
  EXPECT_EQ(segment_name("head"), "head");
  EXPECT_EQ(segment_name("a/b"), "a%2Fb");
  EXPECT_EQ(segment_name("%"), "%25");
  EXPECT_EQ(segment_name("#1"), "%231");
  EXPECT_EQ(segment_name("."), "%2E");
  EXPECT_EQ(segment_name(".."), "%2E.");
  EXPECT_EQ(segment_name("cam.1"), "cam.1");
  EXPECT_EQ(segment_name("\n"), "%0A");
  EXPECT_EQ(segment_name(""), "%");
  EXPECT_EQ(segment_name("größe"), "größe");
}

TEST(SegmentFormat, GivesDifferentNamesDifferentPaths) {
  EXPECT_EQ(segment_group(*MemoryId::from_names({"a/b", "c", "d", "."})), "/a%2Fb/c/d/%2E");
  EXPECT_EQ(segment_member("a\\/b/c"), "/a%2Fb/c");
  EXPECT_EQ(segment_member("a/b/c"), "/a/b/c");
  EXPECT_EQ(segment_member(""), "/%");
}

TEST(SegmentFormat, ReadsTheNumberOfAFile) {
  EXPECT_EQ(segment_number("segments/000012.h5"), 12u);
  EXPECT_EQ(segment_number("1234567.h5"), 1234567u);
  for (const char* file :
       {"", "segments/", "x.h5", "12", "12.h5.new", "-1.h5", "99999999999999999999.h5"})
    EXPECT_EQ(segment_number(file), 0u) << file;
}

TEST(SegmentFormat, GroupsScalarsByElementType) {
  const idf::Layout layout = idf::Layout::of(
      idf::Dict{{"b", true}, {"i", 1}, {"d", 1.0}, {"a", idf::NdArray::take<float>({2}, {1, 2})}});
  EXPECT_EQ(scalar_group(layout.members()[0]), "bool");
  EXPECT_EQ(scalar_group(layout.members()[1]), "int32");
  EXPECT_EQ(scalar_group(layout.members()[2]), "float64");
  EXPECT_TRUE(is_scalar(layout.members()[0]));
  EXPECT_FALSE(is_scalar(layout.members()[3]));
}

}  // namespace
}  // namespace engram::ltm
