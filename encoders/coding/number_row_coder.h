// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the coder of rows of numbers that encoder, decoder and training share.
//
// In shapes, C is the number of channels and N the number of numbers in a row. The history of a
// channel is kept in units: a step of a bounded number has 8191 units, other steps have one.

#include <array>
#include <span>
#include <vector>

#include "encoders/coding/adaptive_bit.h"
#include "encoders/coding/integer_coder.h"
#include "encoders/coding/mixer.h"
#include "encoders/coding/number_model.h"
#include "encoders/coding/number_units.h"
#include "encoders/coding/orientation.h"

namespace engram::encoders {

inline constexpr size_t kEstimates = 4;

/// Values of a channel in the last rows. Unit: units.
struct ChannelHistory {
  int64_t now = 0, last = 0, before = 0, earlier = 0;
  int64_t fast = 16;  ///< Moving means of the sizes of residuals. Unit: 1/16 step.
  int64_t slow = 16;
  int64_t residual = 0;  ///< The residual of the last row. Unit: steps.
};

/// Centres and widths of the distributions of a residual.
struct Estimates {
  std::array<int64_t, kEstimates> offset{};  ///< From the lattice's centre. Unit: 1/16 step.
  std::array<int32_t, kEstimates> scale{};   ///< 2^(x / 16) steps.
};

/// The adaptive models of the bits of a residual. They learn from every bit.
///
/// Threading: one thread.
class ResidualModels {
 public:
  explicit ResidualModels(const NumberModel& model);

  /// Codes a residual: the number of steps between a value and its prediction.
  template <typename Port>
  int64_t code(Port& port, size_t channel, bool is_first, const Estimates& estimates,
               int64_t last_residual, int64_t residual);

  /// Stores the learned state in `model` as the start of every block.
  void store(NumberModel& model) const;

 private:
  struct Place {
    const Estimates* estimates;
    size_t channel;
    bool is_first;
    size_t scale_class;
    size_t hold_class;
  };

  template <typename Port>
  bool code_bit(Port& port, const Place& place, size_t node, int channel_node,
                const std::array<uint64_t, kEstimates>& part,
                const std::array<uint64_t, kEstimates>& rest, bool bit);
  template <typename Port>
  int64_t code_magnitude(Port& port, const Place& place, int sign, int64_t magnitude);

  std::vector<AdaptiveBit> by_scale_;
  std::vector<AdaptiveBit> by_hold_;
  std::vector<AdaptiveBit> by_channel_;
  std::array<std::array<Mixer<kMixerInputs>, kNumberNodes>, 2> mixers_;
};

/// The data of one residual for training.
struct ResidualTrace {
  size_t channel = 0;
  bool is_first = false;
  std::array<int32_t, kScaleInputs> sizes{};  ///< 16 log2 of recent residuals.
  std::array<int64_t, kEstimates> offset{};
  int64_t residual = 0;
};

/// Codes the rows of one block in order.
///
/// Threading: one thread.
class NumberRowCoder {
 public:
  /// `model` must outlive the coder.
  explicit NumberRowCoder(const NumberModel& model);

  /// Encodes `row`, or decodes into it. An encoder replaces it by the values that will be decoded.
  /// Shape: row [N].
  template <typename Port>
  void code(Port& port, std::span<double> row);

  [[nodiscard]] ResidualModels& models() { return models_; }
  [[nodiscard]] const std::vector<ChannelHistory>& history() const { return history_; }
  /// Appends each residual to `trace`; null turns this off.
  void trace_to(std::vector<ResidualTrace>* trace) { trace_ = trace; }

 private:
  struct Prediction {
    int64_t centre = 0;  ///< Unit: units.
    Estimates estimates;
    std::array<int32_t, kScaleInputs> sizes{};
  };
  struct Cursor {
    size_t number = 0, channel = 0, orientation = 0;
  };

  void add_field(const NumberField& field);
  [[nodiscard]] int64_t feature(const PredictorTerm& term, size_t channel) const;
  [[nodiscard]] std::array<int32_t, kScaleInputs> sizes(size_t channel,
                                                        const Estimates& estimates) const;
  [[nodiscard]] int64_t adapted_change(size_t channel) const;
  [[nodiscard]] Prediction predict(size_t channel) const;
  void adapt(size_t channel);
  void learn(size_t channel, int64_t residual);
  void end_row(std::span<const double> row);
  template <typename Port>
  int64_t code_residual(Port& port, size_t channel, const Prediction& prediction, int64_t residual);
  template <typename Port>
  void code_number(Port& port, const NumberField& field, size_t channel, double& value);
  template <typename Port>
  void code_orientation(Port& port, size_t orientation, double bound_rad, size_t channel,
                        std::span<double, 4> value);
  [[nodiscard]] bool must_be_plain(const NumberField& field, size_t channel,
                                   std::span<const double> values) const;
  [[nodiscard]] bool any_must_be_plain(std::span<const double> row) const;
  void take_plain(const NumberField& field, size_t channel, double value);
  template <typename Port>
  void code_plain(Port& port, NumberKind kind, size_t number, double& value);
  template <typename Port>
  bool code_is_plain(Port& port, bool row_has_plain, size_t number, bool is_plain);
  template <typename Port>
  void code_field(Port& port, const NumberField& field, bool has_plain, Cursor& at,
                  std::span<double> row);

  const NumberModel& model_;
  ResidualModels models_;
  std::vector<ChannelHistory> history_;
  std::vector<int64_t> steps_;                 ///< Per channel. Unit: units.
  std::vector<std::vector<int32_t>> adapted_;  ///< Weights of the adapting prediction, in 1/65536.
  std::vector<std::array<Quaternion, 2>> orientations_;  ///< The last one and the one before.
  std::vector<double> last_row_;
  /// Per orientation: whether the last one was stored negated, and the probability that this
  /// changes.
  std::vector<bool> was_negative_;
  std::vector<AdaptiveBit> sign_changes_;
  AdaptiveBit any_plain_{64, 60};
  std::vector<AdaptiveBit> is_plain_;
  IntegerModel plain_;
  size_t rows_ = 0;
  // Sums of this row so far and of the row before. Unit: 1/16 step.
  int64_t row_sum_ = 0;
  int64_t row_before_ = 16;
  std::array<int64_t, 4> recent_{};
  std::vector<ResidualTrace>* trace_ = nullptr;
};

}  // namespace engram::encoders
