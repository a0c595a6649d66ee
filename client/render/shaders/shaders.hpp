// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

/// GLSL sources embedded by the build: each is the file GROUP/NAME.glsl beside this header with its
/// includes expanded. Each file's leading comment states what it draws and which defines it uses.
namespace eti::render::shaders {

// scene
extern const std::string_view finer_vertex;
extern const std::string_view flat_fragment;
extern const std::string_view lamp_map;
extern const std::string_view mesh_vertex;
extern const std::string_view quad_vertex;
extern const std::string_view through_mouth;

// tissue
extern const std::string_view blood;
extern const std::string_view chest_rise;
extern const std::string_view cut_fragment;
extern const std::string_view cut_geometry;
extern const std::string_view cut_plane_vertex;
extern const std::string_view cut_surface_vertex;
extern const std::string_view film_mark_fragment;
extern const std::string_view film_mark_vertex;
extern const std::string_view film_vertex;
extern const std::string_view give_way;
extern const std::string_view skinning_vertex;
extern const std::string_view tissue_fragment;
extern const std::string_view tissue_lit_fragment;
extern const std::string_view tissue_lit_vertex;

// liquid
extern const std::string_view drop_shadow_fragment;
extern const std::string_view drop_shadow_vertex;
extern const std::string_view foam_fragment;
extern const std::string_view foam_vertex;
extern const std::string_view liquid_surface_fragment;
extern const std::string_view smooth_fragment;
extern const std::string_view sphere_fragment;
extern const std::string_view sphere_vertex;

// tools
extern const std::string_view glow_fragment;
extern const std::string_view metal_fragment;
extern const std::string_view tube_fragment;

// room
extern const std::string_view monitor_fragment;
extern const std::string_view room_fragment;
extern const std::string_view room_vertex;

// overlay
extern const std::string_view annotation_fragment;
extern const std::string_view annotation_vertex;
extern const std::string_view glottis_fragment;
extern const std::string_view glottis_vertex;
extern const std::string_view tone_fragment;

}  // namespace eti::render::shaders
