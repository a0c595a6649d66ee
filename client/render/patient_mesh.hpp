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

#include "client/render/finer_faces.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/lighting.hpp"
#include "client/render/material.hpp"
#include "client/render/shader_program.hpp"
#include "client/render/triangle_blocks.hpp"
#include "client/view/scene_view.hpp"
#include "common/model/give_way.hpp"
#include "common/model/lip_retraction.hpp"

namespace eti::render {

/// How coarse what throws a shadow may be.
enum class Coarse : std::uint8_t {
    close,    ///< from within a mouth: cells of 1 mm
    far_off,  ///< from across a room: cells of 3 mm
};

/// The patient's surfaces on the graphics card, which bends them: rest shapes, weights, colours and triangles
/// are sent once, and of each new state only its frames. What every pass and every view then draws are the
/// vertices that came out, so that a state is skinned once however often it is drawn.
class PatientMesh {
  public:
    PatientMesh();

    void build(const view::SceneView& scene);
    /// Of one surface, as it was built.
    void set_look(std::size_t part, const SurfaceLook& look);
    /// Skins anew where the scene's frames, or the blade that tissue gives way to, are others than before.
    void update(const view::SceneView& scene);

    struct Part {
        std::string name;
        Tissue tissue = Tissue::soft;
        std::size_t first_vertex = 0, vertex_count = 0;
        std::size_t first_triangle = 0;
        TriangleBlocks blocks;
    };
    /// The body, then the organs.
    [[nodiscard]] std::span<const Part> parts() const { return std::span(parts_).first(seen_parts_); }
    /// Then the bones, which lie inside the body: only a cut shows them.
    [[nodiscard]] std::span<const Part> parts_with_bones() const { return parts_; }
    [[nodiscard]] std::uint64_t frames_revision() const { return frames_revision_; }

    /// Another whenever build() was called.
    [[nodiscard]] std::uint64_t build_revision() const { return build_revision_; }
    /// Another whenever vertices were skinned anew.
    [[nodiscard]] std::uint64_t skinned_revision() const { return skinned_revision_; }
    [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
    /// In indices(), of coarse surfaces, too.
    [[nodiscard]] std::size_t triangle_count() const { return coarse_.back().first + coarse_.back().count; }
    /// A view::LitVertex a vertex.
    [[nodiscard]] const Buffer& skinned() const { return skinned_; }
    /// The same at rest.
    [[nodiscard]] const Buffer& rest() const { return rest_; }
    [[nodiscard]] const Buffer& indices() const { return indices_; }
    [[nodiscard]] const Buffer& colours() const { return colours_; }
    [[nodiscard]] const Buffer& relief() const { return relief_; }
    /// A float a vertex, the share of a whole film of liquid that it bears, for Attribute::film; until the
    /// next build() there is none.
    void set_film(const Buffer& film);
    [[nodiscard]] bool filmed() const { return film_ != 0; }
    [[nodiscard]] GLuint film() const { return film_; }

    /// What of a part is to be drawn.
    struct Selection {
        std::vector<GLsizei> counts;
        std::vector<const void*> offsets;
        std::vector<FinerInstance> finer;  ///< in place of triangles
    };
    /// From where one looks.
    struct Look {
        Eigen::Matrix4f view_projection;
        Vec3f eye;                            ///< [m]; what is near to it comes first
        Eigen::Vector4f plane;                ///< dot(plane.xyz, p) + plane.w >= 0 is drawn
        const LipRetraction* lips = nullptr;  ///< as they are held aside, if they are
    };
    /// What lies in view; with a lamp, only what it reaches or only what it does not. `finer`: what of the
    /// part is drawn so.
    [[nodiscard]] Selection visible(std::size_t part, const Look& look, const Light* lamp = nullptr,
                                    bool reached = true, const FinerFaces* finer = nullptr) const;
    /// By how much what is drawn in that view may lie elsewhere than it is skinned.
    [[nodiscard]] static TriangleBlocks::Slack aside(const Look& look);
    struct NearPlane {
        Selection selection;
        Eigen::AlignedBox3f box;  ///< around it [m]
        Vec3f middle;             ///< of it [m]
    };
    /// What lies near enough to a plane to be cut by it.
    [[nodiscard]] NearPlane near_plane(std::size_t part, const Eigen::Vector4f& plane);
    void draw(const Selection& selection) const;
    /// All that can be seen, coarsely.
    void draw(Coarse coarse) const;

    /// As drawn, of all parts; waits for the driver. For tests and measurements.
    [[nodiscard]] std::vector<view::LitVertex> vertices() const;

  private:
    [[nodiscard]] static Selection selection_of(const Part& part,
                                                std::span<const TriangleBlocks::Range> ranges,
                                                const FinerFaces* finer = nullptr);
    void skin(const view::SceneView& scene);

    ShaderProgram skinning_;
    VertexArray rest_array_, array_;
    // Drawing needs a complete framebuffer, even where nothing is rasterised.
    Framebuffer framebuffer_;
    Renderbuffer pixel_;
    Buffer rest_, weights_, skinned_, colours_, relief_, indices_, frames_;
    Texture frames_texture_;
    std::vector<Part> parts_;
    std::size_t seen_parts_ = 0;
    std::size_t vertex_count_ = 0;
    std::uint64_t build_revision_ = 0;
    GLuint film_ = 0;                                // its buffer's name
    std::array<TriangleBlocks::Range, 2> coarse_{};  // in the index buffer, by Coarse
    std::uint64_t frames_revision_ = 0;
    std::uint64_t skinned_revision_ = 0;
    std::optional<RigidTransform> blade_;  // that tissue gave way to, as skinned last
};

}  // namespace eti::render
