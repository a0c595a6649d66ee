// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/implicit_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/parallel/loops.hpp"
#include "server/pbd/implicit/implicit_kernels.hpp"

namespace eti::pbd {

namespace {

// One per thread worth waking for a tongue of some ten thousand tetrahedra.
constexpr std::size_t part_count = 4;

float total(std::span<const float> moduli) {
    return std::accumulate(moduli.begin(), moduli.end(), 0.0f);
}

/// Adds a contact's matrix of `stiffness` [N/m] to a symmetric block: xx yy zz, and yz zx xy.
void add_block(const MeshContact& c, float stiffness, Eigen::Vector4f& square, Eigen::Vector4f& mixed) {
    if (c.held == MeshContact::Held::point) {
        square.head<3>().array() += stiffness;
    } else {
        const Vec3f& n = c.normal;
        square.head<3>() += stiffness * n.cwiseProduct(n);
        mixed.head<3>() += stiffness * Vec3f(n.y() * n.z(), n.z() * n.x(), n.x() * n.y());
    }
}

float sum_of_four(const Float4& f) {
    return f[0] + f[1] + f[2];
}

}  // namespace

void ImplicitMesh::configure(const Description& description, const Particles& particles,
                             std::span<const float> inverse_mass) {
    const auto& cells = description.hexahedra.hexahedra;
    const auto& corners = description.tetrahedra.tetrahedra;
    CornerNumbering numbering(particles.size());
    numbering.add(cells, spatial_order(cells, particles.rest));
    numbering.add(corners, spatial_order(corners, particles.rest));
    tetrahedra_.configure(description.tetrahedra, particles, numbering);
    hexahedra_.configure(description.hexahedra, particles, numbering);
    tetrahedron_ratio_ = neo_hookean_ratio(description.tetrahedra.poisson_ratio);
    hexahedron_ratio_ = neo_hookean_ratio(description.hexahedra.poisson_ratio);
    avx2_ = has_avx2();

    const auto used = this->particles();
    corner_of_.assign(particles.size(), no_corner);
    inverse_mass_.clear();
    held_.clear();
    for (std::uint32_t k = 0; k < used.size(); ++k) {
        corner_of_[used[k]] = k;
        inverse_mass_.push_back(inverse_mass[used[k]]);
        if (inverse_mass_[k] == 0.0f) {
            held_.push_back(k);
        }
    }
    own_stiffness_.assign(used.size(), 0.0f);
    const std::size_t padded = used.size() + 8 * Hexahedra::lanes;
    for (Wide* wide : {&rest_, &x_, &diagonal_, &square_, &mixed_, &residual_, &along_, &moved_, &step_}) {
        wide->assign(padded, Eigen::Vector4f::Zero());
    }
    const Eigen::Vector4f none = Eigen::Vector4f::Zero();
    inverse_.assign(padded, {{none, none, none}});
    cut();
    cut_links(description.links, particles);
    for (std::size_t k = 0; k < used.size(); ++k) {
        rest_[k].head<3>() = particles.rest[used[k]];
    }
    measure_own_stiffness();
    const float ratio = hexahedra_.size() > 0 ? hexahedron_ratio_ : tetrahedron_ratio_;
    coarse_.configure(rest_, inverse_mass_, tetrahedra_, hexahedra_, 2.0f * longest_step_, 1.0f / ratio);
    coarse_force_ = coarse_.zero_motion();
    for (Range& range : ranges_) {
        range.force = coarse_.zero_motion();
    }
    configured_modulus_ =
        total(description.tetrahedra.youngs_modulus) + total(description.hexahedra.youngs_modulus);
}

void ImplicitMesh::relax(const Relaxation& relaxation) {
    memory_.configure(relaxation, tetrahedra_, hexahedra_);
}

void ImplicitMesh::forget() {
    memory_.reset(tetrahedra_, hexahedra_);
}

bool ImplicitMesh::is_relaxing() const {
    return std::ranges::any_of(parts_, &Part::relaxing);
}

void ImplicitMesh::set_rest(const Particles& particles) {
    memory_.begin_rest(tetrahedra_, hexahedra_);
    tetrahedra_.set_rest(particles);
    hexahedra_.set_rest(particles);
    memory_.end_rest(tetrahedra_, hexahedra_);
    set_link_lengths(particles);
    for (std::size_t k = 0; k < this->particles().size(); ++k) {
        rest_[k].head<3>() = particles.rest[this->particles()[k]];
    }
}

void ImplicitMesh::set_youngs_modulus(std::span<const float> tetrahedra, std::span<const float> hexahedra) {
    tetrahedra_.set_youngs_modulus(tetrahedra);
    hexahedra_.set_youngs_modulus(hexahedra);
    measure_own_stiffness();
    coarse_.set_stiffness((total(tetrahedra) + total(hexahedra)) / configured_modulus_);
}

void ImplicitMesh::measure_own_stiffness() {
    if (size() == 0) {
        return;
    }
    x_ = rest_;
    linearise_elements({}, nullptr);  // at rest nothing has relaxed
    std::ranges::fill(own_stiffness_, 0.0f);
    for (const Part& part : parts_) {
        for (std::uint32_t k = part.first; k < part.end; ++k) {
            own_stiffness_[k] += part.gradient[k][3] + part.square[k].head<3>().sum() / 3.0f;
        }
    }
}

namespace {

/// Cuts each colour's blocks into parts and calls add(part, {first, end}); returns the number of blocks.
template <class Elements, class Add>
std::size_t cut_blocks(const Elements& elements, const Add& add) {
    std::uint32_t first = 0;
    for (std::size_t colour = 0; colour < elements.colours(); ++colour) {
        const auto count = static_cast<std::uint32_t>(elements.blocks(colour).size());
        // Blocks of a colour follow a space-filling curve.
        for (std::uint32_t p = 0; p < part_count; ++p) {
            const auto from = static_cast<std::uint32_t>(p * std::size_t{count} / part_count);
            const auto to = static_cast<std::uint32_t>((p + 1) * std::size_t{count} / part_count);
            if (from < to) {
                add(p, std::array{first + from, first + to});
            }
        }
        first += count;
    }
    return first;
}

/// Calls body(corner) for each corner of these blocks that is not padding.
template <class Block, class Body>
void for_corners(const Block* blocks, const std::vector<std::array<std::uint32_t, 2>>& ranges,
                 std::uint32_t corners, const Body& body) {
    for (const auto& [from, to] : ranges) {
        for (std::uint32_t n = from; n < to; ++n) {
            for (const auto& lanes : blocks[n].corner) {
                for (const std::uint32_t offset : lanes) {
                    if (offset / 4 < corners) {
                        body(offset / 4);
                    }
                }
            }
        }
    }
}

}  // namespace

void ImplicitMesh::cut() {
    const auto corners = static_cast<std::uint32_t>(particles().size());
    parts_.assign(part_count, {});
    ranges_.assign(part_count, {});
    for (std::size_t r = 0; r < part_count; ++r) {
        ranges_[r].first = r * corners / part_count;
        ranges_[r].end = (r + 1) * corners / part_count;
    }
    tetrahedron_element_.assign(
        cut_blocks(tetrahedra_, [&](auto p, auto range) { parts_[p].tetrahedra.push_back(range); }), {});
    hexahedron_element_.assign(
        cut_blocks(hexahedra_, [&](auto p, auto range) { parts_[p].hexahedra.push_back(range); }), {});
    for (Part& part : parts_) {
        part.first = corners;
        for (Wide* wide : {&part.gradient, &part.square, &part.mixed, &part.image}) {
            wide->assign(x_.size(), Eigen::Vector4f::Zero());
        }
        const auto widen = [&](std::uint32_t corner) {
            part.first = std::min(part.first, corner);
            part.end = std::max(part.end, corner + 1);
        };
        for_corners(tetrahedra_.blocks().data(), part.tetrahedra, corners, widen);
        for_corners(hexahedra_.blocks().data(), part.hexahedra, corners, widen);
        std::size_t cells = 0;
        for (const auto& [from, to] : part.hexahedra) {
            cells += Hexahedra::lanes * (to - from);
        }
        part.crushed.reserve(cells);  // a step does not allocate: on average, a corner of each
        part.first = std::min(part.first, part.end);  // for a mesh too small for all parts
    }
    // Five or six tetrahedra fill a lattice cube.
    const double volume = tetrahedra_.volume() + hexahedra_.volume();
    const std::size_t sixths = tetrahedra_.size() + 6 * hexahedra_.size();
    longest_step_ =
        0.5f * static_cast<float>(std::cbrt(6.0 * volume / std::max(1.0, static_cast<double>(sixths))));
}

void ImplicitMesh::solve(Particles& particles, float dt) {
    linearise(particles, dt);
    solve_linearised(particles, dt);
}

void ImplicitMesh::solve_linearised(Particles& particles, float dt) {
    if (size() == 0) {
        return;
    }
    bodies_residual_ = bodies.force;
    add_springs(particles);
    add_contacts();
    conjugate_gradients();
    const auto used = this->particles();
    float farthest = 0.0f;
    for (std::size_t k = 0; k < used.size(); ++k) {
        const Vec3f inertial = dt * particles.velocity[used[k]];
        farthest = std::max(farthest,
                            inverse_mass_[k] > 0.0f ? (step_[k].head<3>() - inertial).squaredNorm() : 0.0f);
    }
    // NaN compares false and passes: it must not be hidden.
    const float share = farthest > longest_step_ * longest_step_ ? longest_step_ / std::sqrt(farthest) : 1.0f;
    for (std::size_t k = 0; k < used.size(); ++k) {
        if (inverse_mass_[k] > 0.0f || bodies.yield()) {
            particles.predicted[used[k]] += share * step_[k].head<3>();
        }
    }
    for_contacts([&](MeshContact& c) { c.update(share * displacement_of(c, step_, bodies.step)); });
    bodies.step *= share;
}

void ImplicitMesh::linearise(const Particles& particles, float dt) {
    if (size() == 0) {
        return;
    }
    const auto used = this->particles();
    const float per_mass = 1.0f / (dt * dt);
    coarse_.begin(per_mass);
    for (std::size_t k = 0; k < used.size(); ++k) {
        x_[k].head<3>() = particles.predicted[used[k]];
    }
    linearise_elements(memory_.step(dt), &memory_);
    linearise_links(particles);
    parallel::for_each(ranges_.size(), 1, [&](std::size_t r) {
        const Range& range = ranges_[r];
        for (std::size_t k = range.first; k < range.end; ++k) {
            const float w = inverse_mass_[k];
            diagonal_[k].setConstant(w > 0.0f ? per_mass / w : 0.0f);
            const std::uint32_t i = used[k];
            const Vec3f off = particles.predicted[i] - (particles.position[i] + dt * particles.velocity[i]);
            residual_[k].head<3>() = -diagonal_[k][0] * off;
            square_[k].setZero();
            mixed_[k].setZero();
            step_[k].setZero();
            along_[k].setZero();
        }
        for (const Part& part : parts_) {
            const std::size_t end = std::min<std::size_t>(part.end, range.end);
            for (std::size_t k = std::max<std::size_t>(part.first, range.first); k < end; ++k) {
                const Eigen::Vector4f& g = part.gradient[k];
                residual_[k].head<3>() -= g.head<3>();
                square_[k].head<3>() += part.square[k].head<3>();
                square_[k][3] += g[3];
                mixed_[k] += part.mixed[k];
            }
        }
    });
}

void ImplicitMesh::linearise_elements(const RelaxationStep& step, RelaxationMemory* memory) {
    const auto* const tetrahedra = tetrahedra_.blocks().data();
    const auto* const hexahedra = hexahedra_.blocks().data();
    RelaxedMetric* const of_tetrahedra = memory != nullptr ? memory->tetrahedra() : nullptr;
    RelaxedMetric* const of_hexahedra = memory != nullptr ? memory->hexahedra() : nullptr;
    parallel::for_each(parts_.size(), 1, [&](std::size_t p) {
        Part& part = parts_[p];
        for (Wide* wide : {&part.gradient, &part.square, &part.mixed}) {
            std::fill(wide->begin() + part.first, wide->begin() + part.end, Eigen::Vector4f::Zero());
        }
        part.crushed.clear();
        const ImplicitSums sums{part.gradient.front().data(), part.square.front().data(),
                                part.mixed.front().data()};
        const float* const wide = x_.front().data();
        const auto from_block = [](RelaxedMetric* all, std::uint32_t first) {
            return all != nullptr ? all + first : nullptr;
        };
        part.relaxing = false;
        for (const auto& [from, to] : part.tetrahedra) {
            part.relaxing |=
                pbd::linearise(avx2_, tetrahedra + from, tetrahedron_element_.data() + from, to - from, wide,
                               sums, tetrahedron_ratio_, step, from_block(of_tetrahedra, from));
        }
        for (const auto& [from, to] : part.hexahedra) {
            part.relaxing |= pbd::linearise(
                avx2_, hexahedra + from, hexahedron_element_.data() + from, to - from, wide, sums,
                hexahedron_ratio_, settings.hourglass_hardening, step, from_block(of_hexahedra, from));
            add_crushed_corners(part, from, to);
        }
    });
}

void ImplicitMesh::add_springs(const Particles& particles) {
    for (const Spring& s : springs) {
        const std::uint32_t k = corner_of_[s.particle];
        diagonal_[k].array() += s.stiffness;
        coarse_.add_spring(k, s.stiffness);
        residual_[k].head<3>() += s.stiffness * (s.to - particles.predicted[s.particle]);
    }
}

void ImplicitMesh::add_contacts() {
    for_contacts([&](MeshContact& c) { add_contact(c); });
}

void ImplicitMesh::add_contact(MeshContact& c) {
    std::array<std::uint32_t, MeshContact::max_corners> ends{};
    float softest = std::numeric_limits<float>::max();
    float stiffest = 0.0f;
    for (std::size_t e = 0; e < c.corners; ++e) {
        ends[e] = corner_of_[c.particle[e]];
        stiffest = std::max(stiffest, own_stiffness_[ends[e]]);
        softest = std::min(softest, own_stiffness_[ends[e]]);
    }
    c.stiffness = settings.contact_stiffness_scale * (c.within_mesh ? softest : stiffest) * c.area_share;
    if (!c.is_active()) {
        c.held = MeshContact::Held::nothing;
        return;
    }
    const bool sticks = c.sticks();
    c.held = sticks ? MeshContact::Held::point : MeshContact::Held::normal;
    const Vec3f force = c.load();
    const float holding = c.holding_stiffness();
    coarse_.add_spring({ends.data(), c.corners}, c.shares(), sticks ? holding : holding / 3.0f);
    add_force(c, force, 1.0f);
    for (std::size_t e = 0; e < c.corners; ++e) {
        add_block(c, holding * c.share[e] * c.share[e], square_[ends[e]], mixed_[ends[e]]);
    }
}

void ImplicitMesh::add_force(const MeshContact& c, const Vec3f& force, float factor) {
    for (std::size_t e = 0; e < c.corners; ++e) {
        residual_[corner_of_[c.particle[e]]].head<3>() += factor * c.share[e] * force;
    }
    if (c.far_end != MeshContact::fixed_end) {
        Eigen::Vector4f on_obstacle = Eigen::Vector4f::Zero();
        on_obstacle.head<3>() = -factor * force;
        YieldingBodies::add_transposed(bodies.far_end(c.far_end), on_obstacle, bodies_residual_);
    }
}

void ImplicitMesh::invert_blocks(const Range& range) {
    for (std::size_t k = range.first; k < range.end; ++k) {
        if (inverse_mass_[k] == 0.0f) {
            continue;  // its inverse stays zero: a fixed corner
        }
        // Cofactors of the symmetric block.
        const float every = square_[k][3] + diagonal_[k][0];
        const float xx = square_[k][0] + every;
        const float yy = square_[k][1] + every;
        const float zz = square_[k][2] + every;
        const float yz = mixed_[k][0];
        const float zx = mixed_[k][1];
        const float xy = mixed_[k][2];
        const float a = yy * zz - yz * yz;
        const float b = xx * zz - zx * zx;
        const float c = xx * yy - xy * xy;
        const float d = zx * xy - xx * yz;
        const float e = xy * yz - yy * zx;
        const float f = yz * zx - xy * zz;
        const float scale = 1.0f / (xx * a + xy * f + zx * e);
        inverse_[k].column[0] = scale * Eigen::Vector4f(a, f, e, 0.0f);
        inverse_[k].column[1] = scale * Eigen::Vector4f(f, b, d, 0.0f);
        inverse_[k].column[2] = scale * Eigen::Vector4f(e, d, c, 0.0f);
    }
}

void ImplicitMesh::conjugate_gradients() {
    const auto for_ranges = [&](const auto& body) {
        parallel::for_each(ranges_.size(), 1, [&](std::size_t r) { body(ranges_[r]); });
    };
    coarse_.factorise();
    factorise_bodies();
    for_ranges([&](Range& range) {
        invert_blocks(range);
        precondition(range);
    });
    float left = join_levels();
    turn(0.0f);
    for (int n = 1; left > 0.0f; ++n) {
        const float curvature = apply();
        if (!(curvature > 0.0f)) {
            break;  // the residual is rounding error only
        }
        const float step_length = left / curvature;
        advance_contacts(step_length);
        if (bodies.yield()) {
            bodies.step += step_length * bodies_along_;
            bodies_residual_ -= step_length * (bodies.matrix * bodies_along_);
        }
        if (n >= settings.iterations) {
            for_ranges([&](Range& range) { advance(range, step_length); });
            break;
        }
        for_ranges([&](Range& range) {
            advance(range, step_length);
            precondition(range);
        });
        const float next = join_levels();
        turn(next / left);
        left = next;
    }
}

void ImplicitMesh::factorise_bodies() {
    bodies.step.setZero();
    bodies_along_.setZero();
    bodies_moved_.setZero();
    if (!bodies.yield()) {
        return;
    }
    // Blocks of single corners suffice for a preconditioner: neighbours that are held, too, only make it
    // too stiff.
    YieldingBodies::Matrix matrix = bodies.matrix;
    for (std::size_t h = 0; h < held_.size(); ++h) {
        YieldingBodies::add_projected(bodies.jacobian[h], square_[held_[h]], mixed_[held_[h]], matrix);
    }
    for_contacts([&](const MeshContact& c) {
        if (c.far_end != MeshContact::fixed_end && c.held != MeshContact::Held::nothing) {
            Eigen::Vector4f square = Eigen::Vector4f::Zero();
            Eigen::Vector4f mixed = Eigen::Vector4f::Zero();
            add_block(c, c.holding_stiffness(), square, mixed);
            YieldingBodies::add_projected(bodies.far_end(c.far_end), square, mixed, matrix);
        }
    });
    bodies_factor_.compute(matrix);
}

void ImplicitMesh::precondition(Range& range) {
    Float4 product{};
    range.force.setZero();
    for (std::size_t k = range.first; k < range.end; ++k) {
        const Inverse& m = inverse_[k];
        const Float4 r = load_float4(residual_[k]);
        const Float4 to = load_float4(m.column[0]) * r[0] + load_float4(m.column[1]) * r[1] +
                          load_float4(m.column[2]) * r[2];
        put(to, moved_[k]);
        product += r * to;
        coarse_.restrict_to(range.force, k, r);
    }
    range.product = sum_of_four(product);
}

float ImplicitMesh::join_levels() {
    coarse_force_.setZero();
    float product = 0.0f;
    for (const Range& range : ranges_) {
        coarse_force_ += range.force;
        product += range.product;
    }
    product += coarse_.solve(coarse_force_);
    if (bodies.yield()) {
        YieldingBodies::Vector residual = bodies_residual_;
        for (std::size_t h = 0; h < held_.size(); ++h) {
            YieldingBodies::add_transposed(bodies.jacobian[h], residual_[held_[h]], residual);
        }
        bodies_moved_ = bodies_factor_.solve(residual);
        product += residual.dot(bodies_moved_);
    }
    return product;
}

void ImplicitMesh::turn(float keep) {
    if (bodies.yield()) {
        bodies_along_ = bodies_moved_ + keep * bodies_along_;
        for (std::size_t h = 0; h < held_.size(); ++h) {
            put(YieldingBodies::displacement(bodies.jacobian[h], bodies_moved_), moved_[held_[h]]);
        }
    }
    parallel::for_each(ranges_.size(), 1, [&](std::size_t r) { turn(ranges_[r], keep); });
}

void ImplicitMesh::turn(Range& range, float keep) {
    Float4 curvature{};
    for (std::size_t k = range.first; k < range.end; ++k) {
        const Float4 to = load_float4(moved_[k]) + coarse_.displacement(k) + keep * load_float4(along_[k]);
        put(to, along_[k]);
        curvature += load_float4(diagonal_[k]) * to * to;
    }
    range.curvature = sum_of_four(curvature);
}

float ImplicitMesh::apply() {
    const auto* const tetrahedra = tetrahedra_.blocks().data();
    const auto* const hexahedra = hexahedra_.blocks().data();
    parallel::for_each(parts_.size(), 1, [&](std::size_t p) {
        Part& part = parts_[p];
        std::fill(part.image.begin() + part.first, part.image.begin() + part.end, Eigen::Vector4f::Zero());
        const float* const along = along_.front().data();
        float* const image = part.image.front().data();
        for (const auto& [from, to] : part.tetrahedra) {
            pbd::apply(avx2_, tetrahedra + from, tetrahedron_element_.data() + from, to - from, along, image);
        }
        for (const auto& [from, to] : part.hexahedra) {
            pbd::apply(avx2_, hexahedra + from, hexahedron_element_.data() + from, to - from, along, image);
        }
        for (const CrushedCorner& crushed : part.crushed) {
            apply(crushed, along_, part.image);
        }
        for (std::size_t l = part.links[0]; l < part.links[1]; ++l) {
            apply(links_[l], along_, part.image);
        }
        Float4 curvature{};
        for (std::uint32_t k = part.first; k < part.end; ++k) {
            curvature += load_float4(along_[k]) * load_float4(part.image[k]);
        }
        part.curvature = sum_of_four(curvature);
    });
    float curvature = 0.0f;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
        curvature += parts_[p].curvature + ranges_[p].curvature;
    }
    if (bodies.yield()) {
        curvature += bodies_along_.dot(bodies.matrix * bodies_along_);
    }
    for_contacts([&](const MeshContact& c) {
        curvature += c.holding_stiffness() * held_displacement(c).squaredNorm();
    });
    return curvature;
}

