// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "encoders/open_model.h"
#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/store_reader.h"

namespace engram::speech {

/// How the cells of an image lie. Each is one place of the fine latents, eight pixels wide in small
/// images.
struct CellGrid {
  int channels = 0;
  int rows = 0;
  int columns = 0;

  [[nodiscard]] size_t cells() const {
    return static_cast<size_t>(rows) * static_cast<size_t>(columns);
  }
  [[nodiscard]] size_t count() const { return static_cast<size_t>(channels) * cells(); }
  friend bool operator==(const CellGrid&, const CellGrid&) = default;
};

/// The latents of one image as numbers for a network: in each cell the coarse ones around it, its
/// fine ones, and the background to which these tell the difference, at a quarter of its
/// resolution. Shape: [channels, rows, columns].
using ImageCells = std::vector<float>;

/// One image that a store keeps as latents.
struct LatentImage {
  ltm::MemoryId id;  ///< Of the instance.
  Time time{};
  ImageCells cells;
};

/// The first images of the snapshots of one entity, as latents of one model. No image is decoded.
///
/// Threading: one thread. The store must outlive it.
class LatentImages {
 public:
  /// Those of all entities that have a model with networks for images: the newest one, or the one
  /// whose file has this checksum.
  /// Errors: kNotFound where there are none; kDataLoss.
  static Result<std::vector<LatentImages>> open(ltm::StoreReader& store,
                                                const std::optional<uint64_t>& model = {});

  LatentImages(LatentImages&&) noexcept;
  ~LatentImages();

  [[nodiscard]] const ltm::MemoryId& entity() const;
  /// The checksum of the model's file.
  [[nodiscard]] uint64_t model() const;
  [[nodiscard]] const CellGrid& grid() const;
  /// How many of the images read so far are no latents of this model.
  [[nodiscard]] size_t others() const;

  /// Reads from `from` to `to` in the order of time. `visit` takes images one by one; its error
  /// ends the reading.
  /// Errors: kCancelled; kDataLoss; those of `visit`.
  using Visit = std::function<Status(LatentImage image)>;
  Status read(Time from, Time to, const Visit& visit, const ProgressSink& progress,
              const std::stop_token& stop);

  /// Makes the same of values of one recording that are not in the store.
  /// Errors: kInvalidArgument where a value has another layout than the model.
  Result<std::vector<ImageCells>> encode(std::span<const idf::Data> values);

 private:
  struct State;
  explicit LatentImages(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::speech
