// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/notice_sights.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <set>

#include "encoders/threads.h"
#include "speech/facts/fact_members.h"
#include "speech/facts/known_facts.h"
#include "speech/sights/sight_file.h"
#include "speech/sights/sight_reading.h"

namespace engram::speech {

namespace {

/// Images that are read together.
constexpr size_t kTogether = 32;
/// Where a thing is, is read from so many of the last images that show it, taken so long before at
/// most: one alone is often wrong.
constexpr size_t kMaxRecent = 6;
constexpr Duration kRecent = std::chrono::seconds(4);
/// Images count for the colour of a thing by this power of how sure it is that they show it.
constexpr double kClearness = 6;
/// A thing no longer is in sight once so many images do not show it.
constexpr int kMaxMissed = 3;

/// What is known of the thing of one kind.
class ThingTrack {
 public:
  /// What to tell of an image, if anything. Shape: places [P], log_colours [C].
  std::optional<Sighting> see(Time time, double probability, double min_probability,
                              const torch::Tensor& places, const torch::Tensor& log_colours,
                              const SightWords& words) {
    if (probability < min_probability) {
      if (!last_ || !last_->is_in_sight || ++missed_ < kMaxMissed) return {};
      last_->is_in_sight = false;
      last_->time = time;
      return last_;
    }
    missed_ = 0;
    while (!recent_.empty() &&
           (recent_.size() >= kMaxRecent || time - recent_.front().first > kRecent))
      recent_.pop_front();
    recent_.emplace_back(time, places * probability);
    torch::Tensor sum = torch::zeros_like(places);
    for (const auto& [at, seen] : recent_) sum += seen;
    // Colours stay, and what is seen clearly counts for more.
    const torch::Tensor colours = std::pow(probability, kClearness) * log_colours;
    colours_ = colours_.defined() ? colours_ + colours : colours;
    Sighting sighting;
    sighting.time = time;
    sighting.is_in_sight = true;
    sighting.probability = probability;
    sighting.where = words.where.at(static_cast<size_t>(sum.argmax().item<int64_t>()));
    sighting.colour = words.colours.at(static_cast<size_t>(colours_.argmax().item<int64_t>()));
    last_ = sighting;
    return sighting;
  }

 private:
  std::deque<std::pair<Time, torch::Tensor>> recent_;
  torch::Tensor colours_;
  std::optional<Sighting> last_;
  int missed_ = 0;
};

/// Reads the images of one entity.
class SightReader {
 public:
  SightReader(SavedSights& network, const std::set<size_t>& skipped, NoticedSights& noticed)
      : network_(network),
        skipped_(skipped),
        noticed_(noticed),
        tracks_(network.words.kinds.size()) {}

  Status take(LatentImage image) {
    images_.push_back(std::move(image));
    return images_.size() < kTogether ? Status() : flush();
  }

  Status flush() {
    if (images_.empty()) return {};
    const CellGrid& grid = network_.grid;
    std::vector<torch::Tensor> cells;
    for (const LatentImage& image : images_)
      cells.push_back(torch::tensor(image.cells).view({grid.channels, grid.rows, grid.columns}));
    const SeenKinds seen = read_kinds(network_.layers, torch::stack(cells));
    for (size_t i = 0; i < images_.size(); ++i)
      ENGRAM_RETURN_IF_ERROR(tell(images_[i], seen, static_cast<int64_t>(i)));
    noticed_.images += images_.size();
    images_.clear();
    return {};
  }

 private:
  Status tell(const LatentImage& image, const SeenKinds& seen, int64_t row) {
    for (size_t kind = 0; kind < tracks_.size(); ++kind) {
      if (skipped_.contains(kind)) continue;
      const auto at = static_cast<int64_t>(kind);
      auto sighting = tracks_[kind].see(image.time, seen.sight[row][at].item<double>(),
                                        network_.min_probability, seen.places[row][at],
                                        seen.colours[row][at], network_.words);
      if (!sighting) continue;
      ENGRAM_ASSIGN_OR_RETURN(sighting->kind, ltm::MemoryId::parse(network_.words.kinds[kind]));
      sighting->image = image.id;
      noticed_.sightings.push_back(*std::move(sighting));
    }
    return {};
  }

  SavedSights& network_;
  const std::set<size_t>& skipped_;
  NoticedSights& noticed_;
  std::vector<ThingTrack> tracks_;
  std::vector<LatentImage> images_;
};

/// The kinds of things of whose poses others tell.
Result<std::set<std::string>> known_kinds(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(const auto memory,
                          Memory::open(store, {.is_read_only = true, .notes_reads = false}));
  ENGRAM_ASSIGN_OR_RETURN(const auto facts, KnownFacts::read(*memory));
  std::set<std::string> kinds;
  for (const KnownThing& thing : facts->world().things()) {
    if (!thing.entity || thing.entity->names()[2] == kSightsProvider) continue;
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, facts->value_at(thing.evidence));
    if (const auto kind = link_in(value, "object_class")) kinds.insert(kind->entity().to_string());
  }
  return kinds;
}

}  // namespace

Result<NoticedSights> notice_sights(const std::filesystem::path& store,
                                    const std::filesystem::path& network,
                                    const NoticeSightsOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  return encoders::guarded("noticing sights", [&]() -> Result<NoticedSights> {
    encoders::set_threads(1);
    ENGRAM_ASSIGN_OR_RETURN(SavedSights sights, read_sights(network));
    ENGRAM_ASSIGN_OR_RETURN(const auto known, known_kinds(store));
    NoticedSights noticed;
    std::set<size_t> skipped;
    for (size_t kind = 0; kind < sights.words.kinds.size(); ++kind) {
      if (!known.contains(sights.words.kinds[kind])) continue;
      skipped.insert(kind);
      ENGRAM_ASSIGN_OR_RETURN(noticed.known.emplace_back(),
                              ltm::MemoryId::parse(sights.words.kinds[kind]));
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
    ENGRAM_ASSIGN_OR_RETURN(auto all, LatentImages::open(*reader, sights.model));
    for (LatentImages& images : all) {
      if (images.grid() != sights.grid) continue;
      SightReader reading(sights, skipped, noticed);
      ENGRAM_RETURN_IF_ERROR(images.read(
          options.from, options.to,
          [&reading](LatentImage image) { return reading.take(std::move(image)); }, progress,
          stop));
      ENGRAM_RETURN_IF_ERROR(reading.flush());
      noticed.others += images.others();
    }
    std::stable_sort(noticed.sightings.begin(), noticed.sightings.end(),
                     [](const Sighting& a, const Sighting& b) { return a.time < b.time; });
    return noticed;
  });
}

}  // namespace engram::speech
