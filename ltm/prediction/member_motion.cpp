// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/member_motion.h"

namespace engram::ltm {

namespace {

bool has_row_before(const NumberSeries& series, size_t row) {
  return row > 0 && series.run_start(row) < row;
}

double change_at(const NumberSeries& series, size_t row, const RowMember& member) {
  return ValueRow::mean_square(member, series.row(row), series.row(row - 1));
}

}  // namespace

MemberMotion::MemberMotion(const NumberSeries& series, const std::vector<RowMember>& members)
    : thresholds_(members.size(), 0) {
  size_t changes = 0;
  for (size_t row = 0; row < series.rows(); ++row) {
    if (!has_row_before(series, row)) continue;
    ++changes;
    for (size_t i = 0; i < members.size(); ++i)
      thresholds_[i] += change_at(series, row, members[i]);
  }
  for (double& threshold : thresholds_)
    threshold *= kShare * kShare / static_cast<double>(changes > 0 ? changes : 1);
}

bool MemberMotion::is_moving(const NumberSeries& series, size_t row, const RowMember& member,
                             size_t index) const {
  return has_row_before(series, row) && change_at(series, row, member) > thresholds_[index];
}

}  // namespace engram::ltm
