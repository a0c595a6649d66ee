// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "client/render/camera.hpp"
#include "client/render/drawing.hpp"
#include "client/render/image.hpp"
#include "client/render/patient_mesh.hpp"
#include "client/view/scene_view.hpp"
#include "common/model/lip_retraction.hpp"
#include "common/model/tissue.hpp"
#include "tests/bench/render/raster.hpp"

namespace eti::bench {

/// A scene's shapes as plain meshes in the patient frame.
struct Shape {
    std::string name;
    Tissue tissue = Tissue::soft;
    bool bone = false;
    std::vector<Triangle> triangles;
    std::vector<Tissue> triangle_tissue;
    std::span<const Vec3f> rest;
    std::vector<Vec3f> vertices;  ///< now
    /// A vertex that was added to those of the surface.
    struct Added {
        std::array<std::uint32_t, 3> corners;
        Vec3f shares;
        float bend;  ///< [m], from the flat triangle of these corners
    };
    std::vector<Added> added;  ///< the last of the vertices
};
struct Shapes {
    std::vector<Shape> organs;
    std::span<const Triangle> blade_triangles;
    std::vector<Vec3f> blade;
    std::span<const Triangle> tube_triangles;
    std::vector<Vec3f> tube;
    inline static constexpr std::int16_t blade_id = 1000, tube_id = 1001;
};
[[nodiscard]] Shapes shapes_of(const view::SceneView& scene);

/// The same with the lips held aside.
[[nodiscard]] Shapes held_aside(Shapes shapes, const LipRetraction& lips);

/// The same as a view draws it, triangles about outlines as grids of smaller ones. `patient` was brought up
/// to date with the scene; `shapes` are as `look` has the lips.
[[nodiscard]] Shapes with_fine_outlines(Shapes shapes, const render::PatientMesh& patient,
                                        const view::SceneView& scene, const render::PatientMesh::Look& look);

/// Organs, blade and tube, not the bones, from a camera.
[[nodiscard]] Raster raster_of(const Shapes& shapes, const render::Camera& camera, int width, int height);

/// Share of the pixels in which one sees a surface from behind [%], of a picture by
/// Shading::object_id_both_sides.
[[nodiscard]] double back_faces_percent(const render::Image& ids);

/// Share of the pixels [%] in which one sees an organ where the blade should be: a ray from the eye to the
/// blade's face has entered that organ, and left nothing that would hide the blade anyway.
[[nodiscard]] double blade_in_tissue_percent(const Shapes& shapes, const render::Camera& camera, int width,
                                             int height);

/// Largest ratio of an edge's length to its length at rest, of edges of 0.2 mm and more; and where.
struct Stretch {
    double ratio = 1.0;
    std::string where;
};
[[nodiscard]] Stretch edge_stretch(const Shapes& shapes);

/// Of an organ's outlines in sight, the share [%] of their length in edges shorter than `pixels`. Where less
/// than twice that is in sight the organ is left out: one edge would decide.
struct Outline {
    std::string name;
    double fine_percent = 0.0;
    double length = 0.0;  ///< pixels
};
[[nodiscard]] std::vector<Outline> outlines(const Shapes& shapes, const Raster& raster, double pixels);

/// Contours in which a plane cuts a closed surface, and whether each of them is closed.
struct Contours {
    std::string name;
    int closed = 0, open = 0;
};
[[nodiscard]] std::vector<Contours> section_contours(const Shapes& shapes, const Vec3f& origin,
                                                     const Vec3f& normal);

/// POGO as the picture shows it [%]: of the glottic opening's area, the share whose pixels nothing covers
/// that lies more than `tolerance` [m] before it.
[[nodiscard]] double opening_in_picture(const Raster& raster, const render::Camera& camera,
                                        std::span<const Vec3f> contour, float tolerance);

/// Mean luminance (Rec. 709 of linear light, 0 to 1) of what is seen of cords, lumen below them, and tongue,
/// `within` so many half heights of the picture's middle; NaN where fewer than 20 pixels are seen.
struct Luminances {
    double cords = 0.0, lumen = 0.0, tongue = 0.0;
};
[[nodiscard]] Luminances luminances(const render::Image& picture, const Raster& raster, const Shapes& shapes,
                                    const render::Camera& camera, std::span<const Vec3f> contour,
                                    float within);

/// Share of the pixels [%] that differ by more than `levels` of 256 in a channel; 100 where the sizes differ.
[[nodiscard]] double pixels_apart_percent(const render::Image& a, const render::Image& b, int levels);

}  // namespace eti::bench
