// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/liquid/liquid_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "client/render/draw_context.hpp"
#include "client/render/passes/shadow_pass.hpp"
#include "client/render/shaders/shaders.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::render {
namespace {

// From this height on the liquid's buffers have half the view's resolution per side.
constexpr int halved_from = 800;
// Filter widths of the smoothing passes, in particle spacings: the second, in fine pictures only, fills the
// steps that the first leaves.
constexpr float smoothing_widths[] = {0.45f, 0.18f};

void make_texture(const Texture& texture, GLenum format, int width, int height) {
    glBindTexture(GL_TEXTURE_2D, texture.name());
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, GL_RED, GL_FLOAT, nullptr);
    // Depths are not interpolated: between two surfaces there is none.
    set_filter(format == GL_R32F ? GL_NEAREST : GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    }
}

void attach_colour(const Framebuffer& target, const Texture& texture) {
    glBindFramebuffer(GL_FRAMEBUFFER, target.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name(), 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw std::runtime_error(
            "the OpenGL driver cannot render to a floating-point texture; it does not support OpenGL 3.3");
    }
}

/// The pixels [left, bottom, width, height] that spheres at `positions` may cover.
std::array<int, 4> pixels_of_spheres(std::span<const Vec3f> positions, float radius,
                                     const Eigen::Matrix4f& view_projection, float steepness, int width,
                                     int height) {
    Eigen::AlignedBox2f box;
    for (const Vec3f& p : positions) {
        const Eigen::Vector4f clip = view_projection * p.homogeneous();
        if (clip.w() <= radius) {
            return {0, 0, width, height};  // the sphere contains the eye
        }
        const Eigen::Vector2f reach =
            Eigen::Vector2f(static_cast<float>(height) / static_cast<float>(width), 1.0f) *
            (steepness * radius / clip.w());
        box.extend(Eigen::Vector2f(clip.head<2>() / clip.w() - reach));
        box.extend(Eigen::Vector2f(clip.head<2>() / clip.w() + reach));
    }
    const auto pixel = [](float place, int side) {
        return static_cast<int>(
            std::lround(std::clamp(0.5f + 0.5f * place, 0.0f, 1.0f) * static_cast<float>(side)));
    };
    const int left = std::max(pixel(box.min().x(), width) - 1, 0);
    const int bottom = std::max(pixel(box.min().y(), height) - 1, 0);
    return {left, bottom, std::min(pixel(box.max().x(), width) + 1, width) - left,
            std::min(pixel(box.max().y(), height) + 1, height) - bottom};
}

// Points per filament; they overlap or touch up to its maximum length.
constexpr int filament_points = 160;

struct PackedFilament {
    Vec3f from;
    float radius;
    Vec3f to;
    float bead;
};
static_assert(sizeof(PackedFilament) == 32);

// A particle's ellipsoid: 12 bytes, sent with each state. Place in the box of all, radii relative to the
// widest, vector part of the rotation.
struct PackedEllipsoid {
    std::array<std::uint16_t, 3> place;
    std::array<std::uint8_t, 3> radii;
    std::array<std::int8_t, 3> turn;
};
static_assert(sizeof(PackedEllipsoid) == 12);

PackedEllipsoid packed(const view::LiquidEllipsoid& shape, const Eigen::AlignedBox3f& box, float largest) {
    const Quatf& q = shape.rotation;
    const float sign = q.w() < 0.0f ? -1.0f : 1.0f;
    PackedEllipsoid out{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const float size = box.sizes()[axis];
        const float place = size > 0.0f ? (shape.centre[axis] - box.min()[axis]) / size : 0.0f;
        out.place[k] = static_cast<std::uint16_t>(std::lround(65535.0f * place));
        out.radii[k] = static_cast<std::uint8_t>(std::lround(255.0f * shape.radii[axis] / largest));
        out.turn[k] = static_cast<std::int8_t>(std::lround(127.0f * sign * q.vec()[axis]));
    }
    return out;
}

// Beads grow as a filament drains (Bhat et al. 2010, Nature Physics 6:625).
float bead_of(const view::LiquidFilament& filament) {
    return 1.2f * filament.radius() * std::min(filament.age / 0.5f, 1.0f);
}

void bind(GLenum unit, const Texture& texture) {
    glActiveTexture(unit);
    glBindTexture(GL_TEXTURE_2D, texture.name());
}

}  // namespace

LiquidSurface::Layers::Layers(int wide, int high) : width(wide), height(high) {
    make_texture(depth, GL_R32F, width, height);
    make_texture(smoothed, GL_R32F, width, height);
    make_texture(thickness, GL_R16F, width, height);
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    attach_colour(smoothed_target, smoothed);
    attach_colour(thickness_target, thickness);
    attach_colour(depth_target, depth);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffer.name());
}

