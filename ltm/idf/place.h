// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::idf {

/// The position of a walk inside a value. The path is only built where something is reported.
///
/// Owns: nothing; the parent and the name must outlive it, as they do on the stack of the walk.
class Place {
 public:
  Place() = default;
  Place(const Place& parent, std::string_view name) : parent_(&parent), name_(name) {}
  Place(const Place& parent, const std::string&& name) = delete;
  Place(const Place& parent, size_t index) : parent_(&parent), index_(index), is_index_(true) {}

  /// The path, as Data::at reads it.
  [[nodiscard]] std::string path() const {
    if (parent_ == nullptr) return "";
    return join_path(parent_->path(), is_index_ ? std::to_string(index_) : std::string(name_));
  }

 private:
  const Place* parent_ = nullptr;
  std::string_view name_;
  size_t index_ = 0;
  bool is_index_ = false;
};

}  // namespace engram::idf
