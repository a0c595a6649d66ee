// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "client/render/draw_context.hpp"
#include "client/render/image.hpp"
#include "client/render/mesh/patient_mesh.hpp"
#include "client/render/views/camera.hpp"
#include "client/view/scene_view.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/lip_retraction.hpp"
#include "tests/bench/render/raster.hpp"

namespace eti::bench {

/// A scene's shapes as plain meshes in the patient frame.
struct SurfaceMesh {
    std::string name;
    Tissue tissue = Tissue::soft;
    bool bone = false;
    std::vector<Triangle> triangles;
    std::vector<Tissue> triangle_tissue;
    std::span<const Vec3f> rest;
    std::vector<Vec3f> vertices;  ///< current positions
    /// A vertex added by tessellation.
    struct Added {
        std::array<std::uint32_t, 3> corners;
        Vec3f shares;
        float bend;  ///< [m], from the flat triangle of these corners
    };
    std::vector<Added> added;  ///< the last of the vertices
};
struct MeshSet {
    std::vector<SurfaceMesh> organs;
    std::span<const Triangle> blade_triangles;
    std::vector<Vec3f> blade;
    std::span<const Triangle> tube_triangles;
    std::vector<Vec3f> tube;
    inline static constexpr std::int16_t blade_id = 1000, tube_id = 1001;
};
[[nodiscard]] MeshSet meshes_of(const view::SceneView& scene);

/// The same with the lips retracted.
[[nodiscard]] MeshSet with_lips_retracted(MeshSet shapes, const LipRetraction& lips);

/// The same as a view draws it, with triangles about outlines tessellated. `patient` must be up to date with
/// the scene; `shapes` have the lips as in `look`.
[[nodiscard]] MeshSet with_fine_outlines(MeshSet shapes, const render::PatientMesh& patient,
                                         const view::SceneView& scene,
                                         const render::PatientMesh::CullView& look);

/// Organs, blade and tube from a camera, without bones.
[[nodiscard]] Raster raster_of(const MeshSet& shapes, const render::Camera& camera, int width, int height);

/// Share of the pixels that show a back face [%], in a picture by Shading::object_id_both_sides.
[[nodiscard]] double back_faces_percent(const render::Image& ids);

/// Share of the pixels [%] that show an organ in place of the blade: a ray from the eye to the blade's face
/// has entered that organ, and left nothing that would occlude the blade anyway.
[[nodiscard]] double blade_in_tissue_percent(const MeshSet& shapes, const render::Camera& camera, int width,
                                             int height);

/// Largest ratio of an edge's length to its rest length, for edges of 0.2 mm and more; and its location.
struct Stretch {
    double ratio = 1.0;
    std::string where;
};
[[nodiscard]] Stretch edge_stretch(const MeshSet& shapes);

/// For an organ's visible outlines, the share [%] of their length in edges shorter than `pixels`. Organs with
/// less than twice that length in sight are left out: one edge would decide.
struct Outline {
    std::string name;
    double fine_percent = 0.0;
    double length = 0.0;  ///< pixels
};
[[nodiscard]] std::vector<Outline> outlines(const MeshSet& shapes, const Raster& raster, double pixels);

/// Contours of a plane's section through a closed surface, and whether each of them is closed.
struct Contours {
    std::string name;
    int closed = 0, open = 0;
};
[[nodiscard]] std::vector<Contours> section_contours(const MeshSet& shapes, const Vec3f& origin,
                                                     const Vec3f& normal);

/// POGO in the picture [%]: share of the glottic opening's area whose pixels nothing covers that lies more
/// than `tolerance` [m] before it.
[[nodiscard]] double opening_in_picture(const Raster& raster, const render::Camera& camera,
                                        std::span<const Vec3f> contour, float tolerance);

/// Mean luminance (Rec. 709 of linear light, 0 to 1) of the visible cords, the lumen below them less the
/// pixels at its border, and the tongue, `within` that many half heights of the picture's middle; NaN for
/// fewer than 20 pixels.
struct Luminances {
    double cords = 0.0, lumen = 0.0, tongue = 0.0;
};
[[nodiscard]] Luminances luminances(const render::Image& picture, const Raster& raster, const MeshSet& shapes,
                                    const render::Camera& camera, std::span<const Vec3f> contour,
                                    float within);

/// Share of the pixels [%] of which a channel is at its maximum: their colour is lost.
[[nodiscard]] double clipped_percent(const render::Image& picture);

/// Share of the pixels [%] that differ by more than `levels` of 256 in a channel; 100 if the sizes differ.
[[nodiscard]] double differing_pixels_percent(const render::Image& a, const render::Image& b, int levels);

}  // namespace eti::bench
