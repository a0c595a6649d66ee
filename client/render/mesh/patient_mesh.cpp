// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/patient_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>

#include "client/render/mesh/coarse_mesh.hpp"
#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/passes/blade_clearance_shader.hpp"
#include "client/render/shaders/shaders.hpp"
#include "client/view/revision.hpp"

namespace eti::render {
namespace {

// Frames per vertex, in groups of four as in the vertex attributes.
constexpr std::size_t influences = decltype(SkinWeights::frame){}.size();
constexpr std::size_t groups = influences / 4;
static_assert(influences % 4 == 0, "attributes take four frames each");
static_assert(sizeof(view::LitVertex) == 24 && offsetof(view::LitVertex, normal) == 12);

using Row = Eigen::Vector4f;

// Three rows per frame: linear part and offset.
std::vector<Row> rows_of(std::span<const FrameMap> frames) {
    std::vector<Row> rows;
    rows.reserve(3 * frames.size());
    for (const FrameMap& frame : frames) {
        for (int i = 0; i < 3; ++i) {
            rows.emplace_back(frame.linear(i, 0), frame.linear(i, 1), frame.linear(i, 2), frame.offset[i]);
        }
    }
    return rows;
}

bool same_pose(const std::optional<RigidTransform>& a, const std::optional<RigidTransform>& b) {
    return a.has_value() == b.has_value() &&
           (!a || (a->translation == b->translation && a->rotation.coeffs() == b->rotation.coeffs()));
}

// [m], of chest_rise.glsl in a newborn of 3.5 kg.
constexpr float largest_rise = 2e-3f;
// An expiration of which 0.01 mm is left has ended.
constexpr float least_inflation = 0.005f;

constexpr std::array coarse_cells{1e-3f, 3e-3f};  // [m], by ShadowLod

enum class Layer : std::uint8_t { body, organs, bones };

Layer layer_of(Tissue tissue) {
    return tissue == Tissue::soft ? Layer::body : is_bone(tissue) ? Layer::bones : Layer::organs;
}

}  // namespace

PatientMesh::PatientMesh()
    : skinning_(
          "skinning", {fmt::format("GROUPS {}", groups), fmt::format("FIRST_WEIGHT {}", 2 + groups)},
          blade_clearance_source() + std::string(shaders::chest_rise) + std::string(shaders::skinning_vertex),
          {"skinned_position", "skinned_normal"}) {
    skinning_.use();
    skinning_.set("frames", 0);
    glBindRenderbuffer(GL_RENDERBUFFER, pixel_.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, pixel_.name());
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void PatientMesh::build(const view::SceneView& scene) {
    parts_.clear();
    vertex_count_ = 0;
    frames_revision_ = 0;
    std::vector<view::LitVertex> rest;
    std::vector<SkinWeights> weights;
    std::vector<Triangle> triangles;
    for (const Layer layer : {Layer::body, Layer::organs, Layer::bones}) {
        for (const auto& [name, surface] : scene.surfaces()) {
            const bus::RestSurface& model = surface.model();
            if (layer_of(model.tissue) != layer) {
                continue;
            }
            const std::size_t count = model.mesh.vertices.size();
            Part part{name,
                      model.tissue,
                      rest.size(),
                      count,
                      triangles.size(),
                      TriangleBlocks(model.mesh.triangles, model.mesh.vertices, model.skin)};
            for (const Triangle& t : part.blocks.triangles()) {
                const auto first = static_cast<std::uint32_t>(part.first_vertex);
                triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            }
            std::vector<view::LitVertex> lit(count);
            for (std::size_t v = 0; v < count; ++v) {
                lit[v].position = model.mesh.vertices[v];
            }
            view::recompute_normals(model.mesh.triangles, lit);
            rest.insert(rest.end(), lit.begin(), lit.end());
            weights.insert(weights.end(), model.skin.begin(), model.skin.end());
            parts_.push_back(std::move(part));
        }
        if (layer == Layer::organs) {
            visible_part_count_ = parts_.size();
        }
    }
    vertex_count_ = rest.size();
    build_revision_ = view::next_revision();
    film_ = 0;
    for (std::size_t level = 0; level < coarse_.size(); ++level) {
        coarse_[level].first = triangles.size();
        for (const Part& part : parts()) {
            const auto first = static_cast<std::uint32_t>(part.first_vertex);
            for (const Triangle& t : coarse_triangles(
                     part.blocks.triangles(), std::span(rest).subspan(part.first_vertex, part.vertex_count),
                     coarse_cells[level])) {
                triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            }
        }
        coarse_[level].count = triangles.size() - coarse_[level].first;
    }
    glBindVertexArray(rest_array_.name());
    upload(GL_ARRAY_BUFFER, rest_, rest, GL_STATIC_DRAW);
    for (GLuint i = 0; i < 2; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(view::LitVertex), buffer_offset(12 * i));
    }
    upload(GL_ARRAY_BUFFER, weights_, weights, GL_STATIC_DRAW);
    for (GLuint group = 0; group < groups; ++group) {
        const GLuint frame = 2 + group, weight = 2 + static_cast<GLuint>(groups) + group;
        glEnableVertexAttribArray(frame);
        glVertexAttribIPointer(frame, 4, GL_UNSIGNED_SHORT, sizeof(SkinWeights),
                               buffer_offset(offsetof(SkinWeights, frame) + 8 * group));
        glEnableVertexAttribArray(weight);
        glVertexAttribPointer(weight, 4, GL_FLOAT, GL_FALSE, sizeof(SkinWeights),
                              buffer_offset(offsetof(SkinWeights, weight) + 16 * group));
    }
    glBindVertexArray(array_.name());
    upload(GL_ARRAY_BUFFER, skinned_, rest, GL_DYNAMIC_COPY);
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, 24, 0);
    attribute(Attribute::normal, 3, GL_FLOAT, GL_FALSE, 24, 12);
    upload(GL_ARRAY_BUFFER, colours_, std::vector<VertexColour>(vertex_count_), GL_STATIC_DRAW);
    attribute(Attribute::colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, 0);
    upload(GL_ARRAY_BUFFER, relief_, std::vector<VertexRelief>(vertex_count_), GL_STATIC_DRAW);
    attribute(Attribute::relief, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, 0);
    glBindBuffer(GL_ARRAY_BUFFER, rest_.name());
    attribute(Attribute::rest, 3, GL_FLOAT, GL_FALSE, 24, 0);
    upload(GL_ELEMENT_ARRAY_BUFFER, indices_, triangles, GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void PatientMesh::set_appearance(std::size_t part, const SurfaceAppearance& look) {
    const auto replace = [&](const Buffer& buffer, const auto& values) {
        constexpr std::size_t size = sizeof(values[0]);
        glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
        glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(size * parts_[part].first_vertex),
                        static_cast<GLsizeiptr>(size * values.size()), values.data());
    };
    replace(colours_, look.colours);
    replace(relief_, look.relief);
}

void PatientMesh::set_film(const Buffer& film) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, film.name());
    attribute(Attribute::film, 1, GL_FLOAT, GL_FALSE, 4, 0);
    glBindVertexArray(0);
    film_ = film.name();
}

