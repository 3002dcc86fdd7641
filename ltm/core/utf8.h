// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace engram {

/// A character and the number of its bytes.
struct Utf8Character {
  char32_t code = 0;
  size_t bytes = 0;  ///< Zero where there is no well-formed character.
};

/// The character at the start of `text`, which must not be empty. Overlong forms, surrogates and
/// codes above U+10FFFF are not well-formed.
[[nodiscard]] Utf8Character first_character(std::string_view text);

/// The beginning of a text: at most `max_bytes`, and no character cut in two.
[[nodiscard]] std::string_view cut_utf8(std::string_view text, size_t max_bytes);

/// True where all of `text` is well-formed UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace engram
