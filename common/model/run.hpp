// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/model/parameters.hpp"

namespace eti {

/// Parameters of one attempt, with what a run over several needs to weigh them.
struct RunPart {
    /// [s] that means were taken over; NaN where that is not known.
    struct Weights {
        double time = 0.0, view = 0.0, tube = 0.0;
    };
    Parameters parameters;
    Weights weights;
    bool passed_glottis = false;
};

/// The run's parameters, as parameter_fields say: maxima, sums, means weighted by time. NaN for a mean of
/// several attempts whose weights are not known.
[[nodiscard]] Parameters combine(std::span<const RunPart> parts);

}  // namespace eti
