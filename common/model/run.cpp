// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/run.hpp"

#include <cmath>
#include <limits>

namespace eti {
namespace {

// Weighted mean over parts; parts without a value or with zero weight do not count. NaN where a weight is
// unknown.
class WeightedMean {
  public:
    void add(double value, double weight) {
        if (!std::isnan(value) && !(weight <= 0.0)) {
            sum_ += value * weight;
            weight_ += weight;
        }
    }
    [[nodiscard]] double value(double otherwise) const { return weight_ == 0.0 ? otherwise : sum_ / weight_; }

  private:
    double sum_ = 0.0, weight_ = 0.0;
};

double combine(const MetricField& field, std::span<const RunPart> parts, const RunPart* passage) {
    double value = field.start;
    WeightedMean mean;
    for (const RunPart& part : parts) {
        const double of_attempt = part.metrics.*field.value;
        switch (field.combine) {
            case Aggregation::greatest:
                value = std::fmax(value, of_attempt);
                break;
            case Aggregation::least:
                value = std::fmin(value, of_attempt);
                break;
            case Aggregation::sum:
                value += of_attempt;
                break;
            case Aggregation::time_mean:
                mean.add(of_attempt, part.weights.time);
                break;
            case Aggregation::view_mean:
                mean.add(of_attempt, part.weights.view);
                break;
            case Aggregation::tube_mean:
                mean.add(of_attempt, part.weights.tube);
                break;
            case Aggregation::passage:
            case Aggregation::last:
                value = of_attempt;
                break;
        }
    }
    if (field.combine == Aggregation::passage) {
        return passage != nullptr ? passage->metrics.*field.value : std::numeric_limits<double>::quiet_NaN();
    }
    return mean.value(value);
}

}  // namespace

AttemptMetrics combine(std::span<const RunPart> parts) {
    // The last passage of the glottis; without one, the best view.
    const RunPart* passage = nullptr;
    for (const RunPart& part : parts) {
        if (passage == nullptr || part.passed_glottis ||
            (!passage->passed_glottis &&
             part.metrics.glottic_opening_max_percent > passage->metrics.glottic_opening_max_percent)) {
            passage = &part;
        }
    }
    AttemptMetrics run;
    for (const MetricField& field : metric_fields) {
        run.*field.value = combine(field, parts, passage);
    }
    return run;
}

}  // namespace eti
