// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/convert_elements.h"

#include "ltm/idf/element_visit.h"

namespace engram::idf {

namespace {

template <typename To, typename From>
std::optional<Converted<NdArray>> convert_elements(const NdArray& array) {
  std::vector<To> values;
  values.reserve(static_cast<size_t>(array.count()));
  bool is_exact = true;
  for (const From from : array.values<From>()) {
    const auto converted = convert_number<To>(from);
    if (!converted) return std::nullopt;
    is_exact = is_exact && converted->is_exact;
    values.push_back(converted->value);
  }
  return Converted<NdArray>{NdArray::take<To>(array.shape(), std::move(values)), is_exact};
}

}  // namespace

std::optional<Converted<NdArray>> convert_array(const NdArray& array, ElementType element) {
  if (array.type() == element) return Converted<NdArray>{array};
  return visit_element_type(element, [&]<typename To>(To) {
    return visit_element_type(
        array.type(), [&]<typename From>(From) { return convert_elements<To, From>(array); });
  });
}

}  // namespace engram::idf
