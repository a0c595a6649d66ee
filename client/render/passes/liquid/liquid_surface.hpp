// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/render/passes/liquid/foam_renderer.hpp"
#include "client/render/passes/liquid/liquid_optics.hpp"
#include "client/render/views/camera.hpp"
#include "client/view/liquid/liquid_detail.hpp"
#include "client/view/liquid/liquid_ellipsoids.hpp"

namespace eti::render {

struct DrawContext;
class ShadowPass;

/// Screen-space fluid rendering of liquid particles as one wet, translucent surface (van der Laan et al.
/// 2009): depths of anisotropic ellipsoids, smoothed within each surface, then shaded with normals of the
/// smoothed depth. Paths through the ellipsoids add up to the particles' volume, and so to the depth of a
/// pool. Filaments are spheres in the same buffers; foam is drawn on top. The cost depends on the view's
/// pixels, not on the number of particles.
class LiquidSurface {
  public:
    LiquidSurface();

    /// Sets the liquid to draw. `spacing` [m] of particles at rest.
    void upload(std::span<const Vec3f> positions, float spacing, const view::LiquidDetail& detail = {},
                LiquidKind kind = LiquidKind::saliva);
    std::uint64_t revision = 0;  ///< of the last upload
    [[nodiscard]] bool empty() const { return particle_count_ == 0; }

    /// Particle spacing [m], and bounding box of all particles; empty without any.
    [[nodiscard]] float spacing() const { return radius_; }
    [[nodiscard]] const Eigen::AlignedBox3f& box() const { return box_; }
    /// Draws the particles as points with the program in use, which includes the shader `ellipsoid`.
    void draw_particles(ShaderProgram& program) const;
    /// Whether drops of it are dark enough to shade tissue.
    [[nodiscard]] bool casts_shadows() const { return !empty() && optics_.casts_shadows; }

    /// Draws over pixels of the bound framebuffer that are not in front of the liquid; call after all
    /// opaque passes. Tissue and blade cast shadows on it; ambient light enters through the mouth. GL state:
    /// begin_passes(); writes depth.
    void draw(const DrawContext& context, const ShadowPass& shadows);

  private:
    /// Intermediate buffers of the liquid.
    struct Layers {
        Layers(int width, int height);
        int width, height;
        Texture depth, smoothed, thickness;
        Renderbuffer buffer;
        Framebuffer depth_target, smoothed_target, thickness_target;
    };

    /// Draws particles and filaments as spheres into cleared buffers.
    struct Spheres {
        explicit Spheres(const char* name, const ShaderProgram::Defines& defines);
        ShaderProgram particles, filaments;
    };
    void draw_spheres(Spheres& programs, const Camera& camera, const Eigen::Matrix4f& projection,
                      const Eigen::Vector4f& clip_plane);
    void smooth(float sphere_pixels_at_one_metre, bool fine);
    void draw_quad() const;
    [[nodiscard]] float largest() const;  ///< semi-axis [m] of an ellipsoid

    Spheres spheres_, thickness_;
    ShaderProgram smooth_;
    ShaderVariants surface_;
    VertexArray array_, filament_array_, no_attributes_;
    Buffer ellipsoids_, filaments_;
    view::LiquidEllipsoids fitted_;
    FoamRenderer foam_;
    std::size_t particle_count_ = 0;
    std::vector<Vec3f> extent_;  // points that bound everything drawn
    GLsizei filament_count_ = 0;
    LiquidOptics optics_ = optics_of(LiquidKind::saliva);
    bool froths_ = true;
    float radius_ = 0.0f;  // [m], of a particle in bulk liquid: its spacing
    Eigen::AlignedBox3f box_;
    std::optional<Layers> layers_;
};

}  // namespace eti::render
