// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/contact/mesh_contact.hpp"
#include "server/pbd/implicit/coarse_level.hpp"
#include "server/pbd/implicit/hexahedra.hpp"
#include "server/pbd/implicit/relaxation.hpp"
#include "server/pbd/implicit/tetrahedra.hpp"
#include "server/pbd/implicit/yielding_bodies.hpp"

namespace eti::pbd {

/// A mesh of stable neo-Hookean tetrahedra (see neo_hookean.hpp) and hexahedra (see hexahedron_kernels.hpp),
/// advanced by implicit Euler, which XPBD's passes approach only with ever shorter substeps. A step minimises
///     1/(2 dt^2) (x - x~)^T M (x - x~) + Psi(x),   x~ = position + dt velocity
/// by one Newton step from the last position. It is solved by a fixed number of matrix-free conjugate
/// gradient iterations, preconditioned by the particles' 3x3 diagonal blocks and a coarse level (see
/// CoarseLevel). With a tetrahedron's P = sum p_v Q_v (rows of Q)
///     K P = mu V (f P Q Q^T + (H : P) H / r + s dcof[P]),  H = det Q cof D,  s = (J - 1 - r) / r,
/// r = mu / lambda. s is clamped so that every element's matrix stays positive definite: dcof's eigenvalues
/// are at most the largest stretch, whose square is bounded by (I1 + 2 sqrt(I1^2 - 3 I2)) / 3, exact at rest.
/// f compensates elements that are stiffer than the clamped matrix.
///
/// Neither changes the equilibrium, nor do too few iterations: starting from the last position, they cause
/// errors in time but not at rest, unlike an inertial initial guess under a constant load. An unsupported
/// body therefore falls slowly and bounces on contacts: the method is for supported, overdamped bodies.
/// The shear stress relaxes if wanted; see relaxation.hpp.
/// Gradients: Macklin & Müller 2021; energy: Smith, de Goes & Kim 2018.
class ImplicitMesh {
  public:
    struct Settings {
        int iterations = 8;  ///< of conjugate gradients; cost grows linearly
        /// Contact stiffness relative to the particles' own. Contact forces converge within a few steps; at
        /// three times this, a tongue of 1 mm oscillates between blade and jaw.
        float contact_stiffness_scale = 0.3f;
        /// Growth of a hexahedron's hourglass stiffness with the mean square strain of its hourglass modes.
        /// One volumetric term lets a corner in that is pushed alone. The largest value that changes the
        /// force of a blade 5 mm in a block by less than 1 % (docs/solver/hexahedra.md).
        float hourglass_hardening = 20.0f;
        /// Volume ratio below which a corner of a hexahedron resists on its own, with the material's bulk
        /// modulus.
        float crushed_corner = 0.4f;
    };
    Settings settings;

    /// Springs between two particles, without load at rest. At least one end is an element's corner; the
    /// other may be any particle, which a step holds where it is.
    struct Links {
        std::vector<std::array<std::uint32_t, 2>> ends;
        std::vector<float> stiffness;  ///< [links][N/m]
    };
    /// Elements may share particles; each kind may be missing.
    struct Description {
        Tetrahedra::Description tetrahedra;
        Hexahedra::Description hexahedra;
        Links links{};
    };

    /// A spring to a point that is fixed within a step.
    struct Spring {
        std::uint32_t particle = 0;
        Vec3f to = Vec3f::Zero();
        float stiffness = 0.0f;  ///< [N/m]
        bool attachment =
            true;  ///< to something outside the mesh that bears its force; the solver ignores it
    };
    /// All are filled by the caller; particles of springs must be free corners.
    std::vector<Spring> springs;
    std::vector<MeshContact> contacts;       ///< with obstacles
    std::vector<MeshContact> self_contacts;  ///< within the mesh
    YieldingBodies bodies;                   ///< that hold corners

    /// `inverse_mass` [particles][1/kg]; particles with 0 follow `predicted`.
    void configure(const Description& description, const Particles& particles,
                   std::span<const float> inverse_mass);
    /// As in Tetrahedra.
    void set_rest(const Particles& particles);
    /// Young's moduli [tetrahedra][Pa] and [hexahedra][Pa].
    void set_youngs_modulus(std::span<const float> tetrahedra, std::span<const float> hexahedra = {});

    /// Stiffness [links][N/m], in the order of the description.
    void set_link_stiffness(std::span<const float> stiffness);
    /// Calls body(particle, force) with the force [N] of each link on its end outside the mesh, if it has
    /// one.
    template <class Body>
    void for_outer_ends(const Particles& particles, const Body& body) const {
        for (const Link& link : links_) {
            const std::size_t outer = link.corner[0] == no_corner ? 0 : 1;
            if (link.corner[outer] == no_corner) {
                const Vec3f apart =
                    particles.position[link.particle[1 - outer]] - particles.position[link.particle[outer]];
                const float distance = std::max(apart.norm(), shortest_link);
                body(link.particle[outer],
                     Vec3f(link.stiffness * (distance - link.length) / distance * apart));
            }
        }
    }

