// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/faults/faulty_files.h"

namespace engram::ltm::faults {

/// One change that was made to the files below a directory.
struct Change {
  FileRecord record{};
  std::filesystem::path path;    ///< Relative to the watched directory.
  std::filesystem::path second;  ///< Where it was renamed to.
  std::string data;              ///< That was written.
};

/// Reads what faulty_files_trace wrote. Aborts where it is no trace.
[[nodiscard]] std::vector<Change> read_trace(const std::filesystem::path& file,
                                             const std::filesystem::path& root);

/// What a disk may have kept of what it was not forced to keep. Each file and each directory takes
/// its changes in their order; how many of them differs.
enum class PowerCut {
  kNothing,    ///< Neither data nor names.
  kNamesOnly,  ///< All names, no data.
  kTorn,       ///< All names, and all data but half of each file's last write.
  kDataOnly,   ///< All data, no names.
  kRandom,     ///< Of each file and each directory as much as chance has it, torn.
};
inline constexpr int kPowerCuts = 5;

/// A directory as its disk sees it: what is forced, and what waits.
///
/// A file's data are durable once the file was synced, its name once its directory was. Made
/// directories count as names like files do.
class Disk {
 public:
  void apply(const Change& change);

  /// Writes what is left after a power cut into an empty directory.
  void write(const std::filesystem::path& directory, PowerCut cut, uint32_t seed) const;

 private:
  struct Node {
    std::string durable;
    std::vector<Change> waiting;  ///< Writes and cuts that were not forced.
    bool is_directory = false;
  };
  using NodePointer = std::shared_ptr<Node>;
  using Names = std::map<std::string, NodePointer>;

  struct NameChange {
    std::string removed;  ///< Empty: none.
    std::string added;    ///< Empty: none.
    NodePointer node;     ///< What `added` names.
  };
  struct Directory {
    Names durable;
    Names now;
    std::vector<NameChange> waiting;
  };

  NodePointer find(const std::filesystem::path& path);
  void change_names(const std::filesystem::path& directory, const NameChange& change);
  void rename(const Change& change);
  void sync(const Change& change);

  std::map<std::filesystem::path, Directory> directories_;  ///< By path, "" is the watched one.
  std::map<uint64_t, NodePointer> files_;                   ///< By inode.
};

}  // namespace engram::ltm::faults
