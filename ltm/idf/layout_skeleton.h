// SPDX-License-Identifier: Apache-2.0
#pragma once

// Words in the skeleton of a Layout, which is stored: never change them.
namespace engram::idf {

/// First element of a list that is walked into; the places follow.
inline constexpr const char* kWalkedList = "list";

/// A place of the remainder that takes any value.
inline constexpr const char* kAnyRemainder = "any";

}  // namespace engram::idf
