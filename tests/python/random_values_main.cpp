// SPDX-License-Identifier: Apache-2.0
// random_values_main OUT: writes made-up values as the C++ side sees them, for Python to agree
// with.
//
// values.idf: list of uint8 arrays, each the binary form of a value; values.json: their JSON forms,
// one per line. hostile.idf: list of {bytes, is_ok, message}: damaged binary forms and what decode
// says. types.idf: list of {type, value, default, mismatches, cast, notes}.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "ltm/idf/binary.h"
#include "ltm/idf/cast.h"
#include "ltm/idf/json.h"
#include "ltm/idf/type_check.h"
#include "tests/ltm/random_types.h"
#include "tests/ltm/random_values.h"

namespace {

namespace fs = std::filesystem;
using namespace engram;

constexpr int kValues = 500;
constexpr int kDepth = 4;

void write(const fs::path& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

Status write_value(const fs::path& path, const idf::Data& value) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(value));
  write(path, as_text(bytes));
  return {};
}

idf::Data array_of(const std::vector<std::byte>& bytes) {
  std::vector<uint8_t> values;
  for (const std::byte byte : bytes) values.push_back(static_cast<uint8_t>(byte));
  const auto size = static_cast<int64_t>(values.size());
  return idf::NdArray::take<uint8_t>({size}, std::move(values));
}

Status write_values(const fs::path& out) {
  RandomValues random(17);
  idf::List packed;
  std::string lines;
  for (int i = 0; i < kValues; ++i) {
    const idf::Data value = random.value(kDepth);
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(value));
    ENGRAM_ASSIGN_OR_RETURN(const std::string json, idf::to_json_text(value));
    packed.push_back(array_of(bytes));
    lines += json + "\n";
  }
  write(out / "values.json", lines);
  return write_value(out / "values.idf", packed);
}

/// Cuts, flips or overwrites.
void damage(std::vector<std::byte>& bytes, RandomValues& random) {
  if (random.below(4) == 0) bytes.resize(random.below(bytes.size()));
  for (size_t count = 1 + random.below(3); count > 0 && !bytes.empty(); --count) {
    std::byte& one = bytes[random.below(bytes.size())];
    one = random.below(2) == 0 ? one ^ std::byte(1 << random.below(8)) : std::byte(random.bits());
  }
}

Status write_hostile(const fs::path& out) {
  RandomValues random(18);
  idf::List list;
  for (int i = 0; i < 4 * kValues; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(random.value(kDepth)));
    damage(bytes, random);
    const auto read = idf::decode(Buffer::copy(bytes));
    list.push_back(idf::Dict{
        {"bytes", array_of(bytes)}, {"is_ok", read.ok()}, {"message", read.status().message()}});
  }
  return write_value(out / "hostile.idf", list);
}

template <typename T>
idf::Data texts(const std::vector<T>& entries) {
  idf::List list;
  for (const T& entry : entries) list.push_back(entry.to_string());
  return list;
}

/// Values of the type, of another type, and of no type.
Status write_types(const fs::path& out) {
  RandomTypes random(19);
  idf::List list;
  for (int i = 0; i < 3 * kValues; ++i) {
    const idf::Type type = random.type(3);
    const idf::Data value = i % 3 == 0   ? random.value_of(type)
                            : i % 3 == 1 ? random.value_of(random.type(3))
                                         : random.values().value(3);
    auto cast = idf::cast(value, type);
    list.push_back(idf::Dict{{"type", idf::to_data(type)},
                             {"value", value},
                             {"default", idf::default_value(type)},
                             {"mismatches", texts(idf::check(value, type))},
                             {"cast", std::move(cast.value)},
                             {"notes", texts(cast.notes)}});
  }
  return write_value(out / "types.idf", list);
}

Status run(const fs::path& out) {
  fs::create_directories(out);
  ENGRAM_RETURN_IF_ERROR(write_values(out));
  ENGRAM_RETURN_IF_ERROR(write_hostile(out));
  return write_types(out);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("needs OUT\n", stderr);
    return 2;
  }
  const Status status = run(argv[1]);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.to_string().c_str());
  return 1;
}