LiquidSurface::Spheres::Spheres(const char* name, const ShaderProgram::Defines& defines)
    : particles(name, defines, shaders::sphere_vertex, shaders::sphere_fragment),
      filaments(
          name,
          [&] {
              ShaderProgram::Defines with = defines;
              with.emplace_back("STRING");
              with.push_back(fmt::format("POINTS {}", filament_points));
              return with;
          }(),
          shaders::sphere_vertex, shaders::sphere_fragment) {}

LiquidSurface::LiquidSurface()
    : spheres_("liquid's spheres", {}),
      thickness_("liquid's thickness", {"THICKNESS"}),
      smooth_("liquid's smoothing", {}, shaders::quad_vertex, shaders::smooth_fragment),
      surface_("liquid's surface", shaders::quad_vertex, shaders::liquid_surface_fragment) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, ellipsoids_.name());
    const auto part = [](GLuint location, GLenum type, std::size_t offset) {
        glEnableVertexAttribArray(location);
        glVertexAttribPointer(location, 3, type, GL_TRUE, sizeof(PackedEllipsoid), buffer_offset(offset));
    };
    part(0, GL_UNSIGNED_SHORT, offsetof(PackedEllipsoid, place));
    part(1, GL_UNSIGNED_BYTE, offsetof(PackedEllipsoid, radii));
    part(2, GL_BYTE, offsetof(PackedEllipsoid, turn));
    glBindVertexArray(filament_array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, filaments_.name());
    for (GLuint end = 0; end < 2; ++end) {
        glEnableVertexAttribArray(end);
        glVertexAttribPointer(end, 4, GL_FLOAT, GL_FALSE, sizeof(PackedFilament), buffer_offset(16 * end));
        glVertexAttribDivisor(end, 1);
    }
    glBindVertexArray(0);
}

void LiquidSurface::upload(std::span<const Vec3f> positions, float spacing, const view::LiquidDetail& detail,
                           LiquidKind kind) {
    optics_ = optics_of(kind);
    froths_ = properties_of(kind).foaming > 0.5f;
    particle_count_ = positions.size();
    extent_.clear();
    radius_ = spacing;
    filament_count_ = 0;
    box_.setEmpty();
    foam_.upload(empty() ? std::span<const view::Bubble>() : detail.foam().bubbles());
    if (empty()) {
        return;
    }
    std::vector<view::LiquidEllipsoid> plain;
    if (positions.size() > view::LiquidDetail::max_particles) {
        for (const Vec3f& p : positions) {
            plain.push_back({p, Vec3f::Constant(spacing), Quatf::Identity()});
        }
    } else {
        fitted_.fit(positions, spacing);
    }
    const std::span<const view::LiquidEllipsoid> shapes = plain.empty() ? fitted_.ellipsoids() : plain;
    for (const view::LiquidEllipsoid& shape : shapes) {
        box_.extend(shape.centre);
        extent_.push_back(shape.centre);
    }
    std::vector<PackedEllipsoid> sent;
    sent.reserve(shapes.size());
    for (const view::LiquidEllipsoid& shape : shapes) {
        sent.push_back(packed(shape, box_, largest()));
    }
    render::upload(GL_ARRAY_BUFFER, ellipsoids_, sent, GL_STREAM_DRAW);
    std::vector<PackedFilament> filaments;
    for (const view::LiquidFilament& filament : detail.filaments().filaments()) {
        filaments.push_back({filament.from.place, filament.radius(), filament.to.place, bead_of(filament)});
        extent_.push_back(filament.from.place);
        extent_.push_back(filament.to.place);
    }
    filament_count_ = static_cast<GLsizei>(filaments.size());
    if (!filaments.empty()) {
        render::upload(GL_ARRAY_BUFFER, filaments_, filaments, GL_STREAM_DRAW);
    }
}

float LiquidSurface::largest() const {
    return view::LiquidEllipsoids::widest * radius_;
}

void LiquidSurface::draw_particles(ShaderProgram& program) const {
    program.set("box_low", Vec3f(box_.min()));
    program.set("box_size", Vec3f(box_.sizes()));
    program.set("largest", largest());
    glBindVertexArray(array_.name());
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(particle_count_));
}

