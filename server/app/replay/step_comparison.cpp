// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/step_comparison.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "common/session/cell.hpp"
#include "common/session/layout.hpp"

namespace eti::app {

namespace {

/// The number that contains the first differing byte.
template <class Field>
double number_at(const std::vector<std::byte>& row, std::size_t byte) {
    if constexpr (std::is_same_v<Field, bool>) {
        return row[byte] != std::byte{0} ? 1.0 : 0.0;
    } else {
        using Number = std::conditional_t<std::is_arithmetic_v<Field>, Field, float>;
        Number number{};
        std::memcpy(&number, row.data() + byte / sizeof number * sizeof number, sizeof number);
        return static_cast<double>(number);
    }
}

}  // namespace

void StepComparison::compare(const session::StepRecord& recorded, const session::StepRecord& simulated,
                             std::size_t row) {
    bool same = true;
    session::step_columns(tube_nodes_)(
        [&](const std::string& path, const hdf5::Label&, auto field, std::size_t width) {
            using Field = std::decay_t<decltype(field(recorded))>;
            using Cell = session::Cell<Field>;
            // After the first difference, only counts.
            if (!same && first_) {
                return;
            }
            recorded_.resize(Cell::bytes(width));
            simulated_.resize(Cell::bytes(width));
            Cell::pack(field(recorded), width, recorded_.data());
            Cell::pack(field(simulated), width, simulated_.data());
            const auto [a, b] = std::ranges::mismatch(recorded_, simulated_);
            if (a == recorded_.end() || !has_row_(path, row)) {
                return;
            }
            same = false;
            if (!first_) {
                const auto byte = static_cast<std::size_t>(a - recorded_.begin());
                first_ = {simulated.step, 1e-9 * static_cast<double>(simulated.time_ns), path,
                          number_at<Field>(recorded_, byte), number_at<Field>(simulated_, byte)};
            }
        });
    ++steps_;
    equal_ += same ? 1 : 0;
}

}  // namespace eti::app
