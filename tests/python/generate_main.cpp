// SPDX-License-Identifier: Apache-2.0
// generate_main OUT FILE.xml...: generates Python from each file, and writes the types of all of
// them as the C++ side knows them to OUT/types.idf.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "ltm/idf/binary.h"
#include "ltm/idf/generate_python.h"
#include "ltm/idf/type_xml.h"

namespace {

namespace fs = std::filesystem;
using namespace engram;

void write(const fs::path& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

Status generate(const fs::path& out, const fs::path& xml, idf::Dict& known) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file, idf::read_type_file(xml));
  ENGRAM_ASSIGN_OR_RETURN(const auto made, idf::generate_python(file));
  for (const idf::GeneratedFile& module : made) write(out / module.name, module.text);
  for (const idf::Type& type : file.types) known.set(type.name(), idf::to_data(type));
  return {};
}

Status run(const fs::path& out, int count, char** files) {
  fs::create_directories(out);
  idf::Dict known;
  for (int i = 0; i < count; ++i) ENGRAM_RETURN_IF_ERROR(generate(out, files[i], known));
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(known));
  write(out / "types.idf", as_text(bytes));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("needs OUT FILE.xml...\n", stderr);
    return 2;
  }
  const Status status = run(argv[1], argc - 2, argv + 2);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.to_string().c_str());
  return 1;
}