    /// From now on the shear stress relaxes; call after configure(). Moduli are those of a sudden load.
    void relax(const Relaxation& relaxation);
    /// Forgets past deformations, at once or, while set, within a tenth of a second.
    void forget();
    void set_recovering(bool recovers) { memory_.set_recovering(recovers); }
    /// Whether the last step's stresses had yet to settle: the mesh must then not fall asleep, because it
    /// creeps too slowly to count as moving.
    [[nodiscard]] bool is_relaxing() const;
    [[nodiscard]] const RelaxationMemory& memory() const { return memory_; }

    /// Advances `particles.predicted` by a step of `dt` [s] and updates the contact forces. On entry it holds
    /// the positions before the step (for held particles: the target positions). No particle moves farther
    /// than half a cell from its predicted position, beyond which the linearisation is invalid; otherwise all
    /// displacements are scaled down. Bit-identical for any number of threads. Does not allocate once the
    /// counts are known.
    void solve(Particles& particles, float dt);
    /// solve() in two parts; springs and contacts may be filled in concurrently with the first.
    void linearise(const Particles& particles, float dt);
    void solve_linearised(Particles& particles, float dt);

    /// The particles that are corners, in the order of the corner indices below.
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return tetrahedra_.particles(); }
    /// Corner indices of the held corners, ascending.
    [[nodiscard]] std::span<const std::uint32_t> held() const { return held_; }
    /// Number of elements.
    [[nodiscard]] std::size_t size() const { return tetrahedra_.size() + hexahedra_.size(); }
    /// [1/kg]
    [[nodiscard]] float inverse_mass(std::size_t corner) const { return inverse_mass_[corner]; }
    /// [m], as last set
    [[nodiscard]] Vec3f rest(std::size_t corner) const { return rest_[corner].head<3>(); }
    /// Stiffness [N/m] of a single corner with all others fixed, at rest; mean over directions.
    [[nodiscard]] float own_stiffness(std::size_t corner) const { return own_stiffness_[corner]; }

    /// Enables AVX2; configure() sets it to what the processor supports. Results are bit-identical either
    /// way.
    void use_avx2(bool wanted) { avx2_ = wanted; }

    /// Linearisation of eight hexahedra.
    struct alignas(32) HexahedronElement {
        float metric[6][Hexahedra::lanes];        ///< mu V Q Q^T [N/m]
        float edge[3][3][Hexahedra::lanes];       ///< [m], mean edges
        float slope[6][3][Hexahedra::lanes];      ///< [m^2], gradient of the volume over det Q
        float hourglass[Hexahedra::lanes];        ///< stiffness of hourglass modes over that of shear
        float bulk[Hexahedra::lanes];             ///< lambda V det^2 Q [N/m^5]
        float gradient[Hexahedra::lanes];         ///< 4/3 kappa mu V det^2 Q [N/m^5]
        float pressure[Hexahedra::lanes];         ///< mu V s det Q, s clamped [N/m^2]
        float smallest_corner[Hexahedra::lanes];  ///< volume ratio of the corner that has lost most
    };
    /// Linearisation of eight tetrahedra.
    struct alignas(32) Element {
        float metric[6][Tetrahedra::lanes];   ///< mu V Q Q^T [N/m]
        float edge[3][3][Tetrahedra::lanes];  ///< [m], columns of D
        float bulk[Tetrahedra::lanes];        ///< lambda V det^2 Q [N/m^5]
        float pressure[Tetrahedra::lanes];    ///< mu V s det Q, s clamped [N/m^2]
    };

  private:
    using Wide = CoarseLevel::Wide;  // [corners], then padding of blocks

    /// A corner of a hexahedron whose three edges span less than a share t of the volume at rest: J < t. The
    /// energy lambda V/16 (t - J)^2 keeps cells from turning inside out, which one volumetric term does not.
    struct CrushedCorner {
        std::array<std::uint32_t, 4> corner{};  // its own index, and those at the other ends of its edges
        Eigen::Vector4f slope[4];               // [1/m], gradient of J
        float stiffness = 0.0f;                 // lambda V/8 [N m]
    };

    static constexpr std::uint32_t no_corner = ~0u;
    static constexpr float shortest_link = 1e-9f;  // [m]; has a direction

    /// A link, and its linearisation.
    struct Link {
        std::array<std::uint32_t, 2> particle{}, corner{};  // or no_corner
        std::uint32_t number = 0;                           // in the description
        float stiffness = 0.0f, length = 0.0f;              // [N/m], [m] at rest
        Eigen::Vector4f square = Eigen::Vector4f::Zero(),
                        mixed = Eigen::Vector4f::Zero();  // its matrix [N/m]: xx yy zz, yz zx xy
    };