Vec3f ImplicitMesh::displacement_of(const MeshContact& contact, const Wide& corners,
                                    const YieldingBodies::Vector& of_bodies) const {
    Eigen::Vector4f displacement = contact.share[0] * corners[corner_of_[contact.particle[0]]];
    for (std::size_t e = 1; e < contact.corners; ++e) {
        displacement += contact.share[e] * corners[corner_of_[contact.particle[e]]];
    }
    if (contact.far_end != MeshContact::fixed_end) {
        Eigen::Vector4f of_obstacle;
        put(YieldingBodies::displacement(bodies.far_end(contact.far_end), of_bodies), of_obstacle);
        displacement -= of_obstacle;
    }
    return displacement.head<3>();
}

Vec3f ImplicitMesh::held_displacement(const MeshContact& contact) const {
    if (contact.held == MeshContact::Held::nothing) {
        return Vec3f::Zero();
    }
    const Vec3f displacement = displacement_of(contact, along_, bodies_along_);
    return contact.held == MeshContact::Held::normal
               ? Vec3f(displacement.dot(contact.normal) * contact.normal)
               : displacement;
}

void ImplicitMesh::advance(const Range& range, float step_length) {
    for (std::size_t k = range.first; k < range.end; ++k) {
        const Float4 along = load_float4(along_[k]);
        put(load_float4(step_[k]) + step_length * along, step_[k]);
        put(load_float4(residual_[k]) - step_length * load_float4(diagonal_[k]) * along, residual_[k]);
    }
    for (const Part& part : parts_) {
        const std::size_t end = std::min<std::size_t>(part.end, range.end);
        for (std::size_t k = std::max<std::size_t>(part.first, range.first); k < end; ++k) {
            put(load_float4(residual_[k]) - step_length * load_float4(part.image[k]), residual_[k]);
        }
    }
}

void ImplicitMesh::advance_contacts(float step_length) {
    for_contacts([&](const MeshContact& c) {
        add_force(c, held_displacement(c), -step_length * c.holding_stiffness());
    });
}

}  // namespace eti::pbd
