// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::viewer {

/// The target of a request, taken apart: "/api/density?entity=A%2FB&pixels=800".
///
/// Every value is checked when it is asked for, and an error names the parameter.
/// Errors: kInvalidArgument.
/// Threading: immutable.
class RequestTarget {
 public:
  static constexpr size_t kMaxBytes = 64 << 10;
  static constexpr size_t kMaxParameters = 512;

  /// Decodes percent-escapes, in the query also '+' as a space.
  /// Errors: kInvalidArgument if the target is too long, has too many parameters, an escape that is
  /// none, a NUL byte, or bytes that are no UTF-8.
  static Result<RequestTarget> parse(std::string_view target);

  [[nodiscard]] const std::string& path() const { return path_; }

  /// The first value of a parameter; nothing if there is none.
  [[nodiscard]] std::optional<std::string> find(std::string_view name) const;

  /// All values of a parameter, in their order.
  [[nodiscard]] std::vector<std::string> all(std::string_view name) const;

  /// The query as it came, without one parameter: "?a=b", or empty.
  [[nodiscard]] std::string query_without(std::string_view name) const;

  /// A value that must be there and not empty.
  Result<std::string> text(std::string_view name) const;

  /// One of `choices`; `otherwise` if there is no such parameter.
  Result<std::string> choice(std::string_view name, const std::vector<std::string>& choices,
                             const std::string& otherwise) const;

  /// A decimal integer within bounds, both included.
  Result<int64_t> integer(std::string_view name, int64_t min, int64_t max) const;
  Result<int64_t> integer(std::string_view name, int64_t min, int64_t max, int64_t otherwise) const;

  /// Decimal integers between commas, each within bounds: from one to `max_count` of them.
  Result<std::vector<int64_t>> integers(std::string_view name, int64_t min, int64_t max,
                                        size_t max_count) const;

  /// A decimal number within bounds, both included.
  Result<double> number(std::string_view name, double min, double max) const;

  /// Decimal nanoseconds.
  Result<Time> time(std::string_view name) const;

  /// The ID of an entity, and nothing deeper.
  Result<ltm::MemoryId> entity(std::string_view name) const;
  /// The IDs of entities or of what is above them: all values of a parameter, from one to `max`.
  Result<std::vector<ltm::MemoryId>> names(std::string_view name, size_t max) const;

  /// The ID of a snapshot, or of an instance.
  Result<ltm::MemoryId> moment(std::string_view name) const;

 private:
  struct Parameter {
    std::string raw;
    std::string name;
    std::string value;
  };

  std::string path_;
  std::vector<Parameter> parameters_;
};

}  // namespace engram::viewer