    /// A spatially compact part of the elements that one task processes, and its contributions to its
    /// corners. The partition depends on the mesh only.
    struct Part {
        // Ranges of blocks.
        std::vector<std::array<std::uint32_t, 2>> tetrahedra, hexahedra;
        std::array<std::size_t, 2> links{};  // range of links_
        std::uint32_t first = 0, end = 0;    // corners
        // Per corner: gradient and, fourth, the isotropic part of the diagonal; the rest of its diagonal
        // block: xx yy zz, yz zx xy; and the image of a direction.
        Wide gradient, square, mixed, image;
        float curvature = 0.0f;  // along along_ [J]
        std::vector<CrushedCorner> crushed;
        bool relaxing = false;  // in the last step
    };
    struct Inverse {
        Eigen::Vector4f column[3];
    };
    /// Corners that one task processes, and their partial sums for the conjugate gradients.
    struct Range {
        std::size_t first = 0, end = 0;
        float product = 0.0f;    // residual times preconditioned residual, the blocks' part [J]
        float curvature = 0.0f;  // along along_, of masses and springs [J]
        CoarseLevel::Motion force;
    };

    void cut();
    /// Assigns the links to parts.
    void cut_links(const Links& links, const Particles& particles);
    void set_link_lengths(const Particles& particles);
    /// Linearises the links of all parts at x_, and adds their forces to the parts' gradients.
    void linearise_links(const Particles& particles);
    void measure_own_stiffness();
    /// Linearises the parts' elements at x_, and advances their `memory` by a `step`, unless it is nullptr.
    void linearise_elements(const RelaxationStep& step, RelaxationMemory* memory);
    /// Finds the crushed corners of these blocks of hexahedra and adds their forces.
    void add_crushed_corners(Part& part, std::uint32_t first, std::uint32_t end) const;
    /// Adds the first of these corners if it is crushed.
    void add_if_crushed(Part& part, const std::array<std::uint32_t, 4>& corner, float inverse_determinant,
                        float stiffness) const;
    static void apply(const CrushedCorner& crushed, const Wide& along, Wide& image);
    static void apply(const Link& link, const Wide& along, Wide& image);
    void add_springs(const Particles& particles);
    void add_contacts();
    void add_contact(MeshContact& contact);
    void conjugate_gradients();
    void invert_blocks(const Range& range);
    /// Applies the block preconditioner to the residual, and restricts the residual to the coarse level.
    void precondition(Range& range);
    /// Completes it with the coarse level and the bodies: returns residual times preconditioned residual [J].
    [[nodiscard]] float join_levels();
    /// Updates the direction; `keep` is the factor of the last one.
    void turn(float keep);
    void turn(Range& range, float keep);
    void factorise_bodies();
    /// Applies the matrix to along_ by parts, and returns the curvature along it [J].
    [[nodiscard]] float apply();
    /// Advances along the direction by `step_length`.
    void advance(const Range& range, float step_length);
    void advance_contacts(float step_length);
    /// The constrained part of along_ at a contact.
    [[nodiscard]] Vec3f held_displacement(const MeshContact& contact) const;
    /// Calls body(contact) for all contacts.
    template <class Body>
    void for_contacts(const Body& body) {
        std::ranges::for_each(contacts, body);
        std::ranges::for_each(self_contacts, body);
    }
    /// Mean displacement of a contact's corners, by their shares, relative to that of its obstacle.
    [[nodiscard]] Vec3f displacement_of(const MeshContact& contact, const Wide& corners,
                                        const YieldingBodies::Vector& of_bodies) const;
    /// Adds a contact's force to the residual, times `factor`.
    void add_force(const MeshContact& contact, const Vec3f& force, float factor);

    Tetrahedra tetrahedra_;
    Hexahedra hexahedra_;
    RelaxationMemory memory_;
    std::vector<Link> links_;  // by part
    std::vector<Part> parts_;
    std::vector<Range> ranges_;
    std::vector<Element> tetrahedron_element_;                  // [blocks of tetrahedra]
    std::vector<HexahedronElement> hexahedron_element_;         // [blocks of hexahedra]
    std::vector<std::uint32_t> corner_of_;                      // [particles]: corner index, or none
    std::vector<float> inverse_mass_, own_stiffness_;           // [corners][1/kg], [corners][N/m]
    float tetrahedron_ratio_ = 1.0f, hexahedron_ratio_ = 1.0f;  // mu / lambda
    float longest_step_ = 0.0f;                                 // [m]
    bool avx2_ = false;
    Wide rest_, x_, diagonal_, square_, mixed_, residual_, along_, moved_, step_;
    std::vector<Inverse> inverse_;  // [corners]
    CoarseLevel coarse_;
    CoarseLevel::Motion coarse_force_;
    float configured_modulus_ = 0.0f;  // [Pa], sum over elements
    std::vector<std::uint32_t> held_;  // corner indices
    Eigen::LLT<YieldingBodies::Matrix> bodies_factor_;
    YieldingBodies::Vector bodies_residual_, bodies_moved_, bodies_along_;
};

}  // namespace eti::pbd