void PatientMesh::set_inflation(float inflation, float size) {
    inflation_ = inflation < least_inflation ? 0.0f : inflation;
    newborn_size_ = size;
}

void PatientMesh::update(const view::SceneView& scene) {
    const bool same_frames = frames_revision_ == scene.frames_revision();
    if (vertex_count_ == 0 ||
        (same_frames && same_pose(blade_, scene.laryngoscope_pose()) && inflation_ == skinned_inflation_)) {
        return;
    }
    skin(scene);
    TriangleBlocks::Slack gives_way;
    if (blade_ && scene.keys()) {
        const PosedBladeClearanceDeformer placed =
            blade_clearance_for(scene.keys()->laryngoscope(), *blade_, scene.landmarks());
        gives_way = [placed](const Vec3f& centre, float radius) { return placed.reach(centre, radius); };
    }
    if (inflation_ > 0.0f) {
        const float rise = inflation_ * newborn_size_ * largest_rise;
        gives_way = [rise, displaced = std::move(gives_way)](const Vec3f& centre, float radius) {
            return rise + (displaced ? displaced(centre, radius) : 0.0f);
        };
    }
    for (Part& part : parts_) {
        part.blocks.update(scene.frame_maps(), gives_way);
    }
    frames_revision_ = scene.frames_revision();
}

