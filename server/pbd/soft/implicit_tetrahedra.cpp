// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/implicit_tetrahedra.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/parallel/loops.hpp"
#include "server/pbd/soft/implicit_kernels.hpp"

namespace eti::pbd {

namespace {

// One per thread worth waking for a tongue of some ten thousand tetrahedra.
constexpr std::size_t part_count = 4;
constexpr std::uint32_t no_corner = ~0u;

using Element = ImplicitTetrahedra::Element;
using Block = Tetrahedra::Block;

void linearise_baseline(const Block* blocks, Element* elements, std::size_t count, const float* wide,
                        const ImplicitSums& sums, float ratio) {
    linearise_blocks(blocks, elements, count, wide, sums, ratio);
}
void apply_baseline(const Block* blocks, const Element* elements, std::size_t count, const float* from,
                    float* to) {
    apply_blocks(blocks, elements, count, from, to);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void linearise_avx2(const Block* blocks, Element* elements, std::size_t count,
                                            const float* wide, const ImplicitSums& sums, float ratio) {
    linearise_blocks(blocks, elements, count, wide, sums, ratio);
}
[[gnu::target("avx2")]] void apply_avx2(const Block* blocks, const Element* elements, std::size_t count,
                                        const float* from, float* to) {
    apply_blocks(blocks, elements, count, from, to);
}
#else
constexpr auto linearise_avx2 = linearise_baseline;
constexpr auto apply_avx2 = apply_baseline;
#endif

float total(std::span<const float> moduli) {
    return std::accumulate(moduli.begin(), moduli.end(), 0.0f);
}

float sum_of_four(const Float4& f) {
    return f[0] + f[1] + f[2];
}

}  // namespace

void ImplicitTetrahedra::configure(const Tetrahedra::Description& description, const Particles& particles,
                                   std::span<const float> inverse_mass) {
    mesh_.configure(description, particles);
    ratio_ = neo_hookean_ratio(description.poisson_ratio);
    avx2_ = has_avx2();

    const auto used = mesh_.particles();
    corner_of_.assign(particles.size(), no_corner);
    inverse_mass_.clear();
    for (std::uint32_t k = 0; k < used.size(); ++k) {
        corner_of_[used[k]] = k;
        inverse_mass_.push_back(inverse_mass[used[k]]);
    }
    own_stiffness_.assign(used.size(), 0.0f);
    const std::size_t padded = used.size() + 4 * Tetrahedra::lanes;
    for (Wide* wide : {&rest_, &x_, &diagonal_, &square_, &mixed_, &residual_, &along_, &moved_, &step_}) {
        wide->assign(padded, Eigen::Vector4f::Zero());
    }
    const Eigen::Vector4f none = Eigen::Vector4f::Zero();
    inverse_.assign(padded, {{none, none, none}});
    cut();
    for (std::size_t k = 0; k < used.size(); ++k) {
        rest_[k].head<3>() = particles.rest[used[k]];
    }
    measure_own_stiffness();
    coarse_.configure(rest_, inverse_mass_, mesh_, 2.0f * longest_step_, 1.0f / ratio_);
    coarse_force_ = coarse_.zero_motion();
    for (Range& range : ranges_) {
        range.force = coarse_.zero_motion();
    }
    configured_modulus_ = total(description.youngs_modulus);
}

void ImplicitTetrahedra::set_rest(const Particles& particles) {
    mesh_.set_rest(particles);
    for (std::size_t k = 0; k < mesh_.particles().size(); ++k) {
        rest_[k].head<3>() = particles.rest[mesh_.particles()[k]];
    }
}

void ImplicitTetrahedra::set_youngs_modulus(std::span<const float> moduli) {
    mesh_.set_youngs_modulus(moduli);
    measure_own_stiffness();
    coarse_.set_stiffness(total(moduli) / configured_modulus_);
}

void ImplicitTetrahedra::measure_own_stiffness() {
    if (mesh_.size() == 0) {
        return;
    }
    x_ = rest_;
    linearise_elements();
    std::ranges::fill(own_stiffness_, 0.0f);
    for (const Part& part : parts_) {
        for (std::uint32_t k = part.first; k < part.end; ++k) {
            own_stiffness_[k] += part.gradient[k][3] + part.square[k].head<3>().sum() / 3.0f;
        }
    }
}

void ImplicitTetrahedra::cut() {
    const Block* const blocks = mesh_.size() == 0 ? nullptr : mesh_.blocks(0).data();
    const auto corners = static_cast<std::uint32_t>(mesh_.particles().size());
    parts_.assign(part_count, {});
    ranges_.assign(part_count, {});
    for (std::size_t r = 0; r < part_count; ++r) {
        ranges_[r].first = r * corners / part_count;
        ranges_[r].end = (r + 1) * corners / part_count;
    }
    std::size_t count = 0;
    double volume = 0.0;
    for (std::size_t colour = 0; colour < mesh_.colours(); ++colour) {
        const std::span<const Block> all = mesh_.blocks(colour);
        const auto first = static_cast<std::uint32_t>(all.data() - blocks);
        count += all.size();
        // Blocks of a colour follow a space-filling curve.
        for (std::size_t p = 0; p < part_count; ++p) {
            const auto from = static_cast<std::uint32_t>(p * all.size() / part_count);
            const auto to = static_cast<std::uint32_t>((p + 1) * all.size() / part_count);
            if (from < to) {
                parts_[p].blocks.push_back({first + from, first + to});
            }
        }
    }
    element_.assign(count, {});
    for (Part& part : parts_) {
        part.first = corners;
        for (Wide* wide : {&part.gradient, &part.square, &part.mixed, &part.image}) {
            wide->assign(x_.size(), Eigen::Vector4f::Zero());
        }
        for (const auto& [from, to] : part.blocks) {
            for (const Block& block : std::span(blocks + from, blocks + to)) {
                for (std::size_t k = 0; k < 4 * Tetrahedra::lanes; ++k) {
                    const std::uint32_t corner =
                        block.corner[k / Tetrahedra::lanes][k % Tetrahedra::lanes] / 4;
                    if (corner < corners) {
                        part.first = std::min(part.first, corner);
                        part.end = std::max(part.end, corner + 1);
                    }
                }
                for (std::size_t lane = 0; lane < Tetrahedra::lanes; ++lane) {
                    volume += block.inverse_determinant[lane] != 0.0f
                                  ? 1.0 / (6.0 * std::fabs(double{block.inverse_determinant[lane]}))
                                  : 0.0;
                }
            }
        }
        part.first = std::min(part.first, part.end);  // for a mesh too small for all parts
    }
    // Five or six tetrahedra fill a lattice cube.
    longest_step_ =
        0.5f * static_cast<float>(std::cbrt(6.0 * volume / std::max(1.0, static_cast<double>(mesh_.size()))));
}

void ImplicitTetrahedra::solve(Particles& particles, float dt) {
    linearise(particles, dt);
    solve_linearised(particles, dt);
}

void ImplicitTetrahedra::solve_linearised(Particles& particles, float dt) {
    if (mesh_.size() == 0) {
        return;
    }
    add_springs(particles);
    add_contacts();
    conjugate_gradients();
    const auto used = mesh_.particles();
    float farthest = 0.0f;
    for (std::size_t k = 0; k < used.size(); ++k) {
        const Vec3f inertial = dt * particles.velocity[used[k]];
        farthest = std::max(farthest,
                            inverse_mass_[k] > 0.0f ? (step_[k].head<3>() - inertial).squaredNorm() : 0.0f);
    }
    // NaN compares false and passes: it must not be hidden.
    const float share = farthest > longest_step_ * longest_step_ ? longest_step_ / std::sqrt(farthest) : 1.0f;
    for (std::size_t k = 0; k < used.size(); ++k) {
        if (inverse_mass_[k] > 0.0f) {
            particles.predicted[used[k]] += share * step_[k].head<3>();
        }
    }
    for (MeshContact& c : contacts) {
        const auto [a, b] = corners_of(c);
        const auto [of_a, of_b] = c.shares();
        c.update(share * (of_a * step_[a] + of_b * step_[b]).head<3>());
    }
}

void ImplicitTetrahedra::linearise(const Particles& particles, float dt) {
    if (mesh_.size() == 0) {
        return;
    }
    const auto used = mesh_.particles();
    const float per_mass = 1.0f / (dt * dt);
    coarse_.begin(per_mass);
    for (std::size_t k = 0; k < used.size(); ++k) {
        x_[k].head<3>() = particles.predicted[used[k]];
    }
    linearise_elements();
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

void ImplicitTetrahedra::linearise_elements() {
    const Block* const blocks = mesh_.blocks(0).data();
    parallel::for_each(parts_.size(), 1, [&](std::size_t p) {
        Part& part = parts_[p];
        for (Wide* wide : {&part.gradient, &part.square, &part.mixed}) {
            std::fill(wide->begin() + part.first, wide->begin() + part.end, Eigen::Vector4f::Zero());
        }
        const ImplicitSums sums{part.gradient.front().data(), part.square.front().data(),
                                part.mixed.front().data()};
        for (const auto& [from, to] : part.blocks) {
            (avx2_ ? linearise_avx2 : linearise_baseline)(blocks + from, element_.data() + from, to - from,
                                                          x_.front().data(), sums, ratio_);
        }
    });
}

void ImplicitTetrahedra::add_springs(const Particles& particles) {
    for (const Spring& s : springs) {
        const std::uint32_t k = corner_of_[s.particle];
        diagonal_[k].array() += s.stiffness;
        coarse_.add_spring(k, s.stiffness);
        residual_[k].head<3>() += s.stiffness * (s.to - particles.predicted[s.particle]);
    }
}

void ImplicitTetrahedra::add_contacts() {
    for (MeshContact& c : contacts) {
        const auto ends = corners_of(c);
        const auto shares = c.shares();
        c.stiffness =
            settings.contact_stiffness_scale * std::max(own_stiffness_[ends[0]], own_stiffness_[ends[1]]);
        if (!c.is_active()) {
            c.held = MeshContact::Held::nothing;
            continue;
        }
        const bool sticks = c.sticks();
        c.held = sticks ? MeshContact::Held::point : MeshContact::Held::normal;
        const Vec3f force = c.load();
        coarse_.add_spring(ends, shares, sticks ? c.stiffness : c.stiffness / 3.0f);
        for (std::size_t e = 0; e < 2; ++e) {
            const float k = c.stiffness * shares[e] * shares[e];
            residual_[ends[e]].head<3>() += shares[e] * force;
            if (sticks) {
                square_[ends[e]].head<3>().array() += k;
            } else {
                const Vec3f& n = c.normal;
                square_[ends[e]].head<3>() += k * n.cwiseProduct(n);
                mixed_[ends[e]].head<3>() += k * Vec3f(n.y() * n.z(), n.z() * n.x(), n.x() * n.y());
            }
        }
    }
}

void ImplicitTetrahedra::invert_blocks(const Range& range) {
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

void ImplicitTetrahedra::conjugate_gradients() {
    const auto for_ranges = [&](const auto& body) {
        parallel::for_each(ranges_.size(), 1, [&](std::size_t r) { body(ranges_[r]); });
    };
    coarse_.factorise();
    for_ranges([&](Range& range) {
        invert_blocks(range);
        precondition(range);
    });
    float left = join_levels();
    for_ranges([&](Range& range) { turn(range, 0.0f); });
    for (int n = 1; left > 0.0f; ++n) {
        const float curvature = apply();
        if (!(curvature > 0.0f)) {
            break;  // the residual is rounding error only
        }
        const float step_length = left / curvature;
        advance_contacts(step_length);
        if (n >= settings.iterations) {
            for_ranges([&](Range& range) { advance(range, step_length); });
            break;
        }
        for_ranges([&](Range& range) {
            advance(range, step_length);
            precondition(range);
        });
        const float next = join_levels();
        for_ranges([&](Range& range) { turn(range, next / left); });
        left = next;
    }
}

void ImplicitTetrahedra::precondition(Range& range) {
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

float ImplicitTetrahedra::join_levels() {
    coarse_force_.setZero();
    float product = 0.0f;
    for (const Range& range : ranges_) {
        coarse_force_ += range.force;
        product += range.product;
    }
    return product + coarse_.solve(coarse_force_);
}

void ImplicitTetrahedra::turn(Range& range, float keep) {
    Float4 curvature{};
    for (std::size_t k = range.first; k < range.end; ++k) {
        const Float4 to = load_float4(moved_[k]) + coarse_.displacement(k) + keep * load_float4(along_[k]);
        put(to, along_[k]);
        curvature += load_float4(diagonal_[k]) * to * to;
    }
    range.curvature = sum_of_four(curvature);
}

float ImplicitTetrahedra::apply() {
    const Block* const blocks = mesh_.blocks(0).data();
    parallel::for_each(parts_.size(), 1, [&](std::size_t p) {
        Part& part = parts_[p];
        std::fill(part.image.begin() + part.first, part.image.begin() + part.end, Eigen::Vector4f::Zero());
        for (const auto& [from, to] : part.blocks) {
            (avx2_ ? apply_avx2 : apply_baseline)(blocks + from, element_.data() + from, to - from,
                                                  along_.front().data(), part.image.front().data());
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
    for (const MeshContact& c : contacts) {
        curvature += c.stiffness * held_displacement(c).squaredNorm();
    }
    return curvature;
}

Vec3f ImplicitTetrahedra::held_displacement(const MeshContact& contact) const {
    if (contact.held == MeshContact::Held::nothing) {
        return Vec3f::Zero();
    }
    const auto [a, b] = corners_of(contact);
    const auto [of_a, of_b] = contact.shares();
    const Vec3f displacement = (of_a * along_[a] + of_b * along_[b]).head<3>();
    return contact.held == MeshContact::Held::normal
               ? Vec3f(displacement.dot(contact.normal) * contact.normal)
               : displacement;
}

void ImplicitTetrahedra::advance(const Range& range, float step_length) {
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

void ImplicitTetrahedra::advance_contacts(float step_length) {
    for (const MeshContact& c : contacts) {
        const Vec3f force = step_length * c.stiffness * held_displacement(c);
        const auto [a, b] = corners_of(c);
        const auto [of_a, of_b] = c.shares();
        residual_[a].head<3>() -= of_a * force;
        residual_[b].head<3>() -= of_b * force;
    }
}

}  // namespace eti::pbd
