// SPDX-License-Identifier: Apache-2.0
#include "cli/type_options.h"

#include "ltm/idf/type_xml.h"

namespace engram::cli {

namespace {

/// Parses "Vision/RGB=robot::View": a segment, and a type of the files.
Result<DeclaredType> read_type(const std::string& text, const std::vector<idf::TypeFile>& files) {
  const size_t equals = text.rfind('=');
  if (equals == std::string::npos)
    return invalid_argument("--type '{}': needs SEGMENT=NAME, as in Vision/RGB=robot::View", text);
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId segment, ltm::MemoryId::parse(text.substr(0, equals)));
  std::string known;
  for (const idf::TypeFile& file : files) {
    if (const idf::Type* type = file.find(text.substr(equals + 1)))
      return DeclaredType{std::move(segment), *type};
    for (const idf::Type& type : file.types) known += fmt::format(" {}", type.name());
  }
  return invalid_argument("--type '{}': no such type in the --types files; they have:{}", text,
                          known.empty() ? " none" : known);
}

}  // namespace

void add_type_options(CLI::App& command, TypeArguments& arguments) {
  command.add_option("--types", arguments.files,
                     "XML type description (docs/idf.md); may be given again");
  command.add_option("--type", arguments.types,
                     "SEGMENT=NAME: the type of a core or provider segment; may be given again");
}

Result<std::vector<DeclaredType>> read_types(const TypeArguments& arguments) {
  std::vector<idf::TypeFile> files;
  for (const std::string& path : arguments.files) {
    ENGRAM_ASSIGN_OR_RETURN(idf::TypeFile file, idf::read_type_file(path));
    files.push_back(std::move(file));
  }
  std::vector<DeclaredType> types;
  for (const std::string& text : arguments.types) {
    ENGRAM_ASSIGN_OR_RETURN(DeclaredType type, read_type(text, files));
    types.push_back(std::move(type));
  }
  return types;
}

Status declare(ltm::Recorder& recorder, const std::vector<DeclaredType>& types) {
  for (const DeclaredType& each : types)
    ENGRAM_RETURN_IF_ERROR(recorder.declare(each.segment, each.type));
  return {};
}

}  // namespace engram::cli
