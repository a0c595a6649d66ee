// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/liquid_kind.hpp"
#include "common/model/tools/tools.hpp"
#include "server/parallel/background_task.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/scene/liquid_boundary.hpp"

namespace eti::scene {

/// Surroundings of the liquid during a step. Patient frame; blade and tube move from `*_from` to `*_to`.
struct SalivaSurroundings {
    const DistanceGrid& shell;
    std::uint64_t shell_revision = 0;
    const pbd::Particles& tissue;
    patient::BonePoses bones;
    const Landmarks& landmarks;
    RigidTransform blade_from, blade_to;
    std::span<const Vec3f> tube_from, tube_to;  ///< [nodes][m]
    float suction = 0.0f;                       ///< 0..1
    Vec3f gravity = patient::gravity(0.0f);     ///< [m/s^2]
    float secretion = 1.0f;                     ///< secretion rate over the normal rate
};

/// Spacing [m] of particles at rest in this patient.
[[nodiscard]] float saliva_spacing(const patient::Patient& patient);

/// Settings for saliva, or the liquid that replaces it, with particles `spacing` [m] apart and substeps of
/// `dt` [s]. Surface tension is limited to what is stable for these. The caller sets the bounding box.
[[nodiscard]] pbd::FluidSettings saliva_settings(float spacing, float dt,
                                                 LiquidKind kind = LiquidKind::saliva);

/// Secretions in mouth and throat: initially a pool behind the tongue and a film on it, then glandular
/// secretion; or blood in the same places. Liquid follows tissue and tools and exerts no force on them.
///
/// The physics thread calls all functions. Between begin_step() and end_step() the liquid is computed on
/// another thread, and only end_step() may be called.
class Saliva {
  public:
    Saliva(const patient::Patient& patient, const Laryngoscope& scope, float tube_radius, std::uint64_t seed,
           LiquidKind kind = LiquidKind::saliva);

    /// Resets the liquid to the start of a session, in the posture of `at`: empty if `dry`, else pool and
    /// film, laid out as on a level table.
    void reset(const SalivaSurroundings& at, bool dry = false);

    /// Whether a step would change anything: there is liquid, or secretion.
    [[nodiscard]] bool flows(float secretion) const { return secretion > 0.0f || fluid_.count() > 0; }

    /// Starts a step and returns; the liquid is computed in the background. The shell and the spans in
    /// `during` must stay valid until end_step(); everything else is copied.
    void begin_step(const SalivaSurroundings& during);
    /// Waits for the step to finish.
    void end_step();

    [[nodiscard]] const pbd::Fluid& fluid() const { return fluid_; }
    [[nodiscard]] const LiquidBoundary& wall() const { return wall_; }

    static constexpr int substeps = 4;  ///< per scene step

  private:
    /// The orifice of a gland, attached to one bone.
    struct Gland {
        patient::Bone bone;
        Vec3f place = Vec3f::Zero(), direction = Vec3f::UnitZ();  ///< in the rest posture
    };

    void find_glands(const SalivaSurroundings& at);
    using Place = std::array<int, 3>;  ///< on a lattice with the liquid's spacing
    enum class Order : std::uint8_t { lowest, nearest };
    void fill(const Vec3f& from, std::size_t count, Order order, std::set<Place>& seen,
              const Landmarks& landmarks);
    [[nodiscard]] bool holds_liquid(const Vec3f& point, const Landmarks& landmarks) const;
    [[nodiscard]] Vec3f nearest_free(const Vec3f& point, float radius) const;
    void place_emitters(const patient::BonePoses& bones);
    void place_capsules(const SalivaSurroundings& during);
    void run(const DistanceGrid& shell, std::uint64_t shell_revision);

    const patient::Patient& patient_;
    Laryngoscope scope_;
    float tube_radius_;  // [m]
    float size_;         // size of the patient relative to a newborn of 3.5 kg
    std::uint64_t seed_;
    pbd::Fluid fluid_;
    LiquidBoundary wall_;
    int step_ = 0;           // steps since the last reset
    pbd::Particles tissue_;  // positions and radii at the step's start; the tissue moves on meanwhile
    std::array<Gland, 4> glands_{};
    std::vector<pbd::MovingCapsule> capsules_;  // motion over the whole step
    std::vector<pbd::MovingCapsule> now_;       // motion over a substep
    std::array<pbd::FluidSuction, 1> suction_{};
    Vec3f gravity_ = Vec3f::Zero();  // [m/s^2], in this step
    parallel::BackgroundTask background_task_;
};

}  // namespace eti::scene
