// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ltm/idf/type.h"

namespace engram::idf {

namespace {

Result<Type> type_at(const Data& data, int depth);

struct TypeOf {
  int depth;

  Result<Type> operator()(None) const { return Type::string().optional(); }
  Result<Type> operator()(bool) const { return Type::boolean(); }
  Result<Type> operator()(int32_t) const { return Type::int32(); }
  Result<Type> operator()(int64_t) const { return Type::int64(); }
  Result<Type> operator()(float) const { return Type::float32(); }
  Result<Type> operator()(double) const { return Type::float64(); }
  Result<Type> operator()(const std::string&) const { return Type::string(); }
  Result<Type> operator()(const NdArray& array) const {
    return Type::create(types::NdArray{array.type(), array.shape(), {}});
  }
  Result<Type> operator()(const List& list) const {
    std::vector<Type> elements;
    for (const Data& element : list) {
      ENGRAM_ASSIGN_OR_RETURN(Type type, type_at(element, depth + 1));
      elements.push_back(std::move(type));
    }
    const bool is_uniform = !elements.empty() && std::ranges::all_of(elements, [&](const Type& t) {
      return t == elements.front();
    });
    if (is_uniform) return Type::create(types::List{elements.front()});
    return Type::create(types::Tuple{std::move(elements)});
  }
  Result<Type> operator()(const Dict& dict) const {
    types::Object object;
    for (const auto& [key, value] : dict) {
      ENGRAM_ASSIGN_OR_RETURN(Type type, type_at(value, depth + 1));
      object.own_members.push_back({key, std::move(type)});
    }
    return Type::create(std::move(object));
  }
};

Result<Type> type_at(const Data& data, int depth) {
  if (depth > kMaxTypeDepth)
    return invalid_argument("value nests deeper than {} levels, its type cannot", kMaxTypeDepth);
  return std::visit(TypeOf{depth}, data.value());
}

}  // namespace

Result<Type> type_of(const Data& data) {
  return type_at(data, 1);
}

}  // namespace engram::idf
