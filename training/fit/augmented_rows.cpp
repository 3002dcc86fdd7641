// SPDX-License-Identifier: Apache-2.0
#include "training/fit/augmented_rows.h"

#include <algorithm>
#include <cstring>

#include "encoders/coded_background.h"
#include "training/fit/windows.h"

namespace engram::training {

using torch::Tensor;

namespace {

/// The used part of one run.
struct Reach {
  size_t run = 0;
  size_t rows = 0;      ///< Rows that are trained on.
  size_t held_out = 0;  ///< Held-out rows at the end of them.
};

/// Finds the part of each run that was made of recordings that are trained on.
std::vector<Reach> reaches_of(const TrainingSource& source, size_t left_out_sequences) {
  std::vector<Sequence> sequences = cut_sequences(source.times);
  sequences.resize(sequences.size() - left_out_sequences);
  std::vector<Reach> reaches;
  for (size_t run = 0; run < source.augmented->origins.size(); ++run) {
    const std::vector<size_t>& origins = source.augmented->origins[run];
    const auto of_first = [&](const Sequence& one) {
      return origins.front() >= one.first && origins.front() < one.end;
    };
    const auto sequence = std::ranges::find_if(sequences, of_first);
    if (sequence == sequences.end()) continue;
    const auto before = [&](size_t end) {
      return static_cast<size_t>(
          std::ranges::count_if(origins, [end](size_t origin) { return origin < end; }));
    };
    const size_t rows = before(sequence->end);
    reaches.push_back({run, rows, rows - before(held_out_from(*sequence))});
  }
  return reaches;
}

/// Keeps evenly spaced runs with at most `max` rows.
std::vector<Reach> thinned_reaches(std::vector<Reach> reaches, size_t max) {
  size_t total = 0;
  for (const Reach& reach : reaches) total += reach.rows;
  if (total <= max) return reaches;
  const size_t stride = (total + max - 1) / std::max<size_t>(max, 1);
  std::vector<Reach> kept;
  for (size_t i = 0; i < reaches.size(); i += stride) kept.push_back(reaches[i]);
  return kept;
}

/// Median of images as input of the networks. Shape: [N, C, H, W]. Unit: grey levels.
Tensor median_of(const Tensor& images) {
  return std::get<0>(images.median(0, true));
}

/// A background after coding in a quality; unchanged if no codec accepts it.
Tensor coded(const encoders::ImageMember& member, const encoders::ImageShape& shape,
             const Tensor& background, size_t quality) {
  if (member.is_depth) return background;
  const auto one = encoders::code_background(encoders::to_image_array(member, background), quality);
  if (!one.ok() || !*one) return background;
  const Tensor pixels =
      torch::from_blob(const_cast<std::byte*>((*one)->pixels.bytes().data()),
                       {1, member.height, member.width, member.channels}, torch::kUInt8);
  return encoders::to_grey_levels(member, shape, pixels);
}

class Reader {
 public:
  Reader(const TrainingSource& source, const Dataset& data) : source_(source), data_(data) {}

  Result<AugmentedRows> read(const std::vector<Reach>& reaches, const std::stop_token& stop) {
    size_t total = 0;
    for (const Reach& reach : reaches) total += reach.rows;
    allocate(static_cast<int64_t>(total));
    for (const Reach& reach : reaches) {
      const auto first = static_cast<size_t>(row_);
      for (size_t i = 0; i < reach.rows; ++i) {
        if (stop.stop_requested()) return cancelled("training of {} was stopped", source_.entity);
        ENGRAM_RETURN_IF_ERROR(read(reach.run, i));
      }
      rows_.sequences.push_back({first, first + reach.rows});
      rows_.first_held_out.push_back(first + reach.rows - reach.held_out);
      const auto sequence = static_cast<int64_t>(rows_.sequences.size() - 1);
      rows_.sequence.slice(0, static_cast<int64_t>(first), row_).fill_(sequence);
    }
    if (data_.numbers.defined()) rows_.numbers = normalised();
    return std::move(rows_);
  }

 private:
  void allocate(int64_t rows) {
    for (const auto& image : data_.plan.images())
      rows_.images.push_back(torch::empty({rows, image.height, image.width, image.channels},
                                          image.is_depth ? torch::kInt16 : torch::kUInt8));
    plain_ = torch::empty({rows, static_cast<int64_t>(data_.plan.number_count())}, torch::kFloat64);
    rows_.sequence = torch::zeros({rows}, torch::kLong);
  }

  Status read(size_t run, size_t index) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, source_.augmented->read(run, index));
    auto split = data_.plan.layout().split(value);
    if (!split.ok()) return split.status().with_context(source_.entity + ", augmented");
    for (size_t i = 0; i < rows_.images.size(); ++i) {
      const auto bytes = split->tensors[data_.plan.images()[i].member].bytes();
      std::memcpy(rows_.images[i].select(0, row_).data_ptr(), bytes.data(), bytes.size());
    }
    const std::vector<double> numbers = data_.plan.read_numbers(*split);
    std::ranges::copy(numbers, plain_.select(0, row_).data_ptr<double>());
    ++row_;
    return {};
  }

  /// Normalises numbers as in the dataset; numbers that are not finite become 0.
  [[nodiscard]] Tensor normalised() const {
    Tensor values = torch::zeros(plain_.sizes());
    for (size_t i = 0; i < data_.mean.size(); ++i) {
      if (!(data_.deviation[i] > 0)) continue;
      const auto at = static_cast<int64_t>(i);
      values.select(1, at).copy_(
          torch::nan_to_num((plain_.select(1, at) - data_.mean[i]) / data_.deviation[i], 0, 0, 0));
    }
    return values;
  }

  const TrainingSource& source_;
  const Dataset& data_;
  AugmentedRows rows_;
  Tensor plain_;
  int64_t row_ = 0;
};

void find_backgrounds(const Dataset& data, AugmentedRows& rows) {
  const auto shape = encoders::network_shape(data.plan, {});
  for (size_t i = 0; i < rows.images.size(); ++i) {
    std::vector<Tensor> backgrounds;
    for (size_t s = 0; s < rows.sequences.size(); ++s) {
      const Tensor pixels = rows.images[i].slice(0, static_cast<int64_t>(rows.sequences[s].first),
                                                 static_cast<int64_t>(rows.sequences[s].end));
      const auto& member = data.plan.images()[i];
      const Tensor median = median_of(encoders::to_grey_levels(member, shape.images[i], pixels));
      backgrounds.push_back(
          coded(member, shape.images[i], median, s % encoders::kBackgroundQualities));
    }
    rows.backgrounds.push_back(torch::cat(backgrounds));
  }
}

uint64_t row_bytes(const encoders::TensorPlan& plan) {
  uint64_t bytes = plan.number_count() * sizeof(double);
  for (const auto& image : plan.images())
    bytes += static_cast<uint64_t>(image.height) * static_cast<uint64_t>(image.width) *
             static_cast<uint64_t>(image.channels) * (image.is_depth ? 2 : 1);
  return bytes;
}

}  // namespace

Result<AugmentedRows> read_augmented(const TrainingSource& source, const Dataset& data,
                                     uint64_t memory_bytes, const std::stop_token& stop) {
  const auto reaches = thinned_reaches(reaches_of(source, data.left_out_sequences),
                               memory_bytes / std::max<uint64_t>(row_bytes(data.plan), 1));
  ENGRAM_ASSIGN_OR_RETURN(AugmentedRows rows, Reader(source, data).read(reaches, stop));
  if (!rows.sequences.empty()) find_backgrounds(data, rows);
  return rows;
}

}  // namespace engram::training
