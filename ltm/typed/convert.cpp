// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/convert.h"

#include <fmt/ranges.h>

#include "ltm/idf/cast.h"
#include "ltm/memory/links.h"

namespace engram::typed {

namespace {

/// The bound of notes in a message. Longer lists are not read, and hostile values have many.
constexpr size_t kMaxNotes = 100;

Status problems(const idf::Type& type, std::vector<std::string> found) {
  const size_t count = found.size();
  if (count > kMaxNotes) {
    found.resize(kMaxNotes);
    found.push_back(fmt::format("and {} more", count - kMaxNotes));
  }
  return invalid_argument("value is no {}: {}", type.name(), fmt::join(found, "; "));
}

}  // namespace

Result<idf::Data> fitted(const idf::Data& data, const idf::Type& type) {
  idf::CastResult result = idf::cast(data, type);
  std::vector<std::string> found;
  for (const idf::CastNote& note : result.notes)
    if (note.kind != idf::CastNote::Kind::kUnknown) found.push_back(note.to_string());
  if (!found.empty()) return problems(type, std::move(found));
  return std::move(result.value);
}

Status unreadable(const idf::Data& data, const idf::Type& type) {
  std::vector<std::string> found;
  for (const idf::Mismatch& mismatch : ltm::check_links(data, type))
    found.push_back(mismatch.to_string());
  if (found.empty()) found.push_back("an image or a matrix has more than 2^31 - 1 rows or columns");
  return problems(type, std::move(found));
}

}  // namespace engram::typed
