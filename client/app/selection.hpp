// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "client/render/view_table.hpp"

namespace eti::client {

using Views = std::vector<const render::View*>;

/// How several views share a picture.
enum class Arrangement : std::uint8_t {
    first_large,  ///< the others stand beside it one above the other; below it side by side where it is
                  ///< upright
    even,         ///< all alike, in rows of two
};

/// What --view names and a key shows: one view, or several side by side.
struct Selection {
    std::string_view name;
    char key;
    std::string_view help;
    Views plain;     ///< the first is the largest
    Views enhanced;  ///< while the session asks for the enhanced view
    Arrangement arrangement = Arrangement::first_large;

    [[nodiscard]] const Views& views(const view::SceneView& scene) const {
        return scene.enhanced() ? enhanced : plain;
    }
};

/// What of a selection a window draws now: nothing at all while it is minimised, and no patient before all of
/// it has been heard of.
[[nodiscard]] std::optional<Views> shown_now(const Selection& selection, const view::SceneView& scene,
                                             bool minimised);

/// Each view of the table, then those side by side: all, and what is shown by itself.
[[nodiscard]] std::span<const Selection> selections();

/// What is shown where nothing was asked for.
[[nodiscard]] const Selection& default_selection();
/// The same for an instructor: from four sides at once.
[[nodiscard]] const Selection& instructors_selection();

/// The row of a name or of a key, or nullptr.
[[nodiscard]] const Selection* selection_named(std::string_view name);
[[nodiscard]] const Selection* selection_of_key(char key);

}  // namespace eti::client
