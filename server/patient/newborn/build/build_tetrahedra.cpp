// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <array>
#include <map>
#include <set>

#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {

namespace {

// Division of a cube, corners numbered by bits x, y, z, into a regular tetrahedron and four that cut off the
// other corners. Neighbouring cubes alternate between the two variants, so that their faces match and left
// mirrors right.
constexpr int cut[2][5][4] = {
    {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}},
    {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}},
};

}  // namespace

void build_tetrahedra(std::span<const LatticePlace> places, Patient& patient) {
    const ParticleSet& set = patient.particles;
    std::map<LatticePlace, std::uint32_t> particle_at;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        particle_at[places[i]] = i;
    }
    std::set<LatticePlace> cells;  // each identified by its lowest corner
    for (const auto& [at, i] : particle_at) {
        for (int k = 0; k < 8; ++k) {
            LatticePlace cell = at;
            for (int axis = 0; axis < 3; ++axis) {
                cell.index[static_cast<std::size_t>(axis)] -= k >> axis & 1;
            }
            cells.insert(cell);
        }
    }
    constexpr std::uint32_t none = ~0u;
    for (const LatticePlace& cell : cells) {
        std::array<std::uint32_t, 8> corner{};
        for (int k = 0; k < 8; ++k) {
            LatticePlace at = cell;
            for (int axis = 0; axis < 3; ++axis) {
                at.index[static_cast<std::size_t>(axis)] += k >> axis & 1;
            }
            const auto found = particle_at.find(at);
            corner[static_cast<std::size_t>(k)] = found == particle_at.end() ? none : found->second;
        }
        const int parity = (cell.index[0] + cell.index[1] + cell.index[2]) & 1;
        for (const auto& numbers : cut[parity]) {
            std::array<std::uint32_t, 4> ends{};
            bool whole = true;
            bool moves = false;
            for (std::size_t k = 0; k < 4; ++k) {
                ends[k] = corner[static_cast<std::size_t>(numbers[k])];
                whole = whole && ends[k] != none;
                moves = moves || (whole && set.mass[ends[k]] > 0.0f);
            }
            if (whole && moves) {
                patient.tetrahedra.corners.push_back(ends);
            }
        }
    }
    // Particles in neither cluster nor tetrahedron are isolated: they move with the bones.
    std::vector<bool> held(set.size(), false);
    for (const std::uint32_t i : patient.clusters.member) {
        held[i] = true;
    }
    for (const auto& corners : patient.tetrahedra.corners) {
        for (const std::uint32_t i : corners) {
            held[i] = true;
        }
    }
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (!held[i]) {
            patient.particles.mass[i] = 0.0f;
        }
    }
}

}  // namespace eti::patient
