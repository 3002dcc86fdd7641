// SPDX-License-Identifier: Apache-2.0
#include "server/age_objects.h"

#include <algorithm>
#include <chrono>

namespace engram::experiments {

namespace {

/// The size that the paper states for the complex object is mostly its image.
const idf::NdArray& image() {
  static const idf::NdArray made =
      idf::NdArray::take({128, 128, 3}, std::vector<uint8_t>(size_t{128} * 128 * 3, 127));
  return made;
}

idf::Data make(AgeObject object, int64_t made) {
  idf::Dict dict;
  dict.set("made_ns", made);
  dict.set("value", int32_t{42});
  if (object == AgeObject::kModerate) {
    dict.set("text", "hello");
    dict.set("link", "Vision/RGB/head/cam");
  }
  if (object == AgeObject::kComplex) {
    dict.set("i", image());
    dict.set("l", idf::List{"M", "M/C"});
    dict.set("a", idf::Dict{{"a", 0.9f}});
    dict.set("b", idf::Dict{{"b", int32_t{1}}});
  }
  return dict;
}

}  // namespace

const char* to_string(AgeObject object) {
  switch (object) {
    case AgeObject::kSimple: return "simple";
    case AgeObject::kModerate: return "moderate";
    case AgeObject::kComplex: return "complex";
  }
  return "";
}

ltm::Commit make_commit(AgeObject object, int batch, Time time, int64_t made_ns) {
  ltm::Commit commit;
  commit.updates.reserve(static_cast<size_t>(batch));
  for (int i = 0; i < batch; ++i) {
    auto entity = ltm::MemoryId::from_names({"Bench", "Object", "producer", fmt::format("o{}", i)});
    commit.updates.push_back({*std::move(entity), time, {{make(object, made_ns), {}}}});
  }
  return commit;
}

int64_t made_ns(const idf::Data& data) {
  const auto* dict = data.get_if<idf::Dict>();
  const idf::Data* made = dict == nullptr ? nullptr : dict->find("made_ns");
  return made == nullptr || !made->is<int64_t>() ? 0 : made->get<int64_t>();
}

int64_t made_ns(const ltm::Commit& commit) {
  int64_t first = INT64_MAX;
  for (const ltm::EntityUpdate& update : commit.updates)
    first = std::min(first, made_ns(update.instances.front().data));
  return first;
}

int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace engram::experiments
