// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_xml.h"

#include <algorithm>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <unordered_map>
#include <unordered_set>

#include "ltm/core/file.h"
#include "ltm/idf/type_xml_element.h"

namespace engram::idf {

namespace {

namespace fs = std::filesystem;

/// The bound of nodes in all types of one file together: a small file must not cause much work.
constexpr size_t kMaxFileNodes = size_t{1} << 22;

/// Reads files and their includes, each once.
class FileReader {
 public:
  explicit FileReader(const std::vector<fs::path>& include_paths) : include_paths_(include_paths) {}

  Result<TypeFile> read(const fs::path& path);
  Result<TypeFile> parse(std::string_view text, const std::string& name, const fs::path& directory);

  /// The file of `include`, read now or before.
  Result<const TypeFile*> include(const TypeInclude& include);

  /// Finds a file of this name: beside the including file, then in the include paths.
  [[nodiscard]] std::optional<fs::path> locate(const fs::path& name,
                                               const fs::path& directory) const;

 private:
  const std::vector<fs::path>& include_paths_;
  /// Files by canonical path; nothing while a file is being read, which detects cycles.
  std::map<fs::path, std::optional<TypeFile>> files_;
  int depth_ = 0;
};

/// Reads one document. It finds all definitions first, so that they may be used before they come.
class DocumentReader {
 public:
  DocumentReader(const XmlText& source, fs::path directory, FileReader& files)
      : source_(source), directory_(std::move(directory)), files_(files) {
    file_.name = source.name();
  }

  Result<TypeFile> read(const pugi::xml_document& document) {
    const pugi::xml_node root = document.document_element();
    if (std::string_view(root.name()) != "AronTypeDefinition")
      return source_.error(root,
                           fmt::format("found <{}>, needs <AronTypeDefinition>", root.name()));
    for (const pugi::xml_node& child : root.children()) {
      if (child.type() == pugi::node_comment) continue;
      ENGRAM_RETURN_IF_ERROR(read_section(child));
    }
    for (const std::string& name : order_)
      ENGRAM_RETURN_IF_ERROR(resolve(definitions_.at(name)).status());
    for (const std::string& name : order_) file_.types.push_back(*definitions_.at(name).type);
    return std::move(file_);
  }

 private:
  struct Definition {
    pugi::xml_node node;
    bool is_being_read = false;
    std::optional<Type> type;
  };

  Status read_section(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    if (name == "AronIncludes") return read_includes(node);
    if (name == "GenerateTypes") return find_definitions(node);
    if (name != "CodeIncludes")
      return source_.error(node, fmt::format("found '{}', needs <AronIncludes>, <CodeIncludes> or "
                                             "<GenerateTypes>",
                                             node.type() == pugi::node_element ? name : "text"));
    file_.notes.push_back(source_.place(node) + ": <CodeIncludes> is for code alone");
    return {};
  }

  Status read_includes(const pugi::xml_node& section) {
    for (const pugi::xml_node& node : section.children()) {
      if (node.type() == pugi::node_comment) continue;
      ENGRAM_ASSIGN_OR_RETURN(const std::string name, include_name(node));
      const auto path = files_.locate(name, directory_);
      if (!path)
        return not_found("{}: the include '{}' is neither beside the file nor in an include path",
                         source_.place(node), name);
      TypeInclude include{name, *path};
      auto read = files_.include(include);
      if (!read.ok())
        return read.status().with_context(
            fmt::format("{}: included '{}'", source_.place(node), name));
      for (const auto* types : {&(*read)->types, &(*read)->included_types}) {
        for (const Type& type : *types) {
          ENGRAM_RETURN_IF_ERROR(add_included(node, type));
          include.type_names.emplace_back(type.name());
        }
      }
      file_.includes.push_back(std::move(include));
    }
    return {};
  }

  /// "kitchen/Cup.xml", without brackets.
  Result<std::string> include_name(const pugi::xml_node& node) {
    const std::string_view element = node.name();
    if (element == "PackagePath") {
      ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                              XmlAttributes::read(source_, node, {"package", "path"}, file_.notes));
      ENGRAM_ASSIGN_OR_RETURN(const std::string_view package, attributes.get("package"));
      ENGRAM_ASSIGN_OR_RETURN(const std::string_view path, attributes.get("path"));
      return fmt::format("{}/{}", package, path);
    }
    if (element != "Include")
      return source_.error(node, fmt::format("found '{}' in <AronIncludes>, needs <PackagePath "
                                             "package=... path=...> or <Include include=...>",
                                             element));
    ENGRAM_ASSIGN_OR_RETURN(const auto attributes,
                            XmlAttributes::read(source_, node, {"include"}, file_.notes));
    ENGRAM_ASSIGN_OR_RETURN(std::string_view name, attributes.get("include"));
    if (name.starts_with('<') && name.ends_with('>')) name = name.substr(1, name.size() - 2);
    if (name.empty()) return source_.error(node, "include=\"\": needs the name of a file");
    return std::string(name);
  }

  /// The same type may be included twice; two different types of one name may not.
  Status add_included(const pugi::xml_node& node, const Type& type) {
    const auto [known, is_new] = included_.emplace(type.name(), file_.included_types.size());
    if (is_new) {
      file_.included_types.push_back(type);
      return {};
    }
    if (file_.included_types[known->second] == type) return {};
    return source_.error(
        node, fmt::format("the type '{}' is included twice, with different meaning", type.name()));
  }

