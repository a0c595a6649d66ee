// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Links of ImplicitMesh.
#include <algorithm>
#include <array>

#include "server/parallel/loops.hpp"
#include "server/pbd/implicit/implicit_mesh.hpp"

namespace eti::pbd {

void ImplicitMesh::cut_links(const Links& links, const Particles& particles) {
    links_.clear();
    links_.reserve(links.ends.size());
    std::vector<bool> taken(links.ends.size(), false);
    for (Part& part : parts_) {
        const auto in_part = [&](std::uint32_t corner) {
            return corner != no_corner && part.first <= corner && corner < part.end;
        };
        const std::size_t first = links_.size();
        const bool is_last = &part == &parts_.back();
        for (std::uint32_t n = 0; n < links.ends.size(); ++n) {
            Link link;
            link.particle = links.ends[n];
            link.number = n;
            link.stiffness = links.stiffness[n];
            for (std::size_t e = 0; e < 2; ++e) {
                link.corner[e] = corner_of_[link.particle[e]];
            }
            if (!taken[n] && (is_last || in_part(link.corner[0]) || in_part(link.corner[1]))) {
                links_.push_back(link);
                taken[n] = true;
            }
        }
        part.links = {first, links_.size()};
        for (std::size_t l = first; l < links_.size(); ++l) {
            for (const std::uint32_t corner : links_[l].corner) {
                if (corner != no_corner) {
                    part.first = std::min(part.first, corner);
                    part.end = std::max(part.end, corner + 1);
                }
            }
        }
    }
    set_link_lengths(particles);
}

void ImplicitMesh::set_link_lengths(const Particles& particles) {
    for (Link& link : links_) {
        link.length = (particles.rest[link.particle[0]] - particles.rest[link.particle[1]]).norm();
    }
}

void ImplicitMesh::set_link_stiffness(std::span<const float> stiffness) {
    for (Link& link : links_) {
        link.stiffness = stiffness[link.number];
    }
}

void ImplicitMesh::linearise_links(const Particles& particles) {
    parallel::for_each(parts_.size(), 1, [&](std::size_t p) {
        Part& part = parts_[p];
        for (std::size_t l = part.links[0]; l < part.links[1]; ++l) {
            Link& link = links_[l];
            const auto place = [&](std::size_t e) -> Vec3f {
                return link.corner[e] == no_corner ? particles.position[link.particle[e]]
                                                   : x_[link.corner[e]].head<3>();
            };
            const Vec3f apart = place(0) - place(1);
            const float distance = std::max(apart.norm(), shortest_link);
            const Vec3f n = apart / distance;
            const float tension = link.stiffness * (distance - link.length);
            // A link that is pressed would buckle: its matrix across is left out, so that it stays positive.
            const float across = std::max(0.0f, tension / distance);
            link.square.setZero();
            link.mixed.setZero();
            link.square.head<3>() = (link.stiffness - across) * n.cwiseProduct(n) + Vec3f::Constant(across);
            link.mixed.head<3>() =
                (link.stiffness - across) * Vec3f(n.y() * n.z(), n.z() * n.x(), n.x() * n.y());
            for (std::size_t e = 0; e < 2; ++e) {
                if (link.corner[e] != no_corner) {
                    part.gradient[link.corner[e]].head<3>() += (e == 0 ? tension : -tension) * n;
                    part.square[link.corner[e]] += link.square;
                    part.mixed[link.corner[e]] += link.mixed;
                }
            }
        }
    });
    for (const Link& link : links_) {
        // Along one of three directions.
        if (link.corner[0] == no_corner || link.corner[1] == no_corner) {
            coarse_.add_spring(std::min(link.corner[0], link.corner[1]), link.stiffness / 3.0f);
        } else {
            constexpr std::array difference = {1.0f, -1.0f};
            coarse_.add_spring(link.corner, difference, link.stiffness / 3.0f);
        }
    }
}

void ImplicitMesh::apply(const Link& link, const Wide& along, Wide& image) {
    const Eigen::Vector4f none = Eigen::Vector4f::Zero();
    const Eigen::Vector4f apart = (link.corner[0] == no_corner ? none : along[link.corner[0]]) -
                                  (link.corner[1] == no_corner ? none : along[link.corner[1]]);
    Eigen::Vector4f force = link.square.cwiseProduct(apart);
    force[0] += link.mixed[2] * apart[1] + link.mixed[1] * apart[2];
    force[1] += link.mixed[2] * apart[0] + link.mixed[0] * apart[2];
    force[2] += link.mixed[1] * apart[0] + link.mixed[0] * apart[1];
    if (link.corner[0] != no_corner) {
        image[link.corner[0]] += force;
    }
    if (link.corner[1] != no_corner) {
        image[link.corner[1]] -= force;
    }
}

}  // namespace eti::pbd
