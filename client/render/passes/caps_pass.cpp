// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/caps_pass.hpp"

#include "client/render/shaders/shaders.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace eti::render {
namespace {

constexpr float cut_reach = 0.4f;  // [m], half of the face's extent; the stencil hides the excess

float band_width(Tissue tissue) {
    switch (tissue) {
        case Tissue::soft:
            return 1.1e-3f;
        case Tissue::tongue:
            return 0.8e-3f;
        default:
            return 0.25e-3f;
    }
}

// The pixels that contain all of a box, within the viewport; the whole viewport if the box reaches the eye.
Viewport pixels_of_box(const Eigen::AlignedBox3f& box, const Eigen::Matrix4f& view_projection,
                       const Viewport& viewport) {
    Eigen::Vector2f low(1.0f, 1.0f), high(-1.0f, -1.0f);
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector4f clip =
            view_projection * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).homogeneous();
        if (clip.w() < 1e-6f) {
            return viewport;
        }
        low = low.cwiseMin(clip.head<2>() / clip.w());
        high = high.cwiseMax(clip.head<2>() / clip.w());
    }
    const auto pixel = [](float place, int side) {
        return static_cast<int>(std::clamp(0.5f * (place + 1.0f), 0.0f, 1.0f) * static_cast<float>(side));
    };
    const int left = std::max(pixel(low.x(), viewport.width) - 1, 0);
    const int bottom = std::max(pixel(low.y(), viewport.height) - 1, 0);
    const int right = std::min(pixel(high.x(), viewport.width) + 2, viewport.width);
    const int top = std::min(pixel(high.y(), viewport.height) + 2, viewport.height);
    return {viewport.x + left, viewport.y + bottom, right - left, top - bottom};
}

}  // namespace

CapsPass::CapsPass()
    : fan_("fan of a cut", {"FAN"}, shaders::cut_surface_vertex, shaders::cut_geometry,
           shaders::flat_fragment),
      band_("band of a cut", {}, shaders::cut_surface_vertex, shaders::cut_geometry, shaders::cut_fragment),
      face_("face of a cut", {}, shaders::cut_plane_vertex, shaders::cut_fragment),
      flat_face_("flat face of a cut", {}, shaders::cut_plane_vertex, shaders::flat_fragment) {
    make_grain();
}

// Periodic smooth noise, 0-1, on a lattice of `cells` squares per side.
void CapsPass::make_grain() {
    constexpr int cells = 128, texels = 4 * cells;
    std::mt19937 random(7);
    std::vector<float> lattice(cells * cells);
    for (float& value : lattice) {
        value = static_cast<float>(random() % 4096u) / 4095.0f;
    }
    const auto at = [&](int x, int y) {
        return lattice[static_cast<std::size_t>(y % cells * cells + x % cells)];
    };
    std::vector<std::uint8_t> noise;
    noise.reserve(texels * texels);
    for (int y = 0; y < texels; ++y) {
        for (int x = 0; x < texels; ++x) {
            const auto share = [](int i) {
                const float f = (static_cast<float>(i % 4) + 0.5f) / 4.0f;
                return f * f * (3.0f - 2.0f * f);
            };
            const int i = x / 4, j = y / 4;
            const float value = std::lerp(std::lerp(at(i, j), at(i + 1, j), share(x)),
                                          std::lerp(at(i, j + 1), at(i + 1, j + 1), share(x)), share(y));
            noise.push_back(static_cast<std::uint8_t>(std::lround(255.0f * value)));
        }
    }
    glBindTexture(GL_TEXTURE_2D, grain_.name());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, texels, texels, 0, GL_RED, GL_UNSIGNED_BYTE, noise.data());
    set_filter(GL_LINEAR);
    glBindTexture(GL_TEXTURE_2D, 0);
}

void CapsPass::draw(const DrawContext& context, SceneMeshes& meshes) {
    glEnable(GL_STENCIL_TEST);
    glStencilMask(0xff);
    glDisable(GL_CULL_FACE);
    PatientMesh& patient = meshes.patient();
    // Organs are drawn over the surrounding body, bones over both.
    for (std::size_t part = 0; part < patient.parts_with_bones().size(); ++part) {
        draw_organ(context, patient, part);
    }
    glScissor(context.viewport.x, context.viewport.y, context.viewport.width, context.viewport.height);
    glDisable(GL_STENCIL_TEST);
    glEnable(GL_CULL_FACE);
}

void CapsPass::draw_organ(const DrawContext& context, PatientMesh& patient, std::size_t part) {
    const auto& [cut, box, middle] = patient.cut_candidates(part, context.clip_plane);
    if (cut.counts.empty()) {
        return;
    }
    const Viewport rim = pixels_of_box(box, context.view_projection, context.viewport);
    if (rim.width <= 0 || rim.height <= 0) {
        return;
    }
    glScissor(rim.x, rim.y, rim.width, rim.height);
    fan_.use();
    fan_.set("view_projection", context.view_projection);
    fan_.set("plane", context.clip_plane);
    // Any point of the plane works; a nearer one gives shorter triangles.
    const CutPlane& plane = context.cut;
    fan_.set("pivot", Vec3f(middle - plane.normal.dot(middle - plane.origin) * plane.normal));
    glDisable(GL_DEPTH_TEST);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glStencilFunc(GL_ALWAYS, 0, 0xff);
    // The inside counts as one from either side of the plane.
    const bool from_kept = context.clip_plane.dot(context.camera.eye.homogeneous()) > 0.0f;
    glStencilOpSeparate(from_kept ? GL_FRONT : GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    glStencilOpSeparate(from_kept ? GL_BACK : GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    patient.draw(cut);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    // Only the tools lie between the camera and the plane, and they are drawn later.
    glDepthFunc(GL_ALWAYS);
    glStencilFunc(GL_NOTEQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    const Tissue tissue = patient.parts_with_bones()[part].tissue;
    ShaderProgram& face = context.ids() ? flat_face_ : face_;
    face.use();
    face.set("view_projection", context.view_projection);
    face.set("pivot", plane.origin);
    const Vec3f across = plane.normal.unitOrthogonal();
    face.set("across", Vec3f(cut_reach * across));
    face.set("along", Vec3f(cut_reach * plane.normal.cross(across)));
    face.set("colour", cut_colour(tissue));
    face.set("flat_colour", flat(object_colour(tissue)));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, grain_.name());
    face.set("grain", 0);
    face.set("fibre", is_bone(tissue) ? 0.06f : 0.22f);
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    if (!context.ids()) {
        // Where an organ intersects itself, the doubly covered region gets no band.
        glStencilFunc(GL_EQUAL, 1, 0xff);
        band_.use();
        band_.set("view_projection", context.view_projection);
        band_.set("plane", context.clip_plane);
        band_.set("width", band_width(tissue));
        band_.set("fibre", 0.0f);
        patient.draw(cut);
    }
    glDepthFunc(GL_LESS);
    glClear(GL_STENCIL_BUFFER_BIT);
}

}  // namespace eti::render
