// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "client/render/gl_object.hpp"
#include "client/render/liquid_surface.hpp"
#include "client/render/patient_mesh.hpp"
#include "client/render/shader_program.hpp"

namespace eti::render {

/// The film that liquid leaves on what it wetted: of each drawn vertex how much, 1 under liquid, drying over
/// tens of seconds. The graphics card keeps it: particles mark the cells of a cube about the liquid, and
/// vertices look there. Nothing is sent for it beyond what draws the liquid, and without liquid it costs
/// nothing.
class WetFilm {
  public:
    WetFilm();

    /// As of simulation time `time_ns`, of the patient as skinned and the liquid as uploaded last. Gives the
    /// film to the patient's mesh.
    void update(std::uint64_t time_ns, PatientMesh& patient, const LiquidSurface& liquid);

    /// Of all vertices; waits for the driver. For tests.
    [[nodiscard]] std::vector<float> values() const;

  private:
    void begin(const PatientMesh& patient);
    void mark(const LiquidSurface& liquid);

    ShaderProgram mark_, dry_;
    Texture marks_;
    Framebuffer target_;
    std::array<Buffer, 2> film_;
    std::array<VertexArray, 2> arrays_;
    std::size_t now_ = 0;  // of film_
    std::size_t vertex_count_ = 0;
    std::uint64_t build_ = 0;                 // of the patient's mesh, as film_ was made
    std::uint64_t time_ns_ = 0, wet_ns_ = 0;  // as of the last update; when there was liquid
    Vec3f low_ = Vec3f::Zero();
    float cell_ = 1e-3f;  // [m]
};

}  // namespace eti::render