  Status find_definitions(const pugi::xml_node& section) {
    for (const pugi::xml_node& node : section.children()) {
      if (node.type() == pugi::node_comment) continue;
      const std::string_view element = node.name();
      if (element != "Object" && element != "IntEnum")
        return source_.error(node, fmt::format("found '{}' in <GenerateTypes>, needs <Object "
                                               "name=...> or <IntEnum name=...>",
                                               element));
      const std::string name = node.attribute("name").value();
      if (!is_type_name(name) || is_type_element(name))
        return source_.error(node, fmt::format("name=\"{}\" of <{}>: needs identifiers joined by "
                                               "'::' that are no built-in type",
                                               name, element));
      if (!definitions_.emplace(name, Definition{node, false, std::nullopt}).second)
        return source_.error(node, fmt::format("the type '{}' is defined twice", name));
      order_.push_back(name);
    }
    return {};
  }

  /// Reads a definition when it is first needed.
  Result<std::optional<Type>> resolve(Definition& definition) {
    if (definition.type) return definition.type;
    const std::string_view name = definition.node.attribute("name").value();
    if (included_.contains(std::string(name)))
      return source_.error(definition.node,
                           fmt::format("the type '{}' is in an included file already", name));
    if (definition.is_being_read)
      return source_.error(definition.node,
                           fmt::format("the type '{}' contains itself, needs to end", name));
    if (++depth_ > kMaxTypeDepth)
      return source_.error(definition.node, fmt::format("the type '{}' is used {} types deep, at "
                                                        "most {} are allowed",
                                                        name, depth_, kMaxTypeDepth));
    definition.is_being_read = true;
    XmlTypeReader reader(
        source_,
        [this](std::string_view used, std::string_view scope) { return find(used, scope); },
        file_.notes);
    ENGRAM_ASSIGN_OR_RETURN(const Type type, reader.read_definition(definition.node));
    --depth_;
    nodes_ += type.node_count();
    if (nodes_ > kMaxFileNodes)
      return source_.error(definition.node, fmt::format("the types up to '{}' need more than {} "
                                                        "nodes",
                                                        name, kMaxFileNodes));
    definition.type = type;
    return definition.type;
  }

  /// Searches the namespace of the user first, then the enclosing ones.
  Result<std::optional<Type>> find(std::string_view used, std::string_view scope) {
    while (true) {
      const std::string name =
          scope.empty() ? std::string(used) : fmt::format("{}::{}", scope, used);
      if (const auto own = definitions_.find(name); own != definitions_.end())
        return resolve(own->second);
      if (const auto other = included_.find(name); other != included_.end())
        return std::optional(file_.included_types[other->second]);
      if (scope.empty()) return std::optional<Type>();
      const size_t end = scope.rfind("::");
      scope = end == std::string_view::npos ? std::string_view() : scope.substr(0, end);
    }
  }

  const XmlText& source_;
  fs::path directory_;
  FileReader& files_;
  TypeFile file_;
  std::vector<std::string> order_;
  std::unordered_map<std::string, Definition> definitions_;
  std::unordered_map<std::string, size_t> included_;  ///< Indices in included_types.
  int depth_ = 0;
  size_t nodes_ = 0;
};

Result<TypeFile> FileReader::parse(std::string_view text, const std::string& name,
                                   const fs::path& directory) {
  const XmlText source(text, name);
  if (text.size() > kMaxXmlBytes)
    return invalid_argument("{}: has {} bytes, at most {} are read", name, text.size(),
                            kMaxXmlBytes);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_comments, pugi::encoding_utf8);
  if (!parsed)
    return invalid_argument("{}: no XML: {}; needs <AronTypeDefinition>",
                            source.place(parsed.offset), parsed.description());
  return DocumentReader(source, directory, *this).read(document);
}

Result<TypeFile> FileReader::read(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  const auto size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
  if (error || !fs::is_regular_file(path, error))
    return not_found("'{}': needs a file that exists", path.string());
  if (size > kMaxXmlBytes)
    return invalid_argument("{}: has {} bytes, at most {} are read", path.string(), size,
                            kMaxXmlBytes);
  if (files_.size() >= kMaxXmlFiles)
    return resource_exhausted("'{}': needs more than {} files", path.string(), kMaxXmlFiles);
  files_[canonical] = std::nullopt;
  if (++depth_ > kMaxTypeDepth)
    return resource_exhausted("'{}': includes nest deeper than {} files", path.string(),
                              kMaxTypeDepth);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(path));
  ENGRAM_ASSIGN_OR_RETURN(TypeFile file,
                          parse(as_text(bytes.bytes()), path.string(), canonical.parent_path()));
  files_[canonical] = file;
  --depth_;
  return file;
}

Result<const TypeFile*> FileReader::include(const TypeInclude& include) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(include.path, error);
  if (const auto known = files_.find(canonical); known != files_.end()) {
    if (known->second) return &*known->second;
    return invalid_argument("includes itself, by way of others or not; needs an order");
  }
  ENGRAM_RETURN_IF_ERROR(read(include.path).status());
  return &*files_.at(canonical);
}

std::optional<fs::path> FileReader::locate(const fs::path& name, const fs::path& directory) const {
  std::error_code error;
  std::vector<fs::path> places{directory};
  places.insert(places.end(), include_paths_.begin(), include_paths_.end());
  for (const fs::path& place : places)
    if (!place.empty() && fs::is_regular_file(place / name, error)) return place / name;
  return std::nullopt;
}

}  // namespace

const Type* TypeFile::find(std::string_view type_name) const {
  for (const auto* list : {&types, &included_types})
    for (const Type& type : *list)
      if (type.name() == type_name) return &type;
  return nullptr;
}

Result<TypeFile> read_type_file(const fs::path& path, const std::vector<fs::path>& include_paths) {
  return FileReader(include_paths).read(path);
}

Result<TypeFile> parse_type_xml(std::string_view text, std::string_view name,
                                const std::vector<fs::path>& include_paths) {
  return FileReader(include_paths).parse(text, std::string(name), "");
}

}  // namespace engram::idf
