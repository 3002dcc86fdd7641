// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"

namespace engram::ltm {

/// Reads the members of a dict that came from outside: every kind is checked, members that nobody
/// asks for are ignored.
///
/// Errors: kInvalidArgument naming the object, the member, what was found and what was needed.
/// Threading: immutable; the data must outlive it.
class DataFields {
 public:
  /// `what` names the object in messages, as "commit"; it must outlive this.
  static Result<DataFields> of(const idf::Data& data, std::string_view what);

  [[nodiscard]] bool has(std::string_view key) const { return dict_->find(key) != nullptr; }

  /// The member as it is.
  Result<const idf::Data*> data(std::string_view key) const;
  Result<const idf::List*> list(std::string_view key) const;
  Result<std::string> text(std::string_view key) const;
  /// Of int32 or int64.
  Result<int64_t> integer(std::string_view key) const;
  Result<bool> boolean(std::string_view key) const;
  /// Of any kind of number.
  Result<double> number(std::string_view key) const;
  /// Nanoseconds since 1970.
  Result<Time> time(std::string_view key) const;
  /// From 0 on, within 31 bits.
  Result<int32_t> instance_index(std::string_view key) const;

 private:
  DataFields(const idf::Dict& dict, std::string_view what) : dict_(&dict), what_(what) {}

  [[nodiscard]] Status unfitting(std::string_view key, std::string_view needed) const;

  const idf::Dict* dict_;
  std::string_view what_;
};

}  // namespace engram::ltm
