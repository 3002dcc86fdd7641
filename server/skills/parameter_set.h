// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::skills {

/// One parameter of a skill.
struct SkillParameter {
  std::string name;
  std::string type_name;  ///< "double", "link", "position", ...: a word of docs/skills.md.
  idf::Type type = idf::Type::string();
  std::string doc;
  /// Missing: the parameter must be given.
  std::optional<idf::Data> default_value;
  std::vector<std::string> choices;  ///< The texts that it may be; empty: any.
};

/// The parameters of a skill, and the values that fit them.
///
/// Threading: immutable.
/// Source: docs/skills.md, "Parameters".
class ParameterSet {
 public:
  static constexpr size_t kMaxParameters = 100;

  ParameterSet() = default;

  /// Reads `parameters:` of a description.
  /// Errors: kInvalidArgument naming file, line and key.
  static Result<ParameterSet> read(const ConfigValue& value);

  /// The values as they are used: each of its type, in the order of the parameters, with defaults
  /// where `given`, a dict, has none. Lists of numbers become arrays.
  /// Errors: kInvalidArgument with every path that does not fit, what was found and what is needed.
  [[nodiscard]] Result<idf::Data> fit(const idf::Data& given) const;

  [[nodiscard]] const std::vector<SkillParameter>& all() const { return all_; }
  [[nodiscard]] const SkillParameter* find(std::string_view name) const;

 private:
  std::vector<SkillParameter> all_;
};

/// The entities, snapshots and instances that parameters name.
[[nodiscard]] std::vector<ltm::MemoryId> links_of(const ParameterSet& set, const idf::Data& values);

}  // namespace engram::skills
