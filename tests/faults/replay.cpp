// SPDX-License-Identifier: Apache-2.0
#include "tests/faults/replay.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>

#include "ltm/core/check.h"

namespace engram::ltm::faults {

namespace {

std::string read_text(std::ifstream& in, uint64_t bytes) {
  std::string text(bytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(bytes));
  ENGRAM_CHECK(in.good(), "the trace ends inside of a record");
  return text;
}

std::filesystem::path relative_to(const std::filesystem::path& root, const std::string& path) {
  if (path.empty()) return {};
  const std::filesystem::path relative = std::filesystem::path(path).lexically_relative(root);
  return relative == "." ? std::filesystem::path() : relative;
}

/// Applies a write or cut to a file's content, the first `bytes` of the write only.
void apply_data(std::string& content, const Change& change, size_t bytes) {
  const auto offset = static_cast<size_t>(change.record.offset);
  if (change.record.change == kFileTruncate) {
    content.resize(offset);
    return;
  }
  // What lies between the old end and a write reads as zeros.
  if (content.size() < offset + bytes) content.resize(offset + bytes);
  std::memcpy(content.data() + offset, change.data.data(), bytes);
}

/// Of `waiting` changes as many as the power cut leaves; `is_torn`: half of the last one.
struct Kept {
  size_t changes = 0;
  bool is_torn = false;
};

Kept kept_data(PowerCut cut, size_t waiting, std::mt19937& random) {
  switch (cut) {
    case PowerCut::kNothing:
    case PowerCut::kNamesOnly:
      return {};
    case PowerCut::kTorn:
      return {waiting, waiting > 0};
    case PowerCut::kDataOnly:
      return {waiting, false};
    case PowerCut::kRandom:
      break;
  }
  const size_t changes = random() % (waiting + 1);
  return {changes, changes > 0 && random() % 2 == 0};
}

size_t kept_names(PowerCut cut, size_t waiting, std::mt19937& random) {
  if (cut == PowerCut::kRandom) return random() % (waiting + 1);
  return cut == PowerCut::kNamesOnly || cut == PowerCut::kTorn ? waiting : 0;
}

}  // namespace

std::vector<Change> read_trace(const std::filesystem::path& file,
                               const std::filesystem::path& root) {
  std::vector<Change> changes;
  std::ifstream in(file, std::ios::binary);
  while (in.peek() != std::ifstream::traits_type::eof()) {
    Change change;
    const std::string head = read_text(in, sizeof(FileRecord));
    std::memcpy(&change.record, head.data(), sizeof(FileRecord));
    change.path = relative_to(root, read_text(in, change.record.path_bytes));
    change.second = relative_to(root, read_text(in, change.record.second_path_bytes));
    change.data = read_text(in, change.record.bytes);
    changes.push_back(std::move(change));
  }
  return changes;
}

Disk::NodePointer Disk::find(const std::filesystem::path& path) {
  const Names& names = directories_[path.parent_path()].now;
  const auto known = names.find(path.filename().string());
  return known == names.end() ? nullptr : known->second;
}

void Disk::change_names(const std::filesystem::path& directory, const NameChange& change) {
  Directory& names = directories_[directory];
  names.waiting.push_back(change);
  if (!change.removed.empty()) names.now.erase(change.removed);
  if (!change.added.empty()) names.now[change.added] = change.node;
}

void Disk::rename(const Change& change) {
  const NodePointer node = find(change.path);
  ENGRAM_CHECK(node != nullptr, "the trace renames '{}', which is not there", change.path.string());
  const auto from = change.path.parent_path(), to = change.second.parent_path();
  const std::string old_name = change.path.filename().string();
  const std::string new_name = change.second.filename().string();
  if (from == to) {
    change_names(from, {old_name, new_name, node});
    return;
  }
  change_names(to, {"", new_name, node});
  change_names(from, {old_name, "", nullptr});
}

void Disk::sync(const Change& change) {
  if (change.record.is_directory != 0) {
    Directory& directory = directories_[change.path];
    directory.durable = directory.now;
    directory.waiting.clear();
    return;
  }
  Node& node = *files_.at(change.record.file);
  for (const Change& each : node.waiting) apply_data(node.durable, each, each.data.size());
  node.waiting.clear();
}

void Disk::apply(const Change& change) {
  const std::filesystem::path directory = change.path.parent_path();
  const std::string name = change.path.filename().string();
  switch (change.record.change) {
    case kFileCreate:
      files_[change.record.file] = std::make_shared<Node>();
      return change_names(directory, {"", name, files_[change.record.file]});
    case kFileMkdir: {
      const auto node = std::make_shared<Node>();
      node->is_directory = true;
      return change_names(directory, {"", name, node});
    }
    case kFileWrite:
    case kFileTruncate:
      files_.at(change.record.file)->waiting.push_back(change);
      return;
    case kFileSync:
      return sync(change);
    case kFileRename:
      return rename(change);
    case kFileUnlink:
      return change_names(directory, {name, "", nullptr});
    default:
      ENGRAM_CHECK(false, "the trace holds change {}", change.record.change);
  }
}

void Disk::write(const std::filesystem::path& directory, PowerCut cut, uint32_t seed) const {
  std::mt19937 random(seed);
  // In the order of paths: directories come before what lies in them.
  for (const auto& [path, content] : directories_) {
    if (!std::filesystem::exists(directory / path)) continue;  // Its own name was lost.
    Names names = content.durable;
    const size_t kept = kept_names(cut, content.waiting.size(), random);
    for (size_t i = 0; i < kept; ++i) {
      const NameChange& change = content.waiting[i];
      if (!change.removed.empty()) names.erase(change.removed);
      if (!change.added.empty()) names[change.added] = change.node;
    }
    for (const auto& [name, node] : names) {
      if (node->is_directory) {
        std::filesystem::create_directory(directory / path / name);
        continue;
      }
      std::string bytes = node->durable;
      const Kept data = kept_data(cut, node->waiting.size(), random);
      for (size_t i = 0; i < data.changes; ++i) {
        const size_t size = node->waiting[i].data.size();
        apply_data(bytes, node->waiting[i],
                   data.is_torn && i + 1 == data.changes ? size / 2 : size);
      }
      std::ofstream(directory / path / name, std::ios::binary) << bytes;
    }
  }
}

}  // namespace engram::ltm::faults
