// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/liquid/wet_film.hpp"

#include "client/render/shaders/shaders.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace eti::render {
namespace {

constexpr int side = 64, row = 8;  // cells per side of the cube, layers per row of the atlas
static_assert(row * row == side);
// Relative to the particle spacing, a particle's own size: the surface beneath it is within one cell.
constexpr float cell_size = 1.2f;
constexpr float dries_in = 25.0f;  // [s], time constant of drying
constexpr std::uint64_t gone_ns = 150'000'000'000;
constexpr std::uint64_t period_ns = 100'000'000;  // shorter intervals are not visible

const ShaderProgram::Defines defines{fmt::format("SIDE {}", side), fmt::format("ROW {}", row)};

}  // namespace

WetFilm::WetFilm()
    : mark_("film's marks", defines, shaders::film_mark_vertex, shaders::film_mark_fragment),
      dry_("film", defines, shaders::film_vertex, {"wetted"}) {
    dry_.use();
    dry_.set("marks", 0);
    glBindTexture(GL_TEXTURE_2D, marks_.name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, row * side, row * side, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
    set_filter(GL_NEAREST);
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, marks_.name(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

/// Starts with a dry film.
void WetFilm::begin(const PatientMesh& patient) {
    build_ = patient.build_revision();
    vertex_count_ = patient.vertex_count();
    const std::vector<float> dry(vertex_count_, 0.0f);
    for (std::size_t i = 0; i < 2; ++i) {
        glBindVertexArray(arrays_[i].name());
        glBindBuffer(GL_ARRAY_BUFFER, patient.skinned().name());
        glEnableVertexAttribArray(0);
        glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(view::LitVertex), nullptr);
        upload(GL_ARRAY_BUFFER, film_[i], dry, GL_DYNAMIC_COPY);
        glEnableVertexAttribArray(1);
        glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
    }
}

void WetFilm::mark(const LiquidSurface& liquid) {
    cell_ = cell_size * liquid.spacing();
    low_ = liquid.box().center() - Vec3f::Constant(0.5f * side * cell_);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
    glViewport(0, 0, row * side, row * side);
    for (const GLenum off : {GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_BLEND}) {
        glDisable(off);
    }
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    mark_.use();
    mark_.set("low", low_);
    mark_.set("cell", cell_);
    liquid.draw_particles(mark_);
}

void WetFilm::update(std::uint64_t time_ns, PatientMesh& patient, const LiquidSurface& liquid) {
    const bool known = build_ != 0 && build_ == patient.build_revision();
    if (liquid.empty() && (!known || time_ns > wet_ns_ + gone_ns)) {
        return;  // nothing wet yet, or everything dry again
    }
    // A saved scene is from an earlier time: it shows the current film.
    if (known && time_ns < time_ns_ + period_ns) {
        return;
    }
    if (!known) {
        begin(patient);
    }
    const float seconds = known ? 1e-9f * static_cast<float>(time_ns - time_ns_) : 0.0f;
    time_ns_ = time_ns;
    wet_ns_ = liquid.empty() ? wet_ns_ : time_ns;
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    mark(liquid);
    dry_.use();
    dry_.set("low", low_);
    dry_.set("cell", cell_);
    dry_.set("reach_low", Vec3f(liquid.box().min() - Vec3f::Constant(cell_)));
    dry_.set("reach_high", Vec3f(liquid.box().max() + Vec3f::Constant(cell_)));
    dry_.set("stays", std::exp(-seconds / dries_in));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, marks_.name());
    glBindVertexArray(arrays_[now_].name());
    now_ = 1 - now_;
    capture(film_[now_], vertex_count_);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
    patient.set_film(film_[now_]);
}

std::vector<float> WetFilm::values() const {
    std::vector<float> read(vertex_count_);
    glBindBuffer(GL_ARRAY_BUFFER, film_[now_].name());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(read.size() * sizeof(float)), read.data());
    return read;
}

}  // namespace eti::render
