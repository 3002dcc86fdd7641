// SPDX-License-Identifier: Apache-2.0
#include "reports/augment_picture.h"

#include <algorithm>

#include "augmentation/recipe.h"
#include "ltm/store/store_reader.h"
#include "reports/contact_sheet.h"
#include "training/augment/change_examples.h"

namespace engram::reports {

namespace {

constexpr size_t kAugmentColumns = 4;

/// Returns the first 8-bit image of a value.
Result<idf::NdArray> image_of(const idf::Data& value) {
  const idf::NdArray* image = first_image(value);
  if (image == nullptr)
    return invalid_argument("--picture: found no image of 8 bits to show, needs one");
  return *image;
}

Result<std::vector<idf::NdArray>> images_of(const std::vector<idf::Data>& values) {
  std::vector<idf::NdArray> images;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(images.emplace_back(), image_of(value));
  }
  return images;
}

/// Returns snapshots spread over an entity's whole time.
Result<std::vector<ltm::Snapshot>> spread_snapshots(ltm::StoreReader& store,
                                                    const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, store.index(entity));
  std::vector<ltm::Snapshot> snapshots;
  const size_t count = std::min(kAugmentColumns, index->size());
  for (size_t i = 0; i < count; ++i) {
    const ltm::SnapshotEntry& entry = (*index)[i * index->size() / count];
    ENGRAM_ASSIGN_OR_RETURN(snapshots.emplace_back(), store.read_recorded(entity, entry));
  }
  return snapshots;
}

/// Rows of images, keyed by the first change of a recipe. Each row has the first image of its kind
/// per moment.
class RowsByChange {
 public:
  Status add(const ltm::Instance& instance, size_t column) {
    ENGRAM_ASSIGN_OR_RETURN(const auto recipe,
                            augmentation::Recipe::parse(instance.metadata.recipe));
    const std::string name = recipe.changes.empty() ? "" : recipe.changes.front().name;
    auto row = std::ranges::find(rows_, name, &PictureRow::label);
    if (row == rows_.end()) row = rows_.insert(row, {name, {}});
    if (row->images.size() > column) return {};
    ENGRAM_ASSIGN_OR_RETURN(idf::NdArray image, image_of(instance.data));
    // Moments for which no image of this kind was made are black.
    const std::vector<int64_t>& shape = image.shape();
    while (row->images.size() < column)
      row->images.push_back(
          idf::NdArray::take<uint8_t>(shape, std::vector<uint8_t>(image.bytes().size(), 0)));
    row->images.push_back(std::move(image));
    return {};
  }

  std::vector<PictureRow> take() { return std::move(rows_); }

 private:
  std::vector<PictureRow> rows_;
};

}  // namespace

Status write_change_examples(const std::filesystem::path& store,
                             const training::AugmentOptions& options, const std::string& png) {
  ENGRAM_ASSIGN_OR_RETURN(const auto examples,
                          training::change_examples(store, options, kAugmentColumns));
  std::vector<PictureRow> rows;
  for (const training::ChangeExample& example : examples) {
    ENGRAM_ASSIGN_OR_RETURN(auto images, images_of(example.after));
    rows.push_back({example.change, std::move(images)});
  }
  // Repeated once per column, because the first row determines the number of columns.
  const std::vector<idf::Data> before(kAugmentColumns, examples.front().before);
  ENGRAM_ASSIGN_OR_RETURN(auto images, images_of(before));
  rows.insert(rows.begin(), {"recorded", std::move(images)});
  return write_contact_sheet(png, rows, {});
}

Status write_rendered_examples(const std::filesystem::path& recorded,
                               const std::filesystem::path& rendered, const std::string& png) {
  ENGRAM_ASSIGN_OR_RETURN(const auto from, ltm::StoreReader::open(recorded));
  ENGRAM_ASSIGN_OR_RETURN(const auto store, ltm::StoreReader::open(rendered));
  if (store->entities().empty())
    return not_found("--picture: nothing of '{}' was rendered", recorded.string());
  const ltm::MemoryId entity = store->entities().front();
  ENGRAM_ASSIGN_OR_RETURN(const auto snapshots, spread_snapshots(*store, entity));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, from->timeline(entity));
  PictureRow before{"recorded", {}};
  RowsByChange changed;
  for (const ltm::Snapshot& snapshot : snapshots) {
    const ltm::MemoryId& origin = snapshot.instances.front().metadata.origin;
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_before(snapshot.time));
    if (!entry || entry->time != snapshot.time || !entry->recorded)
      return not_found("--picture: '{}' is gone", origin.to_string());
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot was, from->read_recorded(entity, *entry));
    const auto index = static_cast<size_t>(origin.index().value_or(0));
    if (index >= was.instances.size())
      return not_found("--picture: '{}' is gone", origin.to_string());
    ENGRAM_ASSIGN_OR_RETURN(before.images.emplace_back(), image_of(was.instances[index].data));
    for (const ltm::Instance& instance : snapshot.instances)
      ENGRAM_RETURN_IF_ERROR(changed.add(instance, before.images.size() - 1));
  }
  std::vector<PictureRow> rows = changed.take();
  rows.insert(rows.begin(), std::move(before));
  return write_contact_sheet(png, rows, {});
}

}  // namespace engram::reports
