// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/text_value.h"

#include "ltm/core/utf8.h"

namespace engram::datasets {

idf::Data text_value(std::string_view text) {
  if (is_utf8(text)) return text;
  return idf::NdArray::take<uint8_t>({static_cast<int64_t>(text.size())},
                                     {text.begin(), text.end()});
}

std::string text_of(const idf::Data* value) {
  if (value == nullptr) return {};
  if (const auto* text = value->get_if<std::string>()) return *text;
  if (const auto* bytes = value->get_if<idf::NdArray>())
    return std::string(as_text(bytes->bytes()));
  return {};
}

}  // namespace engram::datasets
