// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_examples.h"

#include <algorithm>
#include <optional>

#include "speech/sights/changed_images.h"

namespace engram::speech {

namespace {

/// Where images pause for so long, another recording begins.
constexpr Duration kPause = std::chrono::minutes(1);
/// Of so many recordings one is held out; of fewer the last one.
constexpr size_t kHeldOutOf = 8;
/// How colours look is measured on every so many images.
constexpr size_t kLookedAt = 8;
/// Copies that are encoded together.
constexpr size_t kMaxEncodedTogether = 128;

/// An image with what it shows.
struct KnownImage {
  LatentImage image;
  ImageTruth truth;
  size_t recording = 0;
};

torch::Tensor halves(const ImageCells& cells, const CellGrid& grid) {
  return torch::tensor(cells).view({grid.channels, grid.rows, grid.columns}).to(torch::kHalf);
}

/// Collects images to batches. The number of kinds is known once all memories are read.
class BatchMaker {
 public:
  BatchMaker(const CellGrid& grid, size_t kinds)
      : grid_(grid), kinds_(static_cast<int64_t>(kinds)) {}

  void add(const torch::Tensor& cells, const ImageTruth& truth) {
    cells_.push_back(cells);
    std::vector<int64_t> of_cells;
    for (const int64_t kind : truth.kinds)
      of_cells.push_back(kind == ImageTruth::kNothing   ? kinds_
                         : kind == ImageTruth::kUnclear ? SightBatch::kNotLearned
                                                        : kind);
    of_cells_.push_back(torch::tensor(of_cells).view({grid_.rows, grid_.columns}));
    torch::Tensor where = torch::full({kinds_}, SightBatch::kNotLearned, torch::kLong);
    torch::Tensor colours = where.clone();
    torch::Tensor sight = torch::zeros({kinds_}, torch::kBool);
    for (const TrueSight& thing : truth.things) {
      where[thing.kind] = thing.where;
      if (thing.colour >= 0) colours[thing.kind] = thing.colour;
      if (thing.is_in_sight) sight[thing.kind] = true;
    }
    where_.push_back(where);
    colours_.push_back(colours);
    sight_.push_back(sight);
  }

  SightBatch take() {
    if (cells_.empty()) return {};
    return {torch::stack(cells_), torch::stack(of_cells_), torch::stack(where_),
            torch::stack(colours_), torch::stack(sight_)};
  }

 private:
  const CellGrid& grid_;
  int64_t kinds_;
  std::vector<torch::Tensor> cells_, of_cells_, where_, colours_, sight_;
};

/// Where things are in a mirror: in the other hand.
std::vector<int64_t> mirrored(const std::vector<std::string>& where) {
  std::vector<int64_t> other(where.size());
  const auto place = [&where](const char* name, size_t otherwise) {
    const auto found = std::find(where.begin(), where.end(), name);
    return static_cast<int64_t>(found == where.end() ? otherwise
                                                     : static_cast<size_t>(found - where.begin()));
  };
  for (size_t i = 0; i < where.size(); ++i)
    other[i] = where[i] == "left"    ? place("right", i)
               : where[i] == "right" ? place("left", i)
                                     : static_cast<int64_t>(i);
  return other;
}

/// One memory that is learned from.
struct Lesson {
  std::unique_ptr<ltm::StoreReader> store;
  std::unique_ptr<Memory> memory;
  std::optional<TrueSights> sights;
  std::vector<LatentImages> images;
  std::vector<std::vector<KnownImage>> known;  ///< Of each of `images`.
};

class ExampleReader {
 public:
  ExampleReader(SightExamples& examples, const LearnSightsOptions& options,
                const ProgressSink& progress, const std::stop_token& stop)
      : examples_(examples), options_(options), progress_(progress), stop_(stop) {}

  Status read_store(const std::filesystem::path& path) {
    Lesson& lesson = lessons_.emplace_back();
    ENGRAM_ASSIGN_OR_RETURN(lesson.store, ltm::StoreReader::open(path));
    ENGRAM_ASSIGN_OR_RETURN(lesson.memory,
                            Memory::open(path, {.is_read_only = true, .notes_reads = false}));
    ENGRAM_ASSIGN_OR_RETURN(auto sights, TrueSights::read(*lesson.memory, examples_.words));
    lesson.sights.emplace(std::move(sights));
    ENGRAM_ASSIGN_OR_RETURN(lesson.images, LatentImages::open(*lesson.store));
    for (LatentImages& images : lesson.images) {
      if (examples_.model == 0) {
        examples_.model = images.model();
        examples_.grid = images.grid();
      }
      if (images.model() != examples_.model)
        return invalid_argument(
            "store '{}': '{}' has latents of another model; sights are of one model alone",
            path.string(), images.entity().to_string());
      ENGRAM_RETURN_IF_ERROR(read_images(lesson, images));
    }
    return {};
  }

