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
#include "server/pbd/contact.hpp"
#include "server/pbd/fluid_kernel.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// The defaults are saliva. The kernel's radius is two spacings, which gives a particle some 30 neighbours.
struct FluidSettings {
    std::size_t capacity = 3000;           ///< particles, 3 ml of saliva; memory is about 0.8 kB for each
    Vec3f lower = Vec3f::Constant(-0.1f);  ///< [m], particles that leave the box from `lower`
    Vec3f upper = Vec3f::Constant(0.1f);   ///< to `upper` are removed; its cells cost memory
    float spacing = 1e-3f;                 ///< [m], of the particles at rest; cost grows with its cube
    float rest_density = 1000.0f;          ///< [kg/m^3]
    int iterations = 5;                    ///< Jacobi passes per substep; crowds burst with an even number
    float sound_speed = 10.0f;             ///< [m/s], softens the liquid: it compresses by g depth / c^2
    float viscosity = 2e-6f;         ///< [m^2/s], kinematic; more than spacing^2 / (20 dt) counts as that
    float wall_viscosity = 1e-5f;    ///< [m^2/s], against walls at rest or moving; 0 lets it slip
    float surface_tension = 0.055f;  ///< [N/m]; stable up to density spacing^3 / (2 pi dt^2)
    float contact_angle = 0.5f;      ///< [rad], 0 wets fully, pi does not adhere
    float max_speed = 3.0f;          ///< [m/s]; walls thinner than max_speed dt can be passed
    /// [s], a particle that went no farther than `rest_way` for so long is quiet, and sleeps if all of its
    /// neighbours are: it costs next to nothing until something about it moves. 0: none ever sleeps
    float rest_time = 0.25f;
    float rest_way = 0.25f;  ///< [spacings]; what flows slower than this in rest_time comes to a stop
};

/// A gland's opening. What it emits is of the set flow in the mean; speed and direction are drawn.
struct FluidEmitter {
    Vec3f position = Vec3f::Zero();    ///< [m]
    Vec3f direction = Vec3f::UnitZ();  ///< unit
    float opening = 1e-3f;             ///< [m], radius of the disc they start from
    float flow = 0.0f;                 ///< [m^3/s]; far above 3 opening^2 speed, liquid bursts out
    float speed = 0.05f;               ///< [m/s], mean
    float speed_spread = 0.5f;         ///< 0..1, speeds are uniform within this part of the mean
    float cone = 0.3f;                 ///< [rad], directions are uniform within this angle
};

/// A suction catheter's tip: takes away what lies within `radius`, and draws what lies within `reach` as
/// a sink of its flow would, at flow / (4 pi r^2).
struct FluidSuction {
    Vec3f tip = Vec3f::Zero();  ///< [m]
    float radius = 2e-3f;       ///< [m]
    float reach = 8e-3f;        ///< [m]
    float flow = 5e-6f;         ///< [m^3/s] of liquid at full strength
    float strength = 0.0f;      ///< 0..1; at 0 it does nothing
};

/// What the fluid meets in a substep. Distances are to be true ones up to the kernel radius at least.
struct FluidSurroundings {
    const DistanceGrid* solid = nullptr;
    std::span<const MovingCapsule> capsules;
    std::span<const FluidSuction> suctions;
    bool solid_moved = true;  ///< whether `solid` may differ from what it was in the substep before
};

class FluidSolid;

/// Position-based fluid (Macklin & Mueller 2013): in each substep particles are moved until the density
/// rho_i = rho_0 V sum_j W(x_i - x_j) nowhere exceeds rest density. Departures from the paper:
/// - the constraint C_i = rho_i / rho_0 - 1 <= 0 is linearised once per substep, and the iterations work
///   on its multipliers, of which a substep takes over four fifths from the last one (a multiplier is
///   p dt^2 / rho_0);
/// - relaxation is a compliance (Macklin, Mueller & Chentanez 2016): C_i = p / (rho_0 c^2), with the
///   speed of sound c;
/// - viscosity is physical (Monaghan 2005; Weiler et al. 2018) in place of XSPH, and surface tension a
///   pairwise attraction (Akinci et al. 2013) in place of the artificial pressure;
/// - walls make up for the density they cut off (see WallTerms).
/// Particles are sorted into cells each substep: an index is not the same particle from one substep to the
/// next, id() is. Results do not depend on the number of threads. Nothing allocates after construction.
///
/// Particles at rest sleep (see FluidSettings::rest_time): others meet them where they lie, with their
/// pressure. One wakes if a neighbour goes farther than rest_way, if a wall or a tool comes or goes, if
/// gravity turns, if a substep has another length, and in reach of suction.
class Fluid {
  public:
    explicit Fluid(const FluidSettings& settings, std::uint64_t seed = 0);

