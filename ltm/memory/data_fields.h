// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"

namespace engram::ltm {

/// Reads the members of a dict that came from outside. Every kind is checked; members that are not
/// read are ignored.
///
/// Errors: kInvalidArgument naming the object, the member, what was found and what was needed.
/// Threading: immutable; the data must outlive it.
class DataFields {
 public:
  /// `what` names the object in messages, for example "commit"; it must outlive this object.
  static Result<DataFields> of(const idf::Data& data, std::string_view what);

  [[nodiscard]] bool has(std::string_view key) const { return dict_->find(key) != nullptr; }

  /// The member without a conversion.
  Result<const idf::Data*> data(std::string_view key) const;
  Result<const idf::List*> list(std::string_view key) const;
  Result<std::string> text(std::string_view key) const;
  /// An int32 or int64.
  Result<int64_t> integer(std::string_view key) const;
  Result<bool> boolean(std::string_view key) const;
  /// Any kind of number.
  Result<double> number(std::string_view key) const;
  /// Nanoseconds since 1970.
  Result<Time> time(std::string_view key) const;
  /// An int32 that is not negative.
  Result<int32_t> instance_index(std::string_view key) const;

 private:
  DataFields(const idf::Dict& dict, std::string_view what) : dict_(&dict), what_(what) {}

  [[nodiscard]] Status unfitting(std::string_view key, std::string_view needed) const;

  const idf::Dict* dict_;
  std::string_view what_;
};

}  // namespace engram::ltm
