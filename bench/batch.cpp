#include "batch.h"

#include <algorithm>

namespace carom_bench {
Batch::Batch(const std::vector<CaseRow>& rows) : status_(rows.size()) {
  std::copy_n(rows.front().begin(), params_.size(), params_.begin());
  for (const CaseRow& row : rows) {
    varied_.push_back(row[kVaried]);
    for (std::size_t k = 0; k < in_.size(); ++k) in_[k].push_back(row[kParameters + k]);
  }
  for (Column& column : out_) column.resize(rows.size());
}

std::size_t Batch::call(BatchFunction function, std::size_t start, std::size_t n,
                        bool each_varied) {
  const double* in[kBodies];
  double* out[kOutcomes];
  for (std::size_t k = 0; k < in_.size(); ++k) in[k] = in_[k].data() + start;
  for (std::size_t k = 0; k < out_.size(); ++k) {
    out[k] = (aliased_ ? in_[kChanged[k]] : out_[k]).data() + start;
  }
  const double* varied = each_varied ? varied_.data() + start : nullptr;
  return function(params_.data(), varied, n, in, out, status_.data() + start);
}

const Batch::Column& Batch::outcome_column(std::size_t k) const {
  return aliased_ ? in_[kChanged[k]] : out_[k];
}

OutcomeRow Batch::outcome(std::size_t i) const {
  OutcomeRow row{};
  for (std::size_t k = 0; k < out_.size(); ++k) row[k] = outcome_column(k)[i];
  row.back() = status_[i];
  return row;
}

void Batch::alias() { aliased_ = true; }

void set_parameter(CaseRow* row, std::size_t column, double value) {
  if (column == kRadius) {
    const double scale = (*row)[kRadius] / value;
    for (std::size_t spin : kSpins) (*row)[spin] *= scale;
  }
  (*row)[column] = value;
}

std::vector<CaseRow> with_shared_parameters(std::vector<CaseRow> rows) {
  const CaseRow first = rows.front();
  for (CaseRow& row : rows) {
    for (std::size_t column = 0; column < kParameters; ++column) {
      if (column != kVaried && row[column] != first[column])
        set_parameter(&row, column, first[column]);
    }
  }
  return rows;
}

}  // namespace carom_bench
