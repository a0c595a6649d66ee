// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/patient_pass.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "client/render/mucosa_pattern.hpp"
#include "client/render/passes/liquid/liquid_optics.hpp"
#include "client/render/shaders/shaders.hpp"
#include "client/render/skin/hair_pattern.hpp"
#include "client/render/skin/newborn_skin.hpp"
#include "client/render/views/lip_retraction.hpp"

namespace eti::render {
namespace {

constexpr int mucosa_unit = 2, hair_unit = 13;  // others lie between

// A lens sees no hair, and a section is seen from too far away.
bool shows_hair(const DrawContext& context) {
    return context.quality.fine && !context.view.lens && !context.view.cut;
}

PatientMesh::CullView cull_view_of(const DrawContext& context) {
    return {context.view_projection, context.camera.eye, context.clip_plane,
            context.view.lips_retracted ? &context.lips : nullptr};
}

void set_colours(ShaderProgram& program, Tissue tissue) {
    program.set("flat_colour", flat(object_colour(tissue)));
    program.set("back_colour", flat(back_colour(tissue)));
}

}  // namespace

PatientPass::PatientPass()
    : tissue_("tissue", shaders::mesh_vertex, shaders::tissue_fragment),
      lit_at_vertices_("tissue lit at vertices", shaders::tissue_lit_vertex, shaders::tissue_lit_fragment),
      flat_("flat tissue", shaders::mesh_vertex, shaders::flat_fragment) {}

void PatientPass::bind_mucosa() {
    glActiveTexture(GL_TEXTURE0 + mucosa_unit);
    if (mucosa_) {
        glBindTexture(GL_TEXTURE_2D, mucosa_->name());
        return;
    }
    const MucosaPattern pattern = mucosa_pattern();
    glBindTexture(GL_TEXTURE_2D, mucosa_.emplace().name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, pattern.side, pattern.side, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 pattern.texels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

void PatientPass::bind_hair() {
    glActiveTexture(GL_TEXTURE0 + hair_unit);
    if (hair_) {
        glBindTexture(GL_TEXTURE_2D, hair_->name());
        return;
    }
    const HairPattern pattern = hair_pattern();
    glBindTexture(GL_TEXTURE_2D, hair_.emplace().name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RG8, pattern.side, pattern.side, 0, GL_RG, GL_UNSIGNED_BYTE,
                 pattern.texels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

ShaderProgram& PatientPass::program(const DrawContext& context, const ShadowPass& shadows, bool lamplit,
                                    bool filmed, bool finer) {
    ShaderProgram::Defines defines;
    if (finer) {
        defines.emplace_back("FINER");
    }
    if (!context.ids()) {
        defines.emplace_back("TISSUE");
    }
    if (context.view.lips_retracted) {
        defines.emplace_back("RETRACT");
    }
    if (context.ids()) {
        if (context.shading == Shading::object_id_both_sides) {
            defines.emplace_back("BOTH_SIDES");
        } else if (context.shading == Shading::tissue_id) {
            defines.emplace_back("BY_TISSUE");
        }
        return flat_.variant(defines);
    }
    for (std::string& define : shadows.defines(context, lamplit)) {
        defines.push_back(std::move(define));
    }
    if (context.quality.fine) {
        defines.emplace_back("FINE");
    }
    if (shows_hair(context)) {
        defines.emplace_back("HAIR");
    }
    if (filmed) {
        defines.emplace_back("FILM");
    }
    if (context.quality.lit_at_vertices && !context.view.lens) {
        defines.emplace_back("LIT_AT_VERTICES");
        return lit_at_vertices_.variant(defines);
    }
    return tissue_.variant(defines);
}

void PatientPass::draw(const DrawContext& context, SceneMeshes& meshes, const ShadowPass& shadows) {
    circulation_ = meshes.circulation().colouring();
    if (context.view.cut) {
        glEnable(GL_CLIP_DISTANCE0);
    }
    if (context.shading == Shading::object_id_both_sides) {
        glDisable(GL_CULL_FACE);
    }
    // A section's faces meet flat triangles; tissue ids are per triangle.
    const bool fine_outlines = context.quality.fine_outlines && finer_.takes(meshes.patient());
    if (!fine_outlines || context.view.cut || context.shading == Shading::tissue_id) {
        outlines_.clear();
    } else {
        outlines_.choose(meshes.patient(), context.scene, cull_view_of(context));
    }
    deferred_.assign(meshes.patient().parts().size(), {});
    if (!context.ids() && context.lamplit()) {
        // The lamp costs a third of a pixel's time and lights few triangles: those out of its reach are
        // drawn without it. They come first, since a face occludes more of a mouth than vice versa.
        const Light& lamp = context.lighting.lights[1];
        draw_parts(context, meshes.patient(), shadows, &lamp, false);
        draw_parts(context, meshes.patient(), shadows, &lamp, true);
    } else {
        draw_parts(context, meshes.patient(), shadows, nullptr, false);
    }
    draw_finer(context, meshes.patient(), shadows);
    glEnable(GL_CULL_FACE);
    glDisable(GL_CLIP_DISTANCE0);
}

ShaderProgram& PatientPass::begin(const DrawContext& context, const PatientMesh& patient,
                                  const ShadowPass& shadows, bool lamplit, bool finer) {
    ShaderProgram& skin = program(context, shadows, lamplit, patient.has_film(), finer);
    skin.use();
    place(skin, context, Eigen::Matrix4f::Identity(), context.clip_plane);
    if (context.view.lips_retracted) {
        apply(context.lips, skin);
    }
    if (!context.ids()) {
        context.lighting.apply(skin, context.camera.eye);
        shadows.apply(context, skin);
        if (context.quality.fine) {
            bind_mucosa();
            skin.set("mucosa", mucosa_unit);
            skin.set("mucosa_scale", Eigen::Vector2f(MucosaPattern::period, MucosaPattern::steepest));
        }
        if (shows_hair(context)) {
            bind_hair();
            const NewbornSkin newborn(context.scene.rest_landmarks());
            skin.set("hairs", hair_unit);
            skin.set("hair_tile", Eigen::Vector2f(HairPattern::across_mm, HairPattern::along_mm));
            skin.set("newborn_size", newborn.size());
            skin.set("prematurity", newborn.prematurity());
        }
        skin.set("circulation", circulation_);
        skin.set("film_stain", optics_of(context.scene.liquid_kind()).stain);
    }
    if (finer) {
        finer_.apply(patient, skin);
    }
    return skin;
}

void PatientPass::draw_parts(const DrawContext& context, const PatientMesh& patient,
                             const ShadowPass& shadows, const Light* lamp, bool reached) {
    ShaderProgram& skin = begin(context, patient, shadows, reached, false);
    const PatientMesh::CullView look = cull_view_of(context);
    for (std::size_t part = 0; part < patient.parts().size(); ++part) {
        if (context.ids()) {
            set_colours(skin, patient.parts()[part].tissue);
        }
        const PatientMesh::DrawRanges selection =
            patient.visible(part, look, lamp, reached, outlines_.of(part));
        patient.draw(selection);
        deferred_[part].insert(deferred_[part].end(), selection.finer.begin(), selection.finer.end());
    }
}

void PatientPass::draw_finer(const DrawContext& context, const PatientMesh& patient,
                             const ShadowPass& shadows) {
    if (std::ranges::all_of(deferred_, &std::vector<TessellatedInstance>::empty)) {
        return;
    }
    ShaderProgram& skin = begin(context, patient, shadows, !context.ids() && context.lamplit(), true);
    if (context.ids()) {
        for (std::size_t part = 0; part < deferred_.size(); ++part) {
            set_colours(skin, patient.parts()[part].tissue);
            finer_.draw(deferred_[part], skin);
        }
        return;
    }
    std::vector<TessellatedInstance> all;
    for (const std::vector<TessellatedInstance>& of_part : deferred_) {
        all.insert(all.end(), of_part.begin(), of_part.end());
    }
    finer_.draw(all, skin);
}

}  // namespace eti::render
