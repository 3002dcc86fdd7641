// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/typed/convert_containers.h"
#include "ltm/typed/convert_value.h"

namespace engram::typed {

/// A generated struct. `for_each_member(visit)` calls visit(key, &Struct::member) for all members,
/// those of the base first, in the order of the type.
template <typename T>
concept Object = requires {
  { T::idf_type() } -> std::same_as<const idf::Type&>;
  T::for_each_member([](std::string_view, auto) {});
};

/// Casts `data` to `type`: members that the type does not have are dropped, and numbers are
/// widened.
/// Errors: kInvalidArgument listing by path everything that would be lost or is missing.
Result<idf::Data> fitted(const idf::Data& data, const idf::Type& type);

/// The error of a value that fits its type but not its C++ object: a text that is no link, an image
/// that OpenCV cannot hold.
Status unreadable(const idf::Data& data, const idf::Type& type);

template <Object T>
[[nodiscard]] idf::Data to_idf(const T& object) {
  return write(object, T::idf_type());
}

/// Reads an object from `data`. Members that T does not have are ignored.
/// Errors: kInvalidArgument listing by path what does not fit.
template <Object T>
Result<T> from_idf(const idf::Data& data) {
  // Casting walks the value and copies it, so it is only tried where reading fails.
  Result<T> object{T{}};
  if (read(data, T::idf_type(), *object)) return object;
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data fitting, fitted(data, T::idf_type()));
  *object = T{};
  if (read(fitting, T::idf_type(), *object)) return object;
  return unreadable(fitting, T::idf_type());
}

/// The value of `key`, or null where there is none. The key is almost always at `place`, where the
/// type has it, so it is tried first.
[[nodiscard]] inline const idf::Data* find_member(const idf::Dict& dict, size_t place,
                                                  std::string_view key) {
  if (place < dict.size())
    if (const idf::DictEntry& entry = dict.begin()[static_cast<ptrdiff_t>(place)]; entry.key == key)
      return &entry.value;
  return dict.find(key);
}

template <Object T>
struct Convert<T> {
  static idf::Data write(const T& value, const idf::Type& type) {
    const auto& members = type.get<idf::types::Object>().members;
    idf::Dict dict;
    dict.reserve(members.size());
    T::for_each_member([&](std::string_view key, auto member) {
      dict.append_unique(std::string(key), typed::write(value.*member, members[dict.size()].type));
    });
    return dict;
  }

  static bool read(const idf::Data& data, const idf::Type& type, T& value) {
    const auto* dict = data.get_if<idf::Dict>();
    const auto* needed = type.get_if<idf::types::Object>();
    bool fits = dict != nullptr && needed != nullptr;
    size_t place = 0;
    T::for_each_member([&](std::string_view key, auto member) {
      if (!fits) return;
      const idf::Data* found = find_member(*dict, place, key);
      fits = found != nullptr && typed::read(*found, needed->members[place].type, value.*member);
      ++place;
    });
    return fits;
  }

  static bool equal(const T& a, const T& b) {
    bool is_equal = true;
    T::for_each_member([&](std::string_view, auto member) {
      is_equal = is_equal && typed::equal(a.*member, b.*member);
    });
    return is_equal;
  }
};

}  // namespace engram::typed
