// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "client/render/views/view_table.hpp"

namespace eti::client {

using Views = std::vector<const render::View*>;

/// Layout of several views in a picture.
enum class Arrangement : std::uint8_t {
    first_large,  ///< the others in a column beside the first; in a row below it in a portrait picture
    even,         ///< equal sizes, two per row
};

/// What --view and a key select: one view, or several side by side.
struct Selection {
    std::string_view name;
    char key;
    std::string_view help;
    Views plain;     ///< the first is the largest
    Views enhanced;  ///< used while the session requests the enhanced view
    Arrangement arrangement = Arrangement::first_large;

    [[nodiscard]] const Views& views(const view::SceneView& scene) const {
        return scene.enhanced() ? enhanced : plain;
    }
};

/// The views of a selection to draw now: none while minimised, and no patient before its description is
/// complete.
[[nodiscard]] std::optional<Views> visible_views(const Selection& selection, const view::SceneView& scene,
                                                 bool minimised);

/// Each view of the table, then the multi-view selections: all, and those shown only on request.
[[nodiscard]] std::span<const Selection> selections();

/// The default selection.
[[nodiscard]] const Selection& default_selection();
/// The instructor's default: four sides at once.
[[nodiscard]] const Selection& instructor_selection();

/// The row of a name or key, or nullptr.
[[nodiscard]] const Selection* selection_named(std::string_view name);
[[nodiscard]] const Selection* selection_for_key(char key);

}  // namespace eti::client
