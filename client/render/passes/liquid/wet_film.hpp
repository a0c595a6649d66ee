// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/mesh/patient_mesh.hpp"
#include "client/render/passes/liquid/liquid_surface.hpp"

namespace eti::render {

/// Film that liquid leaves on surfaces: per drawn vertex, 1 under liquid, drying over tens of seconds. Kept
/// on the GPU: particles mark the cells of a cube around the liquid, and vertices sample them. It needs no
/// uploads beyond the liquid itself and costs nothing without liquid. GL state: runs before begin_passes();
/// leaves the framebuffer bound, another viewport, and scissor test, depth test and blending off.
class WetFilm {
  public:
    WetFilm();

    /// Advances to simulation time `time_ns` with the current skinned patient and uploaded liquid, and
    /// passes the film to the patient's mesh.
    void update(std::uint64_t time_ns, PatientMesh& patient, const LiquidSurface& liquid);

    /// Film of all vertices; waits for the driver. For tests.
    [[nodiscard]] std::vector<float> values() const;

  private:
    void begin(const PatientMesh& patient);
    void mark(const LiquidSurface& liquid);

    ShaderProgram mark_, dry_;
    Texture marks_;
    Framebuffer target_;
    std::array<Buffer, 2> film_;
    std::array<VertexArray, 2> arrays_;
    std::size_t now_ = 0;  // current index in film_
    std::size_t vertex_count_ = 0;
    std::uint64_t build_ = 0;                 // build revision of the patient's mesh for film_
    std::uint64_t time_ns_ = 0, wet_ns_ = 0;  // time of the last update; last time with liquid
    Vec3f low_ = Vec3f::Zero();
    float cell_ = 1e-3f;  // [m]
};

}  // namespace eti::render
