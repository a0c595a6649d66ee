// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

#include "client/render/camera.hpp"
#include "client/render/foam_drawing.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/liquid_look.hpp"
#include "client/render/shader_family.hpp"
#include "client/render/shader_program.hpp"
#include "client/view/liquid_crowds.hpp"
#include "client/view/liquid_detail.hpp"

namespace eti::render {

struct Drawing;
class ShadowPass;

/// Draws liquid particles as one wet, translucent surface, in screen space (van der Laan et al. 2009): depths
/// of spheres, smoothed where they belong to one surface, then lit as a surface whose normals are those of
/// the smoothed depths. Threads are spheres of the same pictures, foam is drawn over them. The cost goes with
/// the pixels that a view has, not with the particles.
class LiquidSurface {
  public:
    LiquidSurface();

    /// What is to be drawn from now on. `spacing` [m] of particles at rest.
    void upload(std::span<const Vec3f> positions, float spacing, const view::LiquidDetail& detail = {},
                LiquidKind kind = LiquidKind::saliva);
    std::uint64_t revision = 0;  ///< of the shape last uploaded
    [[nodiscard]] bool empty() const { return particles_.empty(); }

    /// Of what is to be drawn: a particle's distance to the next [m], and the box of all; empty without any.
    [[nodiscard]] float spacing() const { return radius_ / sphere_size; }
    [[nodiscard]] const Eigen::AlignedBox3f& box() const { return box_; }
    /// The particles as points, their places in attribute 0, by the program in use.
    void draw_particles() const;

    /// Draws over those of the bound framebuffer's pixels that are not farther than the liquid; after
    /// everything opaque. Tissue and blade throw their shadows on it, and of the room's light it gets what
    /// comes in through the mouth.
    void draw(const Drawing& drawing, const ShadowPass& shadows);

  private:
    /// Pictures of the liquid alone.
    struct Layers {
        Layers(int width, int height);
        int width, height;
        Texture depth, smoothed, thickness;
        Renderbuffer buffer;
        Framebuffer depth_target, smoothed_target, thickness_target;
    };

    /// Particles and threads as spheres, into cleared pictures.
    struct Spheres {
        explicit Spheres(const char* name, const ShaderProgram::Defines& defines);
        ShaderProgram particles, strings;
    };
    void draw_spheres(Spheres& programs, const Camera& camera, const Eigen::Matrix4f& projection,
                      const Eigen::Vector4f& clip_plane);
    void smooth(float sphere_pixels_at_one_metre);
    void draw_quad() const;

    Spheres spheres_, thickness_;
    ShaderProgram smooth_;
    ShaderFamily surface_;
    VertexArray array_, string_array_, no_attributes_;
    Buffer positions_, shares_, strings_;
    view::LiquidCrowds crowds_;
    FoamDrawing foam_;
    std::vector<Vec3f> particles_, extent_;  // extent: all that may be drawn lies about these
    GLsizei string_count_ = 0;
    LiquidLook look_ = look_of(LiquidKind::saliva);
    // Of a sphere over the particles' spacing: neighbours then overlap into one surface.
    static constexpr float sphere_size = 1.0f;
    float radius_ = 0.0f;  // [m], of the spheres
    Eigen::AlignedBox3f box_;
    std::optional<Layers> layers_;
};

}  // namespace eti::render
