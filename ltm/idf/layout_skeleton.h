// SPDX-License-Identifier: Apache-2.0
#pragma once

// Words in the skeleton of a Layout. The skeleton is stored: never change them.
namespace engram::idf {

/// The first element of a list that is split; its places follow.
inline constexpr const char* kWalkedList = "list";

/// A part of the remainder that takes any value.
inline constexpr const char* kAnyRemainder = "any";

}  // namespace engram::idf