  Status finish() {
    const size_t recordings = examples_.report.recordings;
    if (recordings < 2)
      return invalid_argument(
          "learning sights: found {} recording with images whose things are known, needs 2",
          recordings);
    if (examples_.words.colours.empty()) examples_.words.colours.emplace_back();
    BatchMaker learned(examples_.grid, examples_.words.kinds.size());
    BatchMaker held_out(examples_.grid, examples_.words.kinds.size());
    for (Lesson& lesson : lessons_)
      for (size_t i = 0; i < lesson.images.size(); ++i) {
        for (const KnownImage& known : lesson.known[i])
          (is_held_out(known.recording) ? held_out : learned)
              .add(halves(known.image.cells, examples_.grid), known.truth);
        ENGRAM_RETURN_IF_ERROR(add_copies(lesson, i, learned));
      }
    for (size_t i = 0; i < recordings; ++i) examples_.report.held_out += is_held_out(i) ? 1 : 0;
    examples_.learned = learned.take();
    examples_.held_out = held_out.take();
    return {};
  }

 private:
  Status read_images(Lesson& lesson, LatentImages& images) {
    std::vector<KnownImage>& known = lesson.known.emplace_back();
    std::optional<Time> last;
    const auto take = [&](LatentImage image) -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, lesson.sights->value_of(image));
      ENGRAM_ASSIGN_OR_RETURN(auto truth, lesson.sights->of(image, value, images.grid()));
      if (!truth) return {};
      if (!last || image.time - *last > kPause) ++examples_.report.recordings;
      last = image.time;
      const idf::NdArray* pixels = image_in(value);
      if (pixels != nullptr && known.size() % kLookedAt == 0) looks_.see(*pixels, *truth);
      known.push_back({std::move(image), *std::move(truth), examples_.report.recordings - 1});
      ++examples_.report.images;
      return {};
    };
    return images.read(Time::min(), Time::max(), take, progress_, stop_);
  }

  [[nodiscard]] bool is_held_out(size_t recording) const {
    const size_t count = examples_.report.recordings;
    return count < kHeldOutOf ? recording + 1 == count : recording % kHeldOutOf == kHeldOutOf - 1;
  }

  /// Adds changed copies of images. Those of one recording are encoded together.
  Status add_copies(Lesson& lesson, size_t index, BatchMaker& learned) {
    const std::vector<KnownImage>& known = lesson.known[index];
    const std::vector<int64_t> in_mirror = mirrored(examples_.words.where);
    std::vector<idf::Data> values;
    std::vector<ImageTruth> truths;
    const auto encode = [&]() -> Status {
      if (values.empty()) return {};
      ENGRAM_ASSIGN_OR_RETURN(const auto cells, lesson.images[index].encode(values));
      for (size_t i = 0; i < cells.size(); ++i)
        learned.add(halves(cells[i], examples_.grid), truths[i]);
      examples_.report.copies += cells.size();
      values.clear();
      truths.clear();
      return {};
    };
    for (size_t i = 0; i < known.size() && options_.copies > 0; ++i) {
      if (stop_.stop_requested()) return cancelled("learning sights was stopped");
      if (i > 0 && known[i].recording != known[i - 1].recording) ENGRAM_RETURN_IF_ERROR(encode());
      if (is_held_out(known[i].recording)) continue;
      ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, lesson.sights->value_of(known[i].image));
      const idf::NdArray* pixels = image_in(value);
      if (pixels == nullptr) continue;
      for (int copy = 0; copy < options_.copies; ++copy) {
        ChangedImage changed =
            change_image(*pixels, known[i].truth, examples_.grid, looks_, in_mirror, random_);
        values.push_back(with_image(value, std::move(changed.image)));
        truths.push_back(std::move(changed.truth));
      }
      if (values.size() >= kMaxEncodedTogether) ENGRAM_RETURN_IF_ERROR(encode());
      if (progress_ && i % 16 == 0)
        progress_({.what = "change and encode images", .done = i, .total = known.size()});
    }
    return encode();
  }

  SightExamples& examples_;
  const LearnSightsOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::vector<Lesson> lessons_;
  ColourLooks looks_;
  std::mt19937_64 random_{options_.seed};
};

}  // namespace

Result<SightExamples> read_examples(const std::vector<std::filesystem::path>& stores,
                                    const LearnSightsOptions& options, const ProgressSink& progress,
                                    const std::stop_token& stop) {
  SightExamples examples;
  ExampleReader reader(examples, options, progress, stop);
  for (const std::filesystem::path& store : stores)
    ENGRAM_RETURN_IF_ERROR(reader.read_store(store));
  ENGRAM_RETURN_IF_ERROR(reader.finish());
  return examples;
}

}  // namespace engram::speech
