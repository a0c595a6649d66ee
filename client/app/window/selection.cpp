// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/selection.hpp"

#include <algorithm>

#include "client/text/catalogue.hpp"

namespace eti::client {
namespace {

const std::vector<Selection>& selection_table() {
    static const std::vector<Selection> rows = [] {
        std::vector<Selection> out;
        Selection all{.name = text::translatable("all"),
                      .key = '4',
                      .help = text::translatable("every view, side by side"),
                      .plain = {},
                      .enhanced = {}};
        Selection automatic{
            .name = text::translatable("auto"),
            .key = '0',
            .help = text::translatable("the scenario's view; with enhanced view also the section"),
            .plain = {},
            .enhanced = {}};
        for (const render::View& view : render::views()) {
            out.push_back({view.name, view.key, view.help, {&view}, {&view}});
            if (view.auto_show == render::AutoShow::alone) {
                continue;
            }
            all.plain.push_back(&view);
            if (view.auto_show == render::AutoShow::always) {
                automatic.plain.push_back(&view);
            }
            if (view.auto_show != render::AutoShow::never) {
                automatic.enhanced.push_back(&view);
            }
        }
        all.enhanced = all.plain;
        const Views from_four_sides{render::view_named("overview"), render::view_named("section"),
                                    render::view_named("laryngoscope"), render::view_named("eye")};
        out.push_back(all);
        out.push_back({.name = text::translatable("four"),
                       .key = '7',
                       .help = text::translatable("overview, section, blade and eye in equal size"),
                       .plain = from_four_sides,
                       .enhanced = from_four_sides,
                       .arrangement = Arrangement::even});
        out.push_back(automatic);
        return out;
    }();
    return rows;
}

template <class Value>
const Selection* row_with(Value Selection::*member, Value value) {
    const auto found = std::ranges::find(selection_table(), value, member);
    return found == selection_table().end() ? nullptr : &*found;
}

}  // namespace

std::optional<Views> visible_views(const Selection& selection, const view::SceneView& scene, bool minimised) {
    if (minimised) {
        return std::nullopt;
    }
    return scene.has_all_frames() ? selection.views(scene) : Views{};
}

std::span<const Selection> selections() {
    return selection_table();
}

const Selection& default_selection() {
    return selection_table().back();
}

const Selection& instructor_selection() {
    return *selection_named("four");
}

const Selection* selection_named(std::string_view name) {
    return row_with(&Selection::name, name);
}

const Selection* selection_for_key(char key) {
    return row_with(&Selection::key, key);
}

}  // namespace eti::client
