#include "batch.h"

#include <algorithm>

namespace carom_bench {
namespace {

// Where in[18] holds the velocity that out[k] is the outcome of: v and w of ball 1, then of ball 2.
constexpr std::size_t velocity_column(std::size_t k) { return k < 6 ? k + 3 : k + 6; }

}  // namespace

Batch::Batch(const std::vector<CaseRow>& rows) : status_(rows.size()) {
  std::copy_n(rows.front().begin(), params_.size(), params_.begin());
  for (const CaseRow& row : rows) {
    u_b_.push_back(row[kUb]);
    for (std::size_t k = 0; k < in_.size(); ++k) in_[k].push_back(row[kBall1 + k]);
  }
  for (Column& column : out_) column.resize(rows.size());
}

std::size_t Batch::call(BatchFunction function, std::size_t start, std::size_t n, bool each_u_b) {
  const double* in[18];
  double* out[12];
  for (std::size_t k = 0; k < in_.size(); ++k) in[k] = in_[k].data() + start;
  for (std::size_t k = 0; k < out_.size(); ++k) {
    out[k] = (aliased_ ? in_[velocity_column(k)] : out_[k]).data() + start;
  }
  const double* u_b = each_u_b ? u_b_.data() + start : nullptr;
  return function(params_.data(), u_b, n, in, out, status_.data() + start);
}

const Batch::Column& Batch::outcome_column(std::size_t k) const {
  return aliased_ ? in_[velocity_column(k)] : out_[k];
}

OutcomeRow Batch::outcome(std::size_t i) const {
  OutcomeRow row{};
  for (std::size_t k = 0; k < out_.size(); ++k) row[k] = outcome_column(k)[i];
  row.back() = status_[i];
  return row;
}

void Batch::alias() { aliased_ = true; }

void set_parameter(CaseRow* row, std::size_t column, double value) {
  if (column == kR) {
    const double scale = (*row)[kR] / value;
    for (std::size_t ball : {std::size_t{kBall1}, std::size_t{kBall2}}) {
      for (std::size_t i = 6; i < 9; ++i) (*row)[ball + i] *= scale;
    }
  }
  (*row)[column] = value;
}

std::vector<CaseRow> with_shared_parameters(std::vector<CaseRow> rows) {
  const CaseRow first = rows.front();
  for (CaseRow& row : rows) {
    for (std::size_t column = kR; column < kBall1; ++column) {
      if (column != kUb && row[column] != first[column]) set_parameter(&row, column, first[column]);
    }
  }
  return rows;
}

}  // namespace carom_bench
