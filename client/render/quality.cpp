// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/quality.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "client/render/gl/headless_context.hpp"

namespace eti::render {
namespace {

constexpr std::array quality_table{
    Quality{.name = "low",
            .help = "one sample per pixel, 512-texel shadows, soft only in front of the lens, no fine "
                    "relief, outlines as coarse as the surfaces, no refraction in the tube, no walls",
            .samples = 1,
            .shadow_size = 512,
            .coarse_shadows = true,
            .shadow_taps = 1,
            .lens_taps = 2,
            .lit_at_vertices = true,
            .refraction = false,
            .fine_outlines = false,
            .environment = false,
            .walls = false,
            .fine = false},
    Quality{.name = "medium",
            .help = "two samples per pixel, 1024-texel shadows, fine relief, reflections of the room",
            .samples = 2,
            .shadow_size = 1024,
            .coarse_shadows = false,
            .shadow_taps = 2,
            .lens_taps = 2,
            .lit_at_vertices = false,
            .refraction = true,
            .fine_outlines = true,
            .environment = true,
            .walls = true,
            .fine = true},
    Quality{.name = "high",
            .help = "four samples per pixel, soft 2048-texel shadows, fine relief, reflections of the room",
            .samples = 4,
            .shadow_size = 2048,
            .coarse_shadows = false,
            .shadow_taps = 4,
            .lens_taps = 4,
            .lit_at_vertices = false,
            .refraction = true,
            .fine_outlines = true,
            .environment = true,
            .walls = true,
            .fine = true},
};

}  // namespace

std::span<const Quality> qualities() {
    return quality_table;
}

const Quality* quality_named(std::string_view name) {
    const auto found = std::ranges::find(quality_table, name, &Quality::name);
    return found == quality_table.end() ? nullptr : &*found;
}

const Quality& affordable_quality() {
    const std::string driver = driver_name();
    const bool software =
        driver.find("llvmpipe") != std::string::npos || driver.find("softpipe") != std::string::npos;
    return software ? quality_table.front() : quality_table.back();
}

}  // namespace eti::render
