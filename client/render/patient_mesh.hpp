// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/render/gl_object.hpp"
#include "client/render/material.hpp"
#include "client/render/shader_program.hpp"
#include "client/render/triangle_blocks.hpp"
#include "client/view/scene_view.hpp"
#include "common/model/give_way.hpp"
#include "common/model/lip_retraction.hpp"

namespace eti::render {

/// The patient's surfaces on the graphics card, which bends them: rest shapes, weights, colours and triangles
/// are sent once, and of each new state only its frames. What every pass and every view then draws are the
/// vertices that came out, so that a state is skinned once however often it is drawn.
class PatientMesh {
  public:
    /// By so much [m] vertices may lie elsewhere than their frames have them, and are still in view.
    static constexpr float slack = LipRetraction::most + GiveWay::most;

    PatientMesh();

    /// Takes the surfaces that can be seen: bones lie inside the body.
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
    [[nodiscard]] std::span<const Part> parts() const { return parts_; }
    [[nodiscard]] std::uint64_t frames_revision() const { return frames_revision_; }

    /// Another whenever build() was called.
    [[nodiscard]] std::uint64_t build_revision() const { return build_revision_; }
    [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
    [[nodiscard]] const Buffer& skinned() const { return skinned_; }
    /// A float a vertex, the share of a whole film of liquid that it bears, for Attribute::film; until the
    /// next build() there is none.
    void set_film(const Buffer& film);
    [[nodiscard]] bool filmed() const { return filmed_; }

    /// What of a part lies in view, nearest first.
    void draw(std::size_t part, const Eigen::Matrix4f& view_projection, const Vec3f& eye,
              const Eigen::Vector4f& plane);
    /// Everything of a part.
    void draw(std::size_t part) const;

    /// As drawn, of all parts; waits for the driver. For tests and measurements.
    [[nodiscard]] std::vector<view::LitVertex> vertices() const;

  private:
    void skin(const view::SceneView& scene);

    ShaderProgram skinning_;
    VertexArray rest_array_, array_;
    // Drawing needs a complete framebuffer, even where nothing is rasterised.
    Framebuffer framebuffer_;
    Renderbuffer pixel_;
    Buffer rest_, weights_, skinned_, colours_, relief_, indices_, frames_;
    Texture frames_texture_;
    std::vector<Part> parts_;
    std::size_t vertex_count_ = 0;
    std::uint64_t build_revision_ = 0;
    bool filmed_ = false;
    std::uint64_t frames_revision_ = 0;
    std::optional<RigidTransform> blade_;  // that tissue gave way to, as skinned last
    std::vector<GLsizei> counts_;
    std::vector<const void*> offsets_;
};

}  // namespace eti::render
