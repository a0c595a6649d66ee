// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "common/model/parameters.hpp"

namespace eti {

/// How a value stands to its aim. Unknown where the value does not exist or nothing is aimed at.
enum class Light : std::uint8_t { unknown, reached, near, missed };

[[nodiscard]] std::string_view name_of(Light light);

/// When in a session an aim was missed.
enum class AimMoment : std::uint8_t {
    crossed,         ///< the first step whose value is beyond the aim
    best_view,       ///< when most of the glottis was in sight
    second_attempt,  ///< when it began
    end,             ///< of the last attempt
};

/// An aim as numbers, for reports: what is measured is best small. The aim's words and source stand with its
/// parameter (ParameterField::norm).
struct Aim {
    std::string_view key;  ///< of the parameter
    /// What must be small. `first`: what the session began with.
    double (*measure)(const Parameters& values, const Parameters& first);
    double reached;     ///< at most this: the aim is reached
    double near;        ///< at most this: nearly; beyond it, missed. Chosen unless `practise` says otherwise
    bool each_attempt;  ///< holds for each attempt, so that a run is as good as its worst
    AimMoment moment;
    std::string_view practise;  ///< what to do about it; empty where another aim says the same
};

/// Every aim, in the order of parameter_fields.
extern const std::span<const Aim> aims;

/// 0 or less: reached; up to 1: nearly; more: missed. NaN where a value does not exist. An aim that nobody
/// calls missed (`near` is infinite) stays below 1.
[[nodiscard]] double shortfall(const Aim& aim, const Parameters& values, const Parameters& first);

[[nodiscard]] Light light_of(double shortfall);

}  // namespace eti
