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
#include "common/model/tools.hpp"
#include "server/parallel/beside.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/fluid.hpp"
#include "server/scene/liquid_wall.hpp"

namespace eti::scene {

/// What saliva meets during a step. Patient frame; blade and tube as they go from one place to the other.
struct SalivaSurroundings {
    const DistanceGrid& shell;
    std::uint64_t shell_revision = 0;
    const pbd::Particles& tissue;
    anatomy::BonePoses bones;
    const Landmarks& landmarks;
    RigidTransform blade_from, blade_to;
    std::span<const Vec3f> tube_from, tube_to;  ///< nodes [m]
    float suction = 0.0f;                       ///< 0..1
    Vec3f gravity = anatomy::gravity(0.0f);     ///< [m/s^2]
    float secretion = 1.0f;                     ///< of what the glands usually give
};

/// [m], of the particles at rest in a patient of this size.
[[nodiscard]] float saliva_spacing(const anatomy::Patient& patient);

/// Saliva, or what lies there in its place, of particles `spacing` [m] apart for substeps of `dt` [s], with
/// as much surface tension as these bear; the box that it may be in is the caller's.
[[nodiscard]] pbd::FluidSettings saliva_settings(float spacing, float dt,
                                                 LiquidKind kind = LiquidKind::saliva);

/// Secretions in mouth and throat: a pool behind the tongue and a film on it at the start, then what the
/// glands give; or blood in the same places. Liquid follows tissue and tools and does not push back.
class Saliva {
  public:
    Saliva(const anatomy::Patient& patient, const Laryngoscope& scope, float tube_radius, std::uint64_t seed,
           LiquidKind kind = LiquidKind::saliva);

    /// The liquid as at the start of a session, in the posture of `at`: none if `dry`, else the pool and the
    /// film, laid out as on a level table.
    void reset(const SalivaSurroundings& at, bool dry = false);

    /// Whether a step would change anything: there is liquid, or glands that give some.
    [[nodiscard]] bool flows(float secretion) const { return secretion > 0.0f || fluid_.count() > 0; }

    /// Starts a step; the shell and what is spanned in `during` have to last until end_step(), the rest is
    /// copied. The liquid is then computed beside whatever the caller does next.
    void begin_step(const SalivaSurroundings& during);
    /// Waits for it.
    void end_step();

    [[nodiscard]] const pbd::Fluid& fluid() const { return fluid_; }
    [[nodiscard]] const LiquidWall& wall() const { return wall_; }

    static constexpr int substeps = 4;  ///< per scene step

  private:
    /// An opening of a gland, carried by one bone.
    struct Gland {
        anatomy::Bone bone;
        Vec3f place = Vec3f::Zero(), direction = Vec3f::UnitZ();  ///< rest posture
    };

    void find_glands(const SalivaSurroundings& at);
    using Place = std::array<int, 3>;  ///< on a lattice of the liquid's spacing
    enum class Order : std::uint8_t { lowest, nearest };
    void fill(const Vec3f& from, std::size_t count, Order order, std::set<Place>& seen,
              const Landmarks& landmarks);
    [[nodiscard]] bool holds_liquid(const Vec3f& point, const Landmarks& landmarks) const;
    [[nodiscard]] Vec3f nearest_free(const Vec3f& point, float radius) const;
    void place_emitters(const anatomy::BonePoses& bones);
    void place_capsules(const SalivaSurroundings& during);
    void run(const DistanceGrid& shell, std::uint64_t shell_revision);

    const anatomy::Patient& patient_;
    Laryngoscope scope_;
    float tube_radius_;  // [m]
    float size_;         // of the patient over a newborn of 3.5 kg
    std::uint64_t seed_;
    pbd::Fluid fluid_;
    LiquidWall wall_;
    int step_ = 0;           // since the last reset
    pbd::Particles tissue_;  // positions and radii alone, as the step began: meanwhile the tissue moves on
    std::array<Gland, 4> glands_{};
    std::vector<pbd::MovingCapsule> capsules_;  // over the whole step
    std::vector<pbd::MovingCapsule> now_;       // over a substep
    std::array<pbd::FluidSuction, 1> suction_{};
    Vec3f gravity_ = Vec3f::Zero();  // [m/s^2], of this step
    parallel::Beside beside_;
};

}  // namespace eti::scene
