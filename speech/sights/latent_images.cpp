// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/latent_images.h"

#include <algorithm>
#include <span>

namespace engram::speech {

namespace {

/// A background has so many numbers along the side of a cell.
constexpr int kBackgroundParts = 2;
/// The latents of so many snapshots are in memory at once. Blocks are shorter.
constexpr size_t kMaxReadTogether = 256;
constexpr float kGreyLevel = 1.0F / 255;

/// The newest model of an entity, or the one with a checksum.
const ltm::ModelInfo* model_of(const std::vector<ltm::ModelInfo>& models,
                               const std::optional<uint64_t>& checksum) {
  const ltm::ModelInfo* found = nullptr;
  for (const ltm::ModelInfo& model : models)
    if ((!checksum || model.checksum == *checksum) &&
        (found == nullptr || model.version > found->version))
      found = &model;
  return found;
}

CellGrid grid_of(const encoders::LatentMember& member) {
  return {member.coarse.channels + member.fine.channels +
              member.channels * kBackgroundParts * kBackgroundParts,
          member.fine.height, member.fine.width};
}

/// The means of the parts of each cell of a background. Shape: [colours * 4, rows, columns].
std::vector<float> background_cells(const idf::NdArray& background, const CellGrid& grid) {
  const auto colours = static_cast<size_t>(background.shape()[0]);
  const auto height = static_cast<size_t>(background.shape()[1]);
  const auto width = static_cast<size_t>(background.shape()[2]);
  const size_t side = height / static_cast<size_t>(grid.rows * kBackgroundParts);  // Of a part.
  const auto pixels = background.values<float>();
  std::vector<float> cells(colours * kBackgroundParts * kBackgroundParts * grid.cells());
  const float share = kGreyLevel / static_cast<float>(side * side);
  for (size_t c = 0; c < colours; ++c)
    for (size_t y = 0; y < height; ++y)
      for (size_t x = 0; x < width; ++x) {
        const size_t row = y / side;
        const size_t column = x / side;
        const size_t channel = (c * kBackgroundParts + row % kBackgroundParts) * kBackgroundParts +
                               column % kBackgroundParts;
        cells[(channel * grid.rows + row / kBackgroundParts) * grid.columns +
              column / kBackgroundParts] += share * pixels[(c * height + y) * width + x];
      }
  return cells;
}

/// Turns what a model made of images into cells.
class CellMaker {
 public:
  CellMaker(const encoders::OpenModel& model, const encoders::LatentArrays& arrays,
            const CellGrid& grid)
      : model_(model), member_(model.images().front()), arrays_(arrays), grid_(grid) {}

  /// The cells of one value.
  ImageCells cells(size_t value) {
    ImageCells cells;
    cells.reserve(grid_.count());
    const auto latents =
        std::span(arrays_.images.front()).subspan(value * member_.count(), member_.count());
    const int width = member_.coarse.width;
    const int height = member_.coarse.height;
    for (int channel = 0; channel < member_.coarse.channels; ++channel)
      for (int row = 0; row < grid_.rows; ++row)
        for (int column = 0; column < grid_.columns; ++column) {
          // A cell of coarse latents has four of fine ones.
          const int at = (channel * height + row / 2) * width + column / 2;
          cells.push_back(static_cast<float>(latents[static_cast<size_t>(at)]));
        }
    for (const int32_t fine : latents.subspan(member_.coarse.count()))
      cells.push_back(static_cast<float>(fine));
    const std::vector<float>& background = background_of(value);
    cells.insert(cells.end(), background.begin(), background.end());
    return cells;
  }

 private:
  /// Values of one block share a background, and follow each other.
  const std::vector<float>& background_of(size_t value) {
    const idf::NdArray& own = arrays_.own.front()[value];
    const std::byte* key = own.count() > 0 ? own.bytes().data() : nullptr;
    if (background_.empty() || key != key_ || arrays_.scenes[value] != scene_)
      background_ = background_cells(model_.background(arrays_, 0, value), grid_);
    key_ = key;
    scene_ = arrays_.scenes[value];
    return background_;
  }