void LiquidSurface::draw_quad() const {
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

void LiquidSurface::draw_spheres(Spheres& programs, const Camera& camera, const Eigen::Matrix4f& projection,
                                 const Eigen::Vector4f& clip_plane) {
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const auto use = [&](ShaderProgram& program) {
        program.use();
        program.set("view", camera.view());
        program.set("projection", projection);
        program.set("clip_plane", clip_plane);
        program.set("height", static_cast<float>(layers_->height));
    };
    use(programs.particles);
    programs.particles.set("particle_volume", radius_ * radius_ * radius_);
    draw_particles(programs.particles);
    if (filament_count_ > 0) {
        use(programs.filaments);
        glBindVertexArray(filament_array_.name());
        glDrawArraysInstanced(GL_POINTS, 0, filament_points, filament_count_);
    }
}

void LiquidSurface::smooth(float sphere_pixels_at_one_metre, bool fine) {
    smooth_.use();
    smooth_.set("depth", 0);
    smooth_.set("radius", radius_);
    smooth_.set("sphere_pixels", sphere_pixels_at_one_metre);
    for (const float width : std::span(smoothing_widths).first(fine ? 2 : 1)) {
        smooth_.set("width", width);
        glBindFramebuffer(GL_FRAMEBUFFER, layers_->smoothed_target.name());
        bind(GL_TEXTURE0, layers_->depth);
        smooth_.set("pixel", Eigen::Vector2f(1.0f / static_cast<float>(layers_->width), 0.0f));
        draw_quad();
        glBindFramebuffer(GL_FRAMEBUFFER, layers_->depth_target.name());
        bind(GL_TEXTURE0, layers_->smoothed);
        smooth_.set("pixel", Eigen::Vector2f(0.0f, 1.0f / static_cast<float>(layers_->height)));
        draw_quad();
    }
}

void LiquidSurface::draw(const DrawContext& context, const ShadowPass& shadows) {
    if (empty()) {
        return;
    }
    const Camera& camera = context.camera;
    const Eigen::Vector4f& clip_plane = context.clip_plane;
    const auto [x, y, width, height] = context.viewport;
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    const int part = height >= halved_from ? 2 : 1;
    const int layer_width = std::max(width / part, 1);
    const int layer_height = std::max(height / part, 1);
    const Eigen::Matrix4f projection = camera.projection(context.viewport.aspect());
    const auto [left, bottom, across, up] = pixels_of_spheres(extent_, largest(), projection * camera.view(),
                                                              projection(1, 1), layer_width, layer_height);
    if (across <= 0 || up <= 0) {
        return;
    }
    if (!layers_ || layers_->width != layer_width || layers_->height != layer_height) {
        layers_.emplace(layer_width, layer_height);
    }
    glScissor(left, bottom, across, up);
    glDisable(GL_CULL_FACE);
    glViewport(0, 0, layer_width, layer_height);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glBindFramebuffer(GL_FRAMEBUFFER, layers_->depth_target.name());
    draw_spheres(spheres_, camera, projection, clip_plane);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glBindFramebuffer(GL_FRAMEBUFFER, layers_->thickness_target.name());
    draw_spheres(thickness_, camera, projection, clip_plane);
    glDisable(GL_BLEND);
    glDisable(GL_PROGRAM_POINT_SIZE);
    smooth(projection(1, 1) * radius_ * static_cast<float>(layer_height), context.quality.fine);

    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
    glViewport(x, y, width, height);
    glScissor(x + part * left, y + part * bottom, part * across, part * up);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_SRC1_COLOR);
    ShaderProgram::Defines defines = shadows.defines(context, context.lamplit());
    if (context.quality.fine) {
        defines.emplace_back("FINE");
    }
    if (context.quality.fine && froths_) {
        defines.emplace_back("FROTH");
    }
    ShaderProgram& surface = surface_.variant(defines);
    surface.use();
    context.lighting.apply(surface, camera.eye);
    context.lighting.apply_mouth(surface, context.scene.landmarks());
    shadows.apply(context, surface);
    surface.set("projection", projection);
    surface.set("to_world", Eigen::Matrix4f(camera.view().inverse()));
    surface.set("next_pixel", Eigen::Vector2f(1.0f / static_cast<float>(layer_width),
                                              1.0f / static_cast<float>(layer_height)));
    surface.set("sphere_pixels", projection(1, 1) * radius_ * static_cast<float>(layer_height));
    surface.set("radius", radius_);
    surface.set("extinction", optics_.extinction);
    surface.set("deepest", optics_.max_depth);
    surface.set("albedo", optics_.albedo);
    surface.set("froth", optics_.froth);
    surface.set("depth", 0);
    surface.set("thickness", 1);
    bind(GL_TEXTURE1, layers_->thickness);
    bind(GL_TEXTURE0, layers_->depth);
    draw_quad();
    glDisable(GL_BLEND);
    glScissor(x, y, width, height);
    foam_.draw(context, shadows, 0.9f * radius_, optics_.froth);
    glEnable(GL_CULL_FACE);
}

}  // namespace eti::render
