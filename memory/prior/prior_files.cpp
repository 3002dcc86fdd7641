// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/prior_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <optional>
#include <system_error>

#include "ltm/core/utf8.h"

namespace engram::memory {

namespace fs = std::filesystem;
using ltm::MemoryId;

namespace {

constexpr std::string_view kSettings = "prior.yaml";
constexpr std::string_view kTypeEnd = ".type.xml";
/// The number of names above an entity.
constexpr size_t kFolders = MemoryId::kNameLevels - 1;

struct Ending {
  std::string_view text;
  PriorFileKind kind;
};
constexpr std::array<Ending, 6> kEndings{{{".json", PriorFileKind::kJson},
                                          {".yaml", PriorFileKind::kYaml},
                                          {".yml", PriorFileKind::kYaml},
                                          {".png", PriorFileKind::kPicture},
                                          {".jpg", PriorFileKind::kPicture},
                                          {".jpeg", PriorFileKind::kPicture}}};

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

/// Walks down a directory and notes its files.
class PriorFileSearch {
 public:
  PriorFileSearch(fs::path root, size_t max_files, uint64_t max_file_bytes, PriorFiles& found)
      : root_(std::move(root)),
        max_files_(max_files),
        max_file_bytes_(max_file_bytes),
        found_(found) {}

  /// `names` are those of the folders above.
  void search(const fs::path& folder, const std::vector<std::string>& names) {
    for (const fs::path& path : sorted_entries(folder)) {
      if (is_full_) return;
      if (!path.filename().string().starts_with('.')) take(path, names);
    }
  }

 private:
  void problem(const fs::path& path, std::string_view what) {
    found_.problems.push_back(fmt::format("{}: {}", path.string(), what));
  }

  std::vector<fs::path> sorted_entries(const fs::path& folder) {
    std::vector<fs::path> paths;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error))
      paths.push_back(entry->path());
    if (error) problem(folder, fmt::format("cannot be read: {}", error.message()));
    std::ranges::sort(paths);
    return paths;
  }

  void take(const fs::path& path, const std::vector<std::string>& names) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    if (error) return problem(path, fmt::format("leads nowhere: {}", error.message()));
    // A link out of the directory could make any file of the machine readable by queries.
    if (!is_inside(path, root_))
      return problem(path, "is a link that leaves the directory, needs one within it");
    struct stat info {};
    if (::stat(real.c_str(), &info) != 0)
      return problem(path, std::generic_category().message(errno));
    if (S_ISDIR(info.st_mode)) return take_folder(path, names);
    if (!S_ISREG(info.st_mode)) return problem(path, "is neither a file nor a folder");
    take_file(path, names, info);
  }

  void take_folder(const fs::path& path, std::vector<std::string> names) {
    if (names.size() == kFolders)
      return problem(path, "is a folder, needs a file: entities have no folders of their own");
    auto name = prior_name(path.filename().string());
    if (!name.ok()) return problem(path, name.status().message());
    names.push_back(*std::move(name));
    search(path, names);
  }

  void take_file(const fs::path& path, const std::vector<std::string>& names,
                 const struct stat& info) {
    const std::string file_name = path.filename().string();
    if (names.empty() && file_name == kSettings) {
      found_.settings = path;
      return;
    }
    PriorFile file{path,
                   PriorFileKind::kBytes,
                   {},
                   time_from_ns(info.st_mtim.tv_sec * 1'000'000'000 + info.st_mtim.tv_nsec),
                   static_cast<uint64_t>(info.st_size)};
    std::string_view stem = file_name;
    if (file_name.ends_with(kTypeEnd) && names.size() < kFolders) {
      if (names.empty())
        return problem(path, "is no type of a segment: needs to be in the folder of a memory");
      file.kind = PriorFileKind::kType;
      stem.remove_suffix(kTypeEnd.size());
    } else if (names.size() != kFolders) {
      return problem(path, fmt::format("stands below {} names, needs memory, core segment and "
                                       "provider segment above it",
                                       names.size()));
    } else {
      for (const Ending& ending : kEndings) {
        if (!stem.ends_with(ending.text)) continue;
        file.kind = ending.kind;
        stem.remove_suffix(ending.text.size());
        break;
      }
    }
    if (file.bytes > max_file_bytes_)
      return problem(path,
                     fmt::format("has {} bytes, at most {} are read", file.bytes, max_file_bytes_));
    add(std::move(file), names, stem);
  }

  void add(PriorFile file, std::vector<std::string> names, std::string_view stem) {
    auto name = prior_name(stem);
    if (!name.ok()) return problem(file.path, name.status().message());
    names.push_back(*std::move(name));
    file.id = *MemoryId::from_names(std::move(names));
    if (found_.files.size() == max_files_) {
      is_full_ = true;
      return problem(file.path, fmt::format("is one too many, at most {} are read", max_files_));
    }
    found_.files.push_back(std::move(file));
  }

  const fs::path root_;
  const size_t max_files_;
  const uint64_t max_file_bytes_;
  PriorFiles& found_;
  bool is_full_ = false;
};

/// Two files of one entity are a problem: neither has precedence.
void note_doubles(PriorFiles& found) {
  std::map<MemoryId, fs::path> seen;
  for (const PriorFile& file : found.files) {
    if (file.kind == PriorFileKind::kType) continue;
    const auto [other, is_new] = seen.emplace(file.id, file.path);
    if (!is_new)
      found.problems.push_back(fmt::format("{}: entity '{}' is in {} already", file.path.string(),
                                           file.id.to_string(), other->second.string()));
  }
}

}  // namespace

bool is_inside(const fs::path& path, const fs::path& directory) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (error) return false;
  const fs::path root = fs::canonical(directory, error);
  return !error && std::ranges::mismatch(root, real).in1 == root.end();
}

Result<std::string> prior_name(std::string_view file_name) {
  std::string name;
  for (size_t i = 0; i < file_name.size(); ++i) {
    if (file_name[i] != '%') {
      name += file_name[i];
      continue;
    }
    const auto high = i + 2 < file_name.size() ? hex_digit(file_name[i + 1]) : std::nullopt;
    const auto low = high ? hex_digit(file_name[i + 2]) : std::nullopt;
    if (!low)
      return invalid_argument(
          "found a '%' in the name that is followed by no two hexadecimal "
          "digits; a '%' itself is written %25");
    name += static_cast<char>(*high << 4 | *low);
    i += 2;
  }
  if (name.empty()) return invalid_argument("its name is empty");
  if (!is_utf8(name)) return invalid_argument("its name is no UTF-8");
  return name;
}

Result<PriorFiles> find_prior_files(const fs::path& directory, size_t max_files,
                                    uint64_t max_file_bytes) {
  std::error_code error;
  fs::path root = fs::canonical(directory, error);
  if (error || !fs::is_directory(root, error))
    return not_found("prior knowledge: '{}' is no directory", directory.string());
  PriorFiles found;
  PriorFileSearch(std::move(root), max_files, max_file_bytes, found).search(directory, {});
  note_doubles(found);
  return found;
}

}  // namespace engram::memory
