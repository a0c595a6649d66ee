// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "client/render/gl/shader_program.hpp"
#include "client/render/quality.hpp"
#include "client/render/views/view_table.hpp"
#include "client/render/views/viewport.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::render {

enum class Shading : std::uint8_t {
    lit,
    object_id,             ///< each object in one flat colour, see object_colour(); for measuring visibility
    tissue_id,             ///< as object_id, but each triangle in its own tissue's colour
    object_id_both_sides,  ///< back faces too, in back_colour()
};

/// Stable colours of Shading::object_id, 8 bits per channel.
[[nodiscard]] std::array<std::uint8_t, 3> object_colour(Tissue tissue);
/// Colour of back faces, which should never be visible.
[[nodiscard]] std::array<std::uint8_t, 3> back_colour(Tissue tissue);
inline constexpr std::array<std::uint8_t, 3> blade_colour{0, 255, 0};
inline constexpr std::array<std::uint8_t, 3> tube_colour{0, 0, 255};

/// State shared by the passes of one camera's picture.
struct DrawContext {
    const View& view;
    const view::SceneView& scene;
    const Vantage& from;
    const Quality& quality;
    Camera camera;
    Lighting lighting;
    Eigen::Matrix4f view_projection;
    Eigen::Vector4f clip_plane;  ///< points with dot(xyz, p) + w >= 0 are drawn
    CutPlane cut;
    LipRetraction lips;
    Viewport viewport;
    Shading shading = Shading::lit;

    [[nodiscard]] bool ids() const { return shading != Shading::lit; }
    /// Whether the laryngoscope's lamp lights this view.
    [[nodiscard]] bool lamplit() const { return !lighting.lights[1].colour.isZero(); }
};

inline const Eigen::Vector4f no_clipping(0.0f, 0.0f, 0.0f, 1.0f);

[[nodiscard]] inline Eigen::Vector4f flat(const std::array<std::uint8_t, 3>& colour) {
    return Eigen::Vector4f(colour[0], colour[1], colour[2], 255.0f) / 255.0f;
}

[[nodiscard]] inline Eigen::Matrix4f matrix_of(const RigidTransform& pose) {
    return (Eigen::Translation3f(pose.translation) * pose.rotation).matrix();
}

/// Clears the viewport's area of the bound framebuffer, and sets, as far as anything changes it in between,
/// the GL state that every pass assumes and restores: this framebuffer; viewport and scissor box at the area;
/// scissor and depth test on, less, with writes; back faces culled; all colour channels written; blending,
/// stencil test, clip distances, point sizes, polygon offset, sRGB encoding off. A pass itself sets program,
/// vertex array, buffers, textures and active unit, blend and stencil functions, clear colour.
void begin_passes(const DrawContext& context);

/// Sets the uniforms of every mesh vertex shader; the program must be in use.
void place(ShaderProgram& program, const DrawContext& context, const Eigen::Matrix4f& model,
           const Eigen::Vector4f& clip_plane);

}  // namespace eti::render
