// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/lighting.hpp"
#include "client/render/material.hpp"
#include "client/render/mesh/outline_tessellation.hpp"
#include "client/render/mesh/triangle_blocks.hpp"
#include "client/view/scene_view.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::render {

/// Resolution of shadow casters.
enum class ShadowLod : std::uint8_t {
    fine,    ///< seen from within the mouth: cells of 1 mm
    coarse,  ///< seen from across the room: cells of 3 mm
};

/// The patient's surfaces, skinned on the GPU: rest shapes, weights, colours and triangles are uploaded
/// once; each new state uploads only its frames. All passes and views draw the skinned vertices, so that a
/// state is skinned once however often it is drawn.
class PatientMesh {
  public:
    PatientMesh();

    void build(const view::SceneView& scene);
    /// Sets the appearance of one surface, as built.
    void set_appearance(std::size_t part, const SurfaceAppearance& look);
    /// Sets the rise of chest and abdomen, 0-1, of a newborn of this size relative to 3.5 kg.
    void set_inflation(float inflation, float size);
    /// Re-skins if the scene's frames, the blade that displaces tissue, or the inflation have changed.
    void update(const view::SceneView& scene);

    struct Part {
        std::string name;
        Tissue tissue = Tissue::soft;
        std::size_t first_vertex = 0, vertex_count = 0;
        std::size_t first_triangle = 0;
        TriangleBlocks blocks;
    };
    /// The body, then the organs.
    [[nodiscard]] std::span<const Part> parts() const { return std::span(parts_).first(visible_part_count_); }
    /// The same, followed by the bones, which lie inside the body and are visible only in sections.
    [[nodiscard]] std::span<const Part> parts_with_bones() const { return parts_; }
    [[nodiscard]] std::uint64_t frames_revision() const { return frames_revision_; }

    /// Revision counter; changes with each build().
    [[nodiscard]] std::uint64_t build_revision() const { return build_revision_; }
    /// Revision counter; changes whenever the vertices are re-skinned.
    [[nodiscard]] std::uint64_t skinned_revision() const { return skinned_revision_; }
    [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
    /// Number of triangles in indices(), including coarse surfaces.
    [[nodiscard]] std::size_t triangle_count() const { return coarse_.back().first + coarse_.back().count; }
    /// One view::LitVertex per vertex.
    [[nodiscard]] const Buffer& skinned() const { return skinned_; }
    /// The same in the rest posture.
    [[nodiscard]] const Buffer& rest() const { return rest_; }
    [[nodiscard]] const Buffer& indices() const { return indices_; }
    [[nodiscard]] const Buffer& colours() const { return colours_; }
    [[nodiscard]] const Buffer& relief() const { return relief_; }
    /// Sets the liquid film: one float per vertex, the fraction of a full film, for Attribute::film; reset
    /// by build().
    void set_film(const Buffer& film);
    [[nodiscard]] bool has_film() const { return film_ != 0; }
    [[nodiscard]] GLuint film() const { return film_; }

    /// Index ranges of a part to draw.
    struct DrawRanges {
        std::vector<GLsizei> counts;
        std::vector<const void*> offsets;
        std::vector<TessellatedInstance> finer;  ///< drawn tessellated instead
    };
    /// View used for culling.
    struct CullView {
        Eigen::Matrix4f view_projection;
        Vec3f eye;                            ///< [m]; nearer blocks are drawn first
        Eigen::Vector4f plane;                ///< points with dot(plane.xyz, p) + plane.w >= 0 are drawn
        const LipRetraction* lips = nullptr;  ///< lip retraction, if any
    };
    /// The visible ranges; with a lamp, only those that it reaches or only those that it does not. `finer`:
    /// the triangles of the part that are drawn tessellated.
    [[nodiscard]] DrawRanges visible(std::size_t part, const CullView& look, const Light* lamp = nullptr,
                                     bool reached = true, const OutlineTessellation* finer = nullptr) const;
    /// Upper bound of the displacement of drawn vertices from their skinned positions in that view.
    [[nodiscard]] static TriangleBlocks::Slack displacement_bound(const CullView& look);
    struct CutCandidates {
        DrawRanges selection;
        Eigen::AlignedBox3f box;  ///< bounding box [m]
        Vec3f middle;             ///< centre of the box [m]
    };
    /// The ranges near enough to a plane to intersect it.
    [[nodiscard]] CutCandidates cut_candidates(std::size_t part, const Eigen::Vector4f& plane);
    void draw(const DrawRanges& selection) const;
    /// Draws all visible parts at reduced resolution.
    void draw(ShadowLod coarse) const;

    /// The vertices of all parts as drawn; waits for the driver. For tests and measurements.
    [[nodiscard]] std::vector<view::LitVertex> vertices() const;

  private:
    [[nodiscard]] static DrawRanges draw_ranges_of(const Part& part,
                                                   std::span<const TriangleBlocks::Range> ranges,
                                                   const OutlineTessellation* finer = nullptr);
    void skin(const view::SceneView& scene);

    ShaderProgram skinning_;
    VertexArray rest_array_, array_;
    // OpenGL requires a complete framebuffer even when nothing is rasterised.
    Framebuffer framebuffer_;
    Renderbuffer pixel_;
    Buffer rest_, weights_, skinned_, colours_, relief_, indices_, frames_;
    Texture frames_texture_;
    std::vector<Part> parts_;
    std::size_t visible_part_count_ = 0;
    std::size_t vertex_count_ = 0;
    std::uint64_t build_revision_ = 0;
    GLuint film_ = 0;                                // buffer name
    std::array<TriangleBlocks::Range, 2> coarse_{};  // in the index buffer, by ShadowLod
    std::uint64_t frames_revision_ = 0;
    std::uint64_t skinned_revision_ = 0;
    float inflation_ = 0.0f, skinned_inflation_ = 0.0f, newborn_size_ = 1.0f;
    std::optional<RigidTransform> blade_;  // blade that displaced tissue in the last skinning
};

}  // namespace eti::render
