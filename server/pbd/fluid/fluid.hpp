// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/random.hpp"
#include "common/mesh/distance_grid.hpp"
#include "server/pbd/cell_grid.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/pbd/fluid/fluid_kernel.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// Parameters of the fluid; defaults are for saliva. The kernel radius is two spacings, about 30 neighbours
/// per particle.
struct FluidSettings {
    std::size_t capacity = 3000;           ///< particles (3 ml of saliva); about 0.8 kB of memory each
    Vec3f lower = Vec3f::Constant(-0.1f);  ///< [m], particles outside the box from `lower`
    Vec3f upper = Vec3f::Constant(0.1f);   ///< to `upper` are removed; the box's cells take memory
    float spacing = 1e-3f;                 ///< [m], of particles at rest; cost grows with its inverse cubed
    float rest_density = 1000.0f;          ///< [kg/m^3]
    int iterations = 5;                    ///< Jacobi passes per substep; compressed liquid bursts with an
                                           ///< even number
    float sound_speed = 10.0f;             ///< [m/s], sets the compressibility: compression is g depth / c^2
    float viscosity = 2e-6f;               ///< [m^2/s], kinematic; limited to spacing^2 / (20 dt)
    float wall_viscosity = 1e-5f;          ///< [m^2/s], at resting or moving walls; 0: free slip
    float surface_tension = 0.055f;        ///< [N/m]; stable up to density spacing^3 / (2 pi dt^2)
    float contact_angle = 0.5f;            ///< [rad]; 0: full wetting, pi: no adhesion
    float max_speed = 3.0f;                ///< [m/s]; walls thinner than max_speed dt can be penetrated
    /// [s]. A particle that stays within `rest_distance` for this long is quiet, and sleeps if all its
    /// neighbours are quiet. Sleeping particles cost almost nothing. 0 disables sleeping.
    float rest_time = 0.25f;
    float rest_distance = 0.25f;  ///< [spacings]; flow slower than this per rest_time comes to a stop
};

/// A gland's orifice. The mean flow is `flow`; speed and direction are random.
struct FluidEmitter {
    Vec3f position = Vec3f::Zero();    ///< [m]
    Vec3f direction = Vec3f::UnitZ();  ///< unit
    float opening = 1e-3f;             ///< [m], radius of the emitting disc
    float flow = 0.0f;                 ///< [m^3/s]; far above 3 opening^2 speed, liquid bursts out
    float speed = 0.05f;               ///< [m/s], mean
    float speed_spread = 0.5f;         ///< 0..1, speeds are uniform within this fraction of the mean
    float cone = 0.3f;                 ///< [rad], directions are uniform within this angle
};

/// A suction catheter's tip: removes liquid within `radius`, and attracts liquid within `reach` like a sink,
/// at speed flow / (4 pi r^2).
struct FluidSuction {
    Vec3f tip = Vec3f::Zero();  ///< [m]
    float radius = 2e-3f;       ///< [m]
    float reach = 8e-3f;        ///< [m]
    float flow = 5e-6f;         ///< [m^3/s], of liquid at full strength
    float strength = 0.0f;      ///< 0..1; 0: off
};

/// Surroundings of the fluid in a substep. Distances must be exact at least up to the kernel radius.
struct FluidSurroundings {
    const DistanceGrid* solid = nullptr;
    std::span<const MovingCapsule> capsules;
    std::span<const FluidSuction> suctions;
    bool solid_moved = true;  ///< whether `solid` may have changed since the last substep
};

class FluidSolid;

/// Position-based fluid (Macklin & Mueller 2013): each substep moves particles until the density rho_i =
/// rho_0 V sum_j W(x_i - x_j) exceeds rest density nowhere. Differences from the paper:
/// - The constraint C_i = rho_i / rho_0 - 1 <= 0 is linearised once per substep, and iterations update its
///   multipliers (p dt^2 / rho_0). A substep starts from four fifths of the last one's multipliers.
/// - Relaxation is a compliance (Macklin, Mueller & Chentanez 2016): C_i = p / (rho_0 c^2), with the speed of
///   sound c.
/// - Viscosity is physical (Monaghan 2005; Weiler et al. 2018) instead of XSPH; surface tension is a pairwise
///   attraction (Akinci et al. 2013) instead of the artificial pressure.
/// - Walls contribute the density that they cut off (see WallTerms).
///
/// Particles are sorted into cells each substep: indices change between substeps, ids() do not. Results do
/// not depend on the number of threads. No allocation after construction.
///
/// Particles at rest sleep (see FluidSettings::rest_time); they remain obstacles with their pressure. A
/// particle wakes when a neighbour moves farther than rest_distance, a wall or tool approaches or leaves,
/// gravity or the substep's length changes, or suction is in reach.
class Fluid {
  public:
    explicit Fluid(const FluidSettings& settings, std::uint64_t seed = 0);