    /// Empty, with counters at zero and the random numbers of `seed`; emitters stay.
    void reset(std::uint64_t seed);
    void set_emitters(std::span<const FluidEmitter> emitters);
    /// Carries an emitter along; what it owes stays.
    void place_emitter(std::size_t which, const Vec3f& position, const Vec3f& direction);
    /// Sets what every emitter gives [m^3/s]; what each owes stays.
    void set_flow(float flow);
    /// False, and counted by overflow(), if the fluid is full.
    bool add(const Vec3f& position, const Vec3f& velocity = Vec3f::Zero());

    /// One substep of `dt` [s] under `gravity` [m/s^2].
    void step(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings);

    [[nodiscard]] const FluidSettings& settings() const { return settings_; }
    [[nodiscard]] std::size_t count() const { return position_.size(); }
    [[nodiscard]] std::span<const Vec3f> positions() const { return position_; }   ///< [m]
    [[nodiscard]] std::span<const Vec3f> velocities() const { return velocity_; }  ///< [m/s]
    /// Ordinal numbers of the particles, in the order in which they were added.
    [[nodiscard]] std::span<const std::uint32_t> ids() const { return id_; }
    /// Density over rest density less 1, as predicted for the last substep before it was corrected;
    /// negative near a free surface.
    [[nodiscard]] std::span<const float> compressions() const { return compression_; }
    /// Pressure [Pa] in the last substep.
    [[nodiscard]] float pressure(std::size_t i) const;
    /// Particles that sleep.
    [[nodiscard]] std::size_t asleep() const;
    [[nodiscard]] float particle_volume() const { return volume_; }  ///< [m^3]
    [[nodiscard]] float particle_mass() const { return mass_; }      ///< [kg]

    /// Particles that found no room (raise the capacity), neighbours beyond the 64 of a particle, which are
    /// ignored (particles are pressed together: raise iterations, or emit less), particles that left the
    /// domain, and particles removed by suction; since reset.
    [[nodiscard]] std::uint64_t overflow() const { return overflow_; }
    [[nodiscard]] std::uint64_t dropped_neighbours() const { return dropped_neighbours_; }
    [[nodiscard]] std::uint64_t left_domain() const { return left_domain_; }
    [[nodiscard]] std::uint64_t aspirated() const { return aspirated_; }

    /// Whether to use AVX2: the constructor chooses what the processor has. The bits are the same without.
    void use_avx2(bool wanted) { avx2_ = wanted; }

  private:
    using Vec4f = Eigen::Vector4f;
    static constexpr std::size_t grain = 256;  ///< particles that a thread takes at least
    static constexpr std::size_t most_neighbours = 64;
    static constexpr std::size_t crowd = 32;        ///< neighbours in memory that share a list of capsules
    static constexpr std::size_t most_sorted = 64;  ///< capsules in such lists; any more are always tried
    static constexpr std::size_t most_walls = 2;    ///< the solid and the nearest capsule