  const encoders::OpenModel& model_;
  const encoders::LatentMember& member_;
  const encoders::LatentArrays& arrays_;
  const CellGrid& grid_;
  std::vector<float> background_;
  const std::byte* key_ = nullptr;
  uint32_t scene_ = 0;
};

}  // namespace

struct LatentImages::State {
  State(ltm::StoreReader& in, ltm::MemoryId of, ltm::ModelInfo made_by, encoders::OpenModel open)
      : store(in), entity(std::move(of)), info(std::move(made_by)), model(std::move(open)) {}

  ltm::StoreReader& store;
  ltm::MemoryId entity;
  ltm::ModelInfo info;
  encoders::OpenModel model;
  CellGrid grid;
  size_t others = 0;
  /// Those that are read and not yet visited.
  std::vector<Time> times;
  std::vector<ltm::Latent> latents;

  /// Takes the latents of a snapshot, if there are some of this model.
  Status take(const ltm::SnapshotEntry& entry) {
    if (!entry.latent) {
      ++others;
      return {};
    }
    ENGRAM_ASSIGN_OR_RETURN(ltm::LatentSnapshot snapshot, store.read_latent(entity, entry));
    if (snapshot.model_version != info.version || snapshot.instances.empty()) {
      ++others;
      return {};
    }
    times.push_back(entry.time);
    latents.push_back(std::move(snapshot.instances.front().latent));
    return {};
  }

  Status visit_all(const Visit& visit) {
    ENGRAM_ASSIGN_OR_RETURN(const encoders::LatentArrays arrays, model.stored(latents));
    CellMaker maker(model, arrays, grid);
    for (size_t i = 0; i < times.size(); ++i) {
      if (!arrays.is_latent.front()[i]) {
        ++others;
        continue;
      }
      ENGRAM_RETURN_IF_ERROR(visit({entity.at(times[i]).instance(0), times[i], maker.cells(i)}));
    }
    times.clear();
    latents.clear();
    return {};
  }
};

LatentImages::LatentImages(std::unique_ptr<State> state) : state_(std::move(state)) {}
LatentImages::LatentImages(LatentImages&&) noexcept = default;
LatentImages::~LatentImages() = default;

Result<std::vector<LatentImages>> LatentImages::open(ltm::StoreReader& store,
                                                     const std::optional<uint64_t>& model) {
  std::vector<LatentImages> all;
  for (const ltm::MemoryId& entity : store.entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::EntitySummary summary, store.summary(entity));
    const ltm::ModelInfo* info = model_of(summary.models, model);
    if (info == nullptr) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto opened, encoders::OpenModel::open(store.path() / info->file));
    if (opened.images().empty()) continue;
    auto state = std::make_unique<State>(store, entity, *info, std::move(opened));
    state->grid = grid_of(state->model.images().front());
    all.push_back(LatentImages(std::move(state)));
  }
  if (all.empty())
    return not_found("store '{}': no entity has images as latents of {}", store.path().string(),
                     model ? "the model that is needed" : "a network");
  return all;
}

const ltm::MemoryId& LatentImages::entity() const {
  return state_->entity;
}
uint64_t LatentImages::model() const {
  return state_->info.checksum;
}
const CellGrid& LatentImages::grid() const {
  return state_->grid;
}
size_t LatentImages::others() const {
  return state_->others;
}

Status LatentImages::read(Time from, Time to, const Visit& visit, const ProgressSink& progress,
                          const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, state_->store.index(entity()));
  for (size_t i = 0; i < index->size(); ++i) {
    if (stop.stop_requested()) return cancelled("reading images of '{}'", entity().to_string());
    const ltm::SnapshotEntry& entry = (*index)[i];
    if (entry.time < from || entry.time > to) continue;
    ENGRAM_RETURN_IF_ERROR(state_->take(entry));
    if (state_->times.size() < kMaxReadTogether) continue;
    ENGRAM_RETURN_IF_ERROR(state_->visit_all(visit));
    if (progress)
      progress(
          {.what = "read images of " + entity().to_string(), .done = i, .total = index->size()});
  }
  return state_->visit_all(visit);
}

Result<std::vector<ImageCells>> LatentImages::encode(std::span<const idf::Data> values) {
  ENGRAM_ASSIGN_OR_RETURN(const encoders::LatentArrays arrays, state_->model.encode(values));
  CellMaker maker(state_->model, arrays, state_->grid);
  std::vector<ImageCells> all;
  for (size_t i = 0; i < values.size(); ++i) all.push_back(maker.cells(i));
  return all;
}

}  // namespace engram::speech