    /// Removes all particles, resets counters to zero and seeds the random numbers; emitters remain.
    void reset(std::uint64_t seed);
    void set_emitters(std::span<const FluidEmitter> emitters);
    /// Moves an emitter; its pending volume is kept.
    void place_emitter(std::size_t which, const Vec3f& position, const Vec3f& direction);
    /// Sets the flow [m^3/s] of every emitter; pending volumes are kept.
    void set_flow(float flow);
    /// Adds a particle. Returns false, and counts in overflow(), if the fluid is full.
    bool add(const Vec3f& position, const Vec3f& velocity = Vec3f::Zero());

    /// One substep of `dt` [s] under `gravity` [m/s^2].
    void step(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings);

    [[nodiscard]] const FluidSettings& settings() const { return settings_; }
    [[nodiscard]] std::size_t count() const { return position_.size(); }
    [[nodiscard]] std::span<const Vec3f> positions() const { return position_; }   ///< [m]
    [[nodiscard]] std::span<const Vec3f> velocities() const { return velocity_; }  ///< [m/s]
    /// Persistent particle ids, in order of creation.
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return id_; }
    /// Predicted density over rest density less 1 in the last substep, before correction; negative near a
    /// free surface.
    [[nodiscard]] std::span<const float> compressions() const { return compression_; }
    /// Pressure [Pa] in the last substep.
    [[nodiscard]] float pressure(std::size_t i) const;
    /// Number of sleeping particles.
    [[nodiscard]] std::size_t sleeping_count() const;
    [[nodiscard]] float particle_volume() const { return volume_; }  ///< [m^3]
    [[nodiscard]] float particle_mass() const { return mass_; }      ///< [kg]

    /// Counters since reset: particles not created for lack of capacity (raise it); neighbours ignored beyond
    /// 64 per particle (particles are compressed: raise iterations, or emit less); particles that left the
    /// domain; particles removed by suction.
    [[nodiscard]] std::uint64_t overflow() const { return overflow_; }
    [[nodiscard]] std::uint64_t dropped_neighbours() const { return dropped_neighbours_; }
    [[nodiscard]] std::uint64_t left_domain() const { return left_domain_; }
    [[nodiscard]] std::uint64_t aspirated() const { return aspirated_; }

    /// Enables AVX2; the constructor's default is what the processor supports. Results are bit-identical
    /// either way.
    void use_avx2(bool wanted) { avx2_ = wanted; }

  private:
    using Vec4f = Eigen::Vector4f;
    static constexpr std::size_t grain = 256;  ///< minimum number of particles per task
    static constexpr std::size_t max_neighbours = 64;
    static constexpr std::size_t capsule_group = 32;  ///< consecutive particles that share a list of capsules
    static constexpr std::size_t max_sorted = 64;     ///< capsules in such lists; any beyond are always
                                                      ///< tested
    static constexpr std::size_t max_walls = 2;       ///< the solid and the nearest capsule

    /// A wall, linearised to a plane for this substep: a displacement d is admissible if gap + normal . d >=
    /// 0.
    struct Wall {
        Vec4f normal = Vec4f::Zero();
        float gap = 0.0f;      ///< [m]
        float overlap = 0.0f;  ///< [m], penetration before this substep
        float speed = 0.0f;    ///< [m/s], of the wall, along the normal
        bool near = false;
    };
    /// Rest state of a particle.
    struct Rest {
        Vec3f anchor =
            Vec3f::Zero();     ///< [m], its position `quiet` ago; it has stayed within rest_distance of it
        float quiet = 0.0f;    ///< [s]
        float wall = 0.0f;     ///< [m], distance of the solid when it fell asleep
        float capsule = 0.0f;  ///< [m], of the nearest capsule then; at most the kernel radius
        std::uint8_t awake = 1;
    };
    struct Nearest {
        const MovingCapsule* capsule = nullptr;
        float gap = 0.0f;  ///< [m]; the kernel radius if there is none
        Vec3f apart = Vec3f::Zero(), motion = Vec3f::Zero();
    };
    struct Source {
        FluidEmitter emitter;
        double owed = 0.0;  ///< [m^3], pending volume
    };
    struct Candidates;

    void resize(std::size_t count);
    void emit(float dt);
    void predict(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings);
    void remove(const FluidSurroundings& surroundings);
    void sort();
    void collect(float dt, float scale, const FluidSurroundings& surroundings);
    void gather(std::uint32_t cell, Candidates& candidates);
    void find_walls(std::size_t i, float dt, const FluidSolid* solid,
                    std::span<const MovingCapsule> capsules);
    [[nodiscard]] Nearest nearest_capsule(std::size_t i, const Vec3f& point,
                                          std::span<const MovingCapsule> capsules) const;
    void find_capsules(std::span<const Vec3f> points, float dt, std::span<const MovingCapsule> capsules);
    /// Updates who sleeps. Returns whether any particle is awake.
    bool wake(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings);
    void settle(float dt, const FluidSurroundings& surroundings);
    /// Calls `meet` with every capsule that particle `i` can reach, and possibly others.
    template <class Meet>
    void for_capsules(std::size_t i, std::span<const MovingCapsule> capsules, const Meet& meet) const {
        for (std::uint64_t left = capsules_near_[i / capsule_group]; left != 0; left &= left - 1) {
            meet(capsules[static_cast<std::size_t>(std::countr_zero(left))]);
        }
        for (std::size_t k = max_sorted; k < capsules.size(); ++k) {
            meet(capsules[k]);
        }
    }
    // Kernels over ranges of particles; scalar and AVX2 versions.
    void collect(std::size_t begin, std::size_t end, float dt, float scale,
                 const FluidSurroundings& surroundings);
    void add_pair_terms(std::size_t i, float dt, Candidates& candidates);
    void add_pair_terms_avx2(std::size_t i, float dt, Candidates& candidates);
    void move(std::size_t begin, std::size_t end);
    void move_avx2(std::size_t begin, std::size_t end);
    void update_pressure(std::size_t begin, std::size_t end, float relaxation);
    void update_pressure_avx2(std::size_t begin, std::size_t end, float relaxation);
    void finish(float dt, const FluidSurroundings& surroundings);

    FluidSettings settings_;
    FluidKernel kernel_;
    WallTable wall_table_;
    CellGrid grid_;
    Random random_;
    float volume_;                   ///< [m^3]
    float mass_;                     ///< [kg]
    float kernel_volume_;            ///< [m^3], volume_ corrected for the kernel's error on a lattice
    float attraction_;               ///< [m/s^2], cohesion
    float wall_attraction_;          ///< [m^-2 s^-2], adhesion
    float dt_ = 1e-3f;               ///< [s], of the last substep
    float since_settled_ = 0.0f;     ///< [s]
    Vec3f gravity_ = Vec3f::Zero();  ///< [m/s^2], gravity when sleeping particles fell asleep
    std::vector<Source> sources_;

    // [particles], sorted by cell.
    std::vector<Vec3f> position_;   ///< [m]
    std::vector<Vec3f> predicted_;  ///< [m]
    std::vector<Vec3f> velocity_;   ///< [m/s]
    std::vector<std::uint32_t> id_;
    std::vector<Rest> rest_;
    std::vector<float> multiplier_;  ///< [m^2], pressure times dt^2 over rest density
    std::vector<float> compression_;
    std::uint32_t next_id_ = 0;

    // [particles], in this substep; the fourth component is zero unless stated.
    std::vector<Vec4f> local_;  ///< [m], prediction relative to the centre of all, for precision; then 1
    std::array<std::vector<float>, 3> axis_;  ///< [m], the same by axis, padded to whole loads
    std::vector<Vec4f> rate_;                 ///< [m/s], velocity, padded to whole loads
    std::vector<Vec4f> offset_;               ///< [m], displacement by forces other than pressure
    std::vector<Vec4f> displacement_;  ///< [m], from the prediction; then [m^2] its product with local_
    std::vector<Vec4f> push_;          ///< [m^3, m^2], multiplier times local_
    std::vector<Vec4f> own_gradient_;  ///< [1/m], gradient of the compression by the particle's own position
    std::vector<float> diagonal_;      ///< [1/m^2], derivative of the compression by its own multiplier
    std::vector<Wall> wall_;           ///< [particles][max_walls]
    std::vector<std::uint64_t> capsules_near_;  ///< [particles / capsule_group], one bit per capsule
    std::vector<std::uint32_t> awake_;          ///< awake particles, ascending
    std::vector<std::uint8_t> stirred_;         ///< whether it or a neighbour is not quiet
    // [pairs]; capacity max_neighbours per particle.
    std::vector<float> slope_;  ///< [1/m^2], V W'(r) / r: times the offset, it gives V times the gradient
    std::vector<std::uint32_t> neighbour_;   ///< times four: offset into arrays of four numbers per particle
    std::vector<std::uint32_t> first_pair_;  ///< [particles]: first pair,
    std::vector<std::uint32_t> neighbours_;  ///< [particles]: and number of pairs, padded to groups of eight
    // Scratch for sorting.
    std::vector<Vec3f> vector_scratch_;
    std::vector<float> float_scratch_;
    std::vector<std::uint32_t> id_scratch_;
    std::vector<Rest> rest_scratch_;
    bool avx2_;

    std::uint64_t overflow_ = 0;
    std::uint64_t dropped_neighbours_ = 0;
    std::uint64_t left_domain_ = 0;
    std::uint64_t aspirated_ = 0;
};

}  // namespace eti::pbd