    /// A wall as a plane through this substep: the particle may move by d as long as gap + normal . d >= 0.
    struct Wall {
        Vec4f normal = Vec4f::Zero();
        float gap = 0.0f;      ///< [m]
        float overlap = 0.0f;  ///< [m], how deep it was in already before this substep
        float speed = 0.0f;    ///< [m/s], the wall's own, along the normal
        bool near = false;
    };
    /// How a particle rests.
    struct Rest {
        Vec3f anchor = Vec3f::Zero();  ///< [m], where it was `quiet` ago; it stayed within rest_way of it
        float quiet = 0.0f;            ///< [s]
        float wall = 0.0f;             ///< [m], distance of the solid as it fell asleep,
        float capsule = 0.0f;          ///< [m], of the nearest capsule; no more than the kernel's radius
        std::uint8_t awake = 1;
    };
    struct Nearest {
        const MovingCapsule* capsule = nullptr;
        float gap = 0.0f;  ///< [m], the kernel's radius if there is none
        Vec3f apart = Vec3f::Zero(), motion = Vec3f::Zero();
    };
    struct Source {
        FluidEmitter emitter;
        double owed = 0.0;  ///< [m^3], not emitted yet
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
    /// Whether anybody is awake then.
    bool wake(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings);
    void settle(float dt, const FluidSurroundings& surroundings);
    /// Calls `meet` with every capsule that particle `i` can reach, and some that it cannot.
    template <class Meet>
    void for_capsules(std::size_t i, std::span<const MovingCapsule> capsules, const Meet& meet) const {
        for (std::uint64_t left = capsules_near_[i / crowd]; left != 0; left &= left - 1) {
            meet(capsules[static_cast<std::size_t>(std::countr_zero(left))]);
        }
        for (std::size_t k = most_sorted; k < capsules.size(); ++k) {
            meet(capsules[k]);
        }
    }
    // Kernels over ranges of particles, and the same for AVX2.
    void collect(std::size_t begin, std::size_t end, float dt, float scale,
                 const FluidSurroundings& surroundings);
    void add_pair_terms(std::size_t i, float dt, Candidates& candidates);
    void add_pair_terms_avx2(std::size_t i, float dt, Candidates& candidates);
    void move(std::size_t begin, std::size_t end);
    void move_avx2(std::size_t begin, std::size_t end);
    void raise_pressure(std::size_t begin, std::size_t end, float relaxation);
    void raise_pressure_avx2(std::size_t begin, std::size_t end, float relaxation);
    void finish(float dt, const FluidSurroundings& surroundings);

    FluidSettings settings_;
    FluidKernel kernel_;
    WallTable wall_table_;
    CellGrid grid_;
    Random random_;
    float volume_;                   ///< [m^3]
    float mass_;                     ///< [kg]
    float kernel_volume_;            ///< [m^3], volume_ but for the kernel's error on a lattice
    float attraction_;               ///< [m/s^2], of cohesion
    float wall_attraction_;          ///< [m^-2 s^-2], of adhesion
    float dt_ = 1e-3f;               ///< [s], of the last substep
    float since_settled_ = 0.0f;     ///< [s]
    Vec3f gravity_ = Vec3f::Zero();  ///< [m/s^2], in which what sleeps fell asleep
    std::vector<Source> sources_;

    std::vector<Vec3f> position_;
    std::vector<Vec3f> predicted_;
    std::vector<Vec3f> velocity_;
    std::vector<std::uint32_t> id_;
    std::vector<Rest> rest_;
    std::vector<float> multiplier_;  ///< [m^2], pressure times dt^2 over rest density
    std::vector<float> compression_;
    std::uint32_t next_id_ = 0;

    // Per particle in this substep; the fourth component is zero, or as said.
    std::vector<Vec4f> local_;  ///< [m], prediction from the middle of all, which keeps digits; then 1
    std::array<std::vector<float>, 3> axis_;  ///< [m], the same axis by axis, and room for whole loads
    std::vector<Vec4f> rate_;                 ///< [m/s], velocity, in whole loads
    std::vector<Vec4f> offset_;        ///< [m], way that forces other than pressure add to the prediction
    std::vector<Vec4f> displacement_;  ///< [m], from the prediction; then [m^2] its product with local_
    std::vector<Vec4f> push_;          ///< [m^3, m^2], local_ times the multiplier
    std::vector<Vec4f> own_gradient_;  ///< [1/m], of the compression by the particle's own position
    std::vector<float> diagonal_;      ///< [1/m^2], change of the compression per multiplier of its own
    std::vector<Wall> wall_;           ///< most_walls for each
    std::vector<std::uint64_t> capsules_near_;  ///< each crowd, a bit per capsule
    std::vector<std::uint32_t> awake_;          ///< particles that do not sleep, in their order
    std::vector<std::uint8_t> stirred_;         ///< whether it, or a neighbour, is not quiet
    // Per pair; room for most_neighbours for each particle.
    std::vector<float> slope_;  ///< [1/m^2], V W'(r) / r: V times the gradient is this times the offset
    std::vector<std::uint32_t> neighbour_;   ///< times four: where its numbers begin in lists of four each
    std::vector<std::uint32_t> first_pair_;  ///< of each particle,
    std::vector<std::uint32_t> neighbours_;  ///< and how many, in groups of eight
    // For sorting.
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
