// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <string_view>

namespace eti {

/// One row of a table of values that people set: a member of `Values` [SI], and how it is typed.
template <class Values>
struct Field {
    std::string_view name;     ///< in code, messages and files
    std::string_view section;  ///< section of a scenario that sets it; empty: not settable by this key
    std::string_view label;    ///< display name
    std::string_view unit;     ///< as typed: "deg", or empty for a ratio
    float per_unit;            ///< SI value of one typed unit
    float low, high;           ///< as typed
    float Values::*value;
    std::string_view help;  ///< one sentence or more: the effect of the value

    /// The name with its unit, as typed: "head_elevation_deg".
    [[nodiscard]] std::string key() const {
        std::string out(name);
        if (!unit.empty()) {
            out += '_';
            std::ranges::transform(unit, std::back_inserter(out),
                                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        }
        return out;
    }

    /// The key within its section, without the section's name.
    [[nodiscard]] std::string key_in_section() const {
        const std::string whole = key(), prefix = std::string(section) + "_";
        return whole.starts_with(prefix) ? whole.substr(prefix.size()) : whole;
    }

    /// A value [SI] clamped to the range.
    [[nodiscard]] float clamped(float quantity) const {
        return std::clamp(quantity, low * per_unit, high * per_unit);
    }

    /// The default in typed units.
    [[nodiscard]] float default_value() const { return Values{}.*value / per_unit; }
};

}  // namespace eti
