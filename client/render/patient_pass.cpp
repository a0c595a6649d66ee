// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/patient_pass.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "client/render/light_shaders.hpp"
#include "client/render/lip_retraction.hpp"
#include "client/render/liquid_look.hpp"
#include "client/render/mesh_shaders.hpp"
#include "client/render/tissue_shaders.hpp"

namespace eti::render {
namespace {

PatientMesh::Look look_of(const Drawing& drawing) {
    return {drawing.view_projection, drawing.camera.eye, drawing.clip_plane,
            drawing.view.lips_aside ? &drawing.lips : nullptr};
}

void set_colours(ShaderProgram& program, Tissue tissue) {
    program.set("flat_colour", flat(object_colour(tissue)));
    program.set("back_colour", flat(back_colour(tissue)));
}

}  // namespace

PatientPass::PatientPass()
    : tissue_("tissue", source::mesh_vertex,
              std::string(source::mesh_inputs) + source::lighting + std::string(source::tissue_light) +
                  std::string(source::tissue_fragment)),
      lit_at_vertices_("tissue lit at vertices",
                       std::string(source::lights) + std::string(source::tissue_light) + source::mesh_vertex +
                           std::string(source::tissue_lit_vertex),
                       std::string(source::shadows) + std::string(source::tissue_lit_fragment)),
      flat_("flat tissue", std::string(source::mesh_vertex), std::string(source::flat_fragment)) {}

ShaderProgram& PatientPass::program(const Drawing& drawing, const ShadowPass& shadows, bool lamplit,
                                    bool filmed, bool finer) {
    ShaderProgram::Defines defines;
    if (finer) {
        defines.emplace_back("FINER");
    }
    if (!drawing.ids()) {
        defines.emplace_back("TISSUE");
    }
    if (drawing.view.lips_aside) {
        defines.emplace_back("RETRACT");
    }
    if (drawing.ids()) {
        if (drawing.shading == Shading::object_id_both_sides) {
            defines.emplace_back("BOTH_SIDES");
        } else if (drawing.shading == Shading::tissue_id) {
            defines.emplace_back("BY_TISSUE");
        }
        return flat_.with(defines);
    }
    for (std::string& define : shadows.defines(drawing, lamplit)) {
        defines.push_back(std::move(define));
    }
    if (drawing.quality.fine) {
        defines.emplace_back("FINE");
    }
    if (filmed) {
        defines.emplace_back("FILM");
    }
    if (drawing.quality.lit_at_vertices && !drawing.view.lens) {
        defines.emplace_back("LIT_AT_VERTICES");
        return lit_at_vertices_.with(defines);
    }
    return tissue_.with(defines);
}

void PatientPass::draw(const Drawing& drawing, SceneMeshes& meshes, const ShadowPass& shadows) {
    if (drawing.view.cut) {
        glEnable(GL_CLIP_DISTANCE0);
    }
    if (drawing.shading == Shading::object_id_both_sides) {
        glDisable(GL_CULL_FACE);
    }
    // A cut's faces end at flat triangles; tissues are told apart by triangle.
    const bool fine_outlines = drawing.quality.fine_outlines && finer_.takes(meshes.patient());
    if (!fine_outlines || drawing.view.cut || drawing.shading == Shading::tissue_id) {
        outlines_.clear();
    } else {
        outlines_.choose(meshes.patient(), drawing.scene, look_of(drawing));
    }
    left_.assign(meshes.patient().parts().size(), {});
    if (!drawing.ids() && drawing.lamplit()) {
        // A lamp costs a third of a pixel, and lights few: those that it cannot reach are drawn without it.
        // They come first, since a face hides more of a mouth than the other way round.
        const Light& lamp = drawing.lighting.lights[1];
        draw_parts(drawing, meshes.patient(), shadows, &lamp, false);
        draw_parts(drawing, meshes.patient(), shadows, &lamp, true);
    } else {
        draw_parts(drawing, meshes.patient(), shadows, nullptr, false);
    }
    draw_finer(drawing, meshes.patient(), shadows);
    glEnable(GL_CULL_FACE);
    glDisable(GL_CLIP_DISTANCE0);
}

ShaderProgram& PatientPass::begin(const Drawing& drawing, const PatientMesh& patient,
                                  const ShadowPass& shadows, bool lamplit, bool finer) {
    ShaderProgram& skin = program(drawing, shadows, lamplit, patient.filmed(), finer);
    skin.use();
    place(skin, drawing, Eigen::Matrix4f::Identity(), drawing.clip_plane);
    if (drawing.view.lips_aside) {
        apply(drawing.lips, skin);
    }
    if (!drawing.ids()) {
        drawing.lighting.apply(skin, drawing.camera.eye);
        shadows.apply(drawing, skin);
        skin.set("film_stain", look_of(drawing.scene.liquid_kind()).stain);
    }
    if (finer) {
        finer_.apply(patient, skin);
    }
    return skin;
}

void PatientPass::draw_parts(const Drawing& drawing, const PatientMesh& patient, const ShadowPass& shadows,
                             const Light* lamp, bool reached) {
    ShaderProgram& skin = begin(drawing, patient, shadows, reached, false);
    const PatientMesh::Look look = look_of(drawing);
    for (std::size_t part = 0; part < patient.parts().size(); ++part) {
        if (drawing.ids()) {
            set_colours(skin, patient.parts()[part].tissue);
        }
        const PatientMesh::Selection selection =
            patient.visible(part, look, lamp, reached, outlines_.of(part));
        patient.draw(selection);
        left_[part].insert(left_[part].end(), selection.finer.begin(), selection.finer.end());
    }
}

void PatientPass::draw_finer(const Drawing& drawing, const PatientMesh& patient, const ShadowPass& shadows) {
    if (std::ranges::all_of(left_, &std::vector<FinerInstance>::empty)) {
        return;
    }
    ShaderProgram& skin = begin(drawing, patient, shadows, !drawing.ids() && drawing.lamplit(), true);
    if (drawing.ids()) {
        for (std::size_t part = 0; part < left_.size(); ++part) {
            set_colours(skin, patient.parts()[part].tissue);
            finer_.draw(left_[part], skin);
        }
        return;
    }
    std::vector<FinerInstance> all;
    for (const std::vector<FinerInstance>& of_part : left_) {
        all.insert(all.end(), of_part.begin(), of_part.end());
    }
    finer_.draw(all, skin);
}

}  // namespace eti::render
