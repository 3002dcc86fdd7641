// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_table.h"

#include <stdlib.h>

#include <fstream>

#include "datasets/lerobot/parquet_script.h"
#include "ltm/core/line_process.h"

namespace engram::datasets::lerobot {

namespace {

constexpr auto kPatience = std::chrono::minutes(5);

Table::Options table_options() {
  Table::Options options;
  options.time_column = "timestamp";
  return options;
}

/// A folder that goes with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string name =
        (std::filesystem::temp_directory_path(error) / "engram-lerobot-XXXXXX").string();
    if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

Status convert(const std::filesystem::path& parquet, const std::filesystem::path& script,
               const std::filesystem::path& csv) {
  const char* named = ::getenv("ENGRAM_PYTHON");
  const std::string python = named != nullptr && *named != '\0' ? named : "python3";
  if (!(std::ofstream(script) << parquet_script()).flush())
    return unavailable("'{}' cannot be written", script.string());
  LineProcess process;
  ENGRAM_RETURN_IF_ERROR(process.start({python, script.string(), parquet.string(), csv.string()}));
  while (true) {
    auto line = process.read_line(kPatience);
    if (!line.ok())
      return line.status().with_context(fmt::format("'{}' through pyarrow", parquet.string()));
    if (*line == "engram: done") return {};
    if (*line == "engram: no pyarrow")
      return failed_precondition(
          "'{}': {} has no pyarrow to read it (pip install pyarrow; ENGRAM_PYTHON names another "
          "Python); a table '{}' beside it does as well",
          parquet.string(), python, parquet.stem().string() + ".csv");
  }
}

}  // namespace

std::filesystem::path csv_of(const std::filesystem::path& root,
                             const std::filesystem::path& parquet) {
  std::filesystem::path beside = parquet;
  beside.replace_extension(".csv");
  for (const std::filesystem::path& path : {beside, root / "tables" / beside.filename()}) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) return path;
  }
  return {};
}

Result<Table> read_table(const std::filesystem::path& root, const std::filesystem::path& parquet) {
  if (const auto csv = csv_of(root, parquet); !csv.empty())
    return Table::read(csv, table_options());
  std::error_code error;
  if (!std::filesystem::is_regular_file(parquet, error))
    return not_found("'{}': there is no such file, and no CSV beside it", parquet.string());
  const TemporaryFolder folder;
  if (folder.path().empty()) return unavailable("no temporary folder can be made");
  const std::filesystem::path csv = folder.path() / "table.csv";
  ENGRAM_RETURN_IF_ERROR(convert(parquet, folder.path() / "parquet_to_csv.py", csv));
  return Table::read(csv, table_options());
}

}  // namespace engram::datasets::lerobot