void PatientMesh::skin(const view::SceneView& scene) {
    blade_ = scene.laryngoscope_pose();
    skinned_inflation_ = inflation_;
    skinned_revision_ = view::next_revision();
    upload(GL_TEXTURE_BUFFER, frames_, rows_of(scene.frame_maps()), GL_STREAM_DRAW);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, frames_texture_.name());
    glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, frames_.name());
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    skinning_.use();
    skinning_.set("breath", Eigen::Vector2f(inflation_, newborn_size_));
    const bool held = blade_ && scene.keys();
    skinning_.set("blade_held", held ? 1 : 0);
    if (held) {
        apply(blade_clearance_for(scene.keys()->laryngoscope(), *blade_, scene.landmarks()), skinning_);
    }
    glBindVertexArray(rest_array_.name());
    capture(skinned_, vertex_count_);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

PatientMesh::DrawRanges PatientMesh::draw_ranges_of(const Part& part,
                                                    std::span<const TriangleBlocks::Range> ranges,
                                                    const OutlineTessellation* finer) {
    DrawRanges selection;
    const auto add = [&](std::size_t first, std::size_t end) {
        if (first < end) {
            selection.counts.push_back(static_cast<GLsizei>(3 * (end - first)));
            selection.offsets.push_back(buffer_offset(sizeof(Triangle) * (part.first_triangle + first)));
        }
    };
    for (const TriangleBlocks::Range& range : ranges) {
        const std::size_t end = range.first + range.count;
        std::size_t first = range.first;
        if (finer != nullptr && !finer->faces().empty()) {
            for (std::size_t t = first; t < end; ++t) {
                if (const std::int32_t which = finer->face_of(t); which >= 0) {
                    const TessellatedFace& face = finer->faces()[static_cast<std::size_t>(which)];
                    selection.finer.push_back(
                        {static_cast<std::uint32_t>(part.first_triangle + t), face.steps, face.turned});
                    add(first, t);
                    first = t + 1;
                }
            }
        }
        add(first, end);
    }
    return selection;
}

TriangleBlocks::Slack PatientMesh::displacement_bound(const CullView& look) {
    if (look.lips == nullptr) {
        return {};
    }
    return [lips = look.lips](const Vec3f& centre, float radius) {
        return lips->moves(centre, radius) ? lips->reach() : 0.0f;
    };
}

PatientMesh::DrawRanges PatientMesh::visible(std::size_t part, const CullView& look, const Light* lamp,
                                             bool reached, const OutlineTessellation* finer) const {
    TriangleBlocks::BlockFilter which;
    if (lamp != nullptr) {
        which = [lamp, reached](const Vec3f& centre, float radius, float) {
            return lamp->reaches(centre, radius) == reached;
        };
    }
    const std::vector<TriangleBlocks::Range> ranges = parts_[part].blocks.visible(
        look.view_projection, look.eye, look.plane, displacement_bound(look), which);
    return draw_ranges_of(parts_[part], ranges, finer);
}

PatientMesh::CutCandidates PatientMesh::cut_candidates(std::size_t part, const Eigen::Vector4f& plane) {
    const TriangleBlocks::CutCandidates found = parts_[part].blocks.cut_candidates(plane);
    return {draw_ranges_of(parts_[part], found.ranges), found.box, found.middle};
}

void PatientMesh::draw(const DrawRanges& selection) const {
    glBindVertexArray(array_.name());
    glMultiDrawElements(GL_TRIANGLES, selection.counts.data(), GL_UNSIGNED_INT, selection.offsets.data(),
                        static_cast<GLsizei>(selection.counts.size()));
}

void PatientMesh::draw(ShadowLod coarse) const {
    const TriangleBlocks::Range& range = coarse_[static_cast<std::size_t>(coarse)];
    glBindVertexArray(array_.name());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * range.count), GL_UNSIGNED_INT,
                   buffer_offset(sizeof(Triangle) * range.first));
}

std::vector<view::LitVertex> PatientMesh::vertices() const {
    std::vector<view::LitVertex> read(vertex_count_);
    glBindBuffer(GL_ARRAY_BUFFER, skinned_.name());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(read.size() * sizeof(view::LitVertex)),
                       read.data());
    return read;
}

}  // namespace eti::render
