// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/run.hpp"

#include <cmath>
#include <limits>

namespace eti {
namespace {

// Mean over parts, weighted; parts without a value or without weight do not count. NaN where a weight is
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

double combine(const ParameterField& field, std::span<const RunPart> parts, const RunPart* passage) {
    double value = field.start;
    WeightedMean mean;
    for (const RunPart& part : parts) {
        const double of_attempt = part.parameters.*field.value;
        switch (field.combine) {
            case Combine::greatest:
                value = std::fmax(value, of_attempt);
                break;
            case Combine::least:
                value = std::fmin(value, of_attempt);
                break;
            case Combine::sum:
                value += of_attempt;
                break;
            case Combine::time_mean:
                mean.add(of_attempt, part.weights.time);
                break;
            case Combine::view_mean:
                mean.add(of_attempt, part.weights.view);
                break;
            case Combine::tube_mean:
                mean.add(of_attempt, part.weights.tube);
                break;
            case Combine::passage:
            case Combine::last:
                value = of_attempt;
                break;
        }
    }
    if (field.combine == Combine::passage) {
        return passage != nullptr ? passage->parameters.*field.value
                                  : std::numeric_limits<double>::quiet_NaN();
    }
    return mean.value(value);
}

}  // namespace

Parameters combine(std::span<const RunPart> parts) {
    // The last passage of the glottis; without one, the best view.
    const RunPart* passage = nullptr;
    for (const RunPart& part : parts) {
        if (passage == nullptr || part.passed_glottis ||
            (!passage->passed_glottis &&
             part.parameters.glottic_opening_max_percent > passage->parameters.glottic_opening_max_percent)) {
            passage = &part;
        }
    }
    Parameters run;
    for (const ParameterField& field : parameter_fields) {
        run.*field.value = combine(field, parts, passage);
    }
    return run;
}

}  // namespace eti
