// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/orphans.h"

#include <algorithm>
#include <set>

#include "ltm/store/checkpoint_file.h"
#include "ltm/store/journal.h"
#include "ltm/store/manifest.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

constexpr const char* kAdviceLeftOver = "nothing: the next writer removes it";

Finding note(std::string file, std::string what, std::string advice = kAdviceLeftOver) {
  return {Severity::kNote, std::move(file), "", std::move(what), std::move(advice)};
}

/// Lists the files in a folder. It may be missing, because some copies of a store omit empty
/// folders.
std::vector<std::string> files_in(const std::filesystem::path& store, const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(store / folder, error))
    files.push_back(folder + "/" + entry.path().filename().string());
  std::ranges::sort(files);
  return files;
}

}  // namespace

Result<std::vector<Finding>> find_orphans(const std::filesystem::path& store) {
  std::vector<Finding> notes;
  // List files before reading the manifest, so that a file published meanwhile is not taken for an
  // orphan.
  std::vector<std::string> published = files_in(store, "segments");
  std::ranges::move(files_in(store, "models"), std::back_inserter(published));
  ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store));
  std::set<std::string> named;
  for (const SegmentInfo& segment : manifest.segments) named.insert(segment.file);
  for (const ModelInfo& model : manifest.models) named.insert(model.file);
  for (const std::string& file : published)
    if (!named.contains(file))
      notes.push_back(note(
          file, "is not named by the manifest: left over, or just being published or replaced"));
  for (std::string& file : find_stray_indexes(store, manifest))
    notes.push_back(note(std::move(file), "is an index of a segment that is gone"));
  for (const std::string& file : files_in(store, "tmp")) {
    const std::string name = std::filesystem::path(file).filename().string();
    if (is_checkpoint(name))
      notes.push_back(note(file, "is what training goes on from that is under way or was killed",
                           "nothing: the next consolidation uses or removes it"));
    else if (!is_history(name) && belongs_to_dead_process(name))
      notes.push_back(note(file, "belongs to a process that is gone"));
  }
  for (const std::string& file : files_in(store, "journal"))
    if (file.ends_with(".damaged"))
      notes.push_back(note(file, "is kept since acknowledged data in it was damaged",
                           "remove it once nobody wants to look at it"));
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers, list_journals(store));
  for (const uint64_t number : numbers)
    if (number < manifest.first_journal)
      notes.push_back(
          note(Journal::file_name(number).string(), "is sealed: its content is in a segment"));
  return notes;
}

}  // namespace engram::ltm
