// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/check_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/math/units.hpp"
#include "common/mesh/check.hpp"
#include "common/mesh/distance.hpp"
#include "common/model/landmark.hpp"
#include "server/patient/mesh/components.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {

namespace {

std::string place(const Vec3f& p) {
    return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x() / millimetre, p.y() / millimetre,
                       p.z() / millimetre);
}

/// Counts violations and remembers the first location.
class Faults {
  public:
    void add(const Vec3f& where) {
        if (count_++ == 0) {
            first_ = where;
        }
    }
    [[nodiscard]] Invariant report(std::string name, std::size_t of, const std::string& what) const {
        return {std::move(name), count_ == 0,
                count_ == 0 ? fmt::format("{} {}", of, what)
                            : fmt::format("{} of {} {}, first near {}", count_, of, what, place(first_))};
    }

  private:
    std::size_t count_ = 0;
    Vec3f first_ = Vec3f::Zero();
};

Invariant sound(const std::string& name, const TriangleMesh& mesh) {
    const MeshReport report = check(mesh);
    const bool holds = report.is_valid() && report.volume > 0.0;
    std::string found = fmt::format("{} triangles in {} parts, {:.2f} ml", report.triangles,
                                    report.components, 1e6 * report.volume);
    if (!holds) {
        found += ": " + report.describe() +
                 (report.fault_at ? ", near " + place(*report.fault_at) : std::string());
    }
    return {name + " is closed, manifold, oriented, free of crossings", holds, found};
}

/// Tools collide with the shell's distances, and Bullet's with its triangles; both tolerate a few
/// self-intersections, which are reported.
Invariant closed_shell(const TriangleMesh& mesh) {
    const MeshReport report = check(mesh);
    const bool holds = report.triangles > 0 && report.volume > 0.0 &&
                       report.open_edges + report.nonmanifold_edges + report.misoriented_edges +
                               report.pinched_vertices + report.degenerate_triangles ==
                           0 &&
                       100 * report.self_intersections < report.triangles;
    return {"the offset shell is closed, manifold, oriented, almost free of crossings", holds,
            holds ? fmt::format("{} triangles in {} parts, {:.2f} ml, {} crossing pairs", report.triangles,
                                report.components, 1e6 * report.volume, report.self_intersections)
                  : report.describe()};
}

// Sums of a point's weights in single precision are exact to a few parts in ten million; the file stores
// floats.
constexpr float weight_tolerance = 1e-5f;

Invariant weights_sum_to_one(const Patient& patient) {
    Faults faults;
    std::size_t count = 0;
    const auto look = [&](const auto& weights, const Vec3f& where) {
        ++count;
        const float sum = std::accumulate(weights.begin(), weights.end(), 0.0f);
        if (!(std::fabs(sum - 1.0f) <= weight_tolerance) || *std::ranges::min_element(weights) < 0.0f) {
            faults.add(where);
        }
    };
    for (const Surface& surface : patient.surfaces) {
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            look(surface.skin[i].weight, surface.mesh.vertices[i]);
        }
    }
    for (std::size_t i = 0; i < patient.particles.size(); ++i) {
        look(patient.particles.bones[i], patient.particles.rest[i]);
    }
    for (std::size_t i = 0; i < patient.shell.vertex_bones.size(); ++i) {
        look(patient.shell.vertex_bones[i], patient.shell.mesh.vertices[i]);
    }
    for (const CarriedPoint& point : patient.landmarks) {
        look(point.skin.weight, point.rest);
    }
    for (const CarriedPoint& point : patient.glottis_contour) {
        look(point.skin.weight, point.rest);
    }
    return faults.report("weights sum to one", count, "points");
}

/// The defect described in the paper: clusters of surrounding tissue that contain particles of the
/// epiglottis, or carry its skin, drag the whole plate along.
std::vector<Invariant> epiglottis_has_own_cluster(const Patient& patient) {
    const ParticleSet& set = patient.particles;
    const ClusterSet& clusters = patient.clusters;
    std::vector<std::uint32_t> own;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] == Tissue::epiglottis) {
            own.push_back(i);
        }
    }
    std::vector<std::size_t> its;
    Faults foreign;
    const Vec3f base = rest_of(patient, Landmark::epiglottis_base);
    const float length = (rest_of(patient, Landmark::epiglottis_tip) - base).norm();
    std::size_t hinge = 0;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        if (clusters.tissue[c] == Tissue::epiglottis) {
            its.push_back(c);
            continue;
        }
        for (const std::uint32_t i : clusters.members(c)) {
            // Only the stalk, its hinge in the larynx, may be in other clusters too.
            if (set.tissue[i] == Tissue::epiglottis) {
                ++hinge;
                if ((set.rest[i] - base).norm() > 0.3f * length) {
                    foreign.add(set.rest[i]);
                }
            }
        }
    }
    std::vector<Invariant> found;
    std::vector<std::uint32_t> members;
    for (const std::size_t c : its) {
        members.insert(members.end(), clusters.members(c).begin(), clusters.members(c).end());
    }
    std::ranges::sort(members);
    found.push_back({"the epiglottis is clusters over exactly its particles, each in one",
                     members == own && own.size() >= 4,
                     fmt::format("{} particles, {} clusters", own.size(), its.size())});
    found.push_back(foreign.report("other clusters contain only its stalk", hinge, "memberships"));
    found.back().holds = found.back().holds && hinge > 0;

    // Mucosal folds at the plate are drawn along; points farther away are not.
    const float fold = 0.45f * length;
    const auto near_plate = [&](const Vec3f& p) {
        return std::ranges::any_of(own, [&](std::uint32_t i) { return (set.rest[i] - p).norm() < fold; });
    };
    Faults skin;
    std::size_t vertices = 0;
    for (const Surface& surface : patient.surfaces) {
        const bool is_epiglottis = surface.tissue == Tissue::epiglottis;
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                if (surface.skin[i].weight[k] == 0.0f) {
                    continue;
                }
                const std::size_t frame = surface.skin[i].frame[k];
                const bool by_its_cluster =
                    frame >= bone_count && std::ranges::binary_search(its, frame - bone_count);
                vertices += is_epiglottis && k == 0 ? 1 : 0;
                if (is_epiglottis ? !by_its_cluster
                                  : by_its_cluster && !near_plate(surface.mesh.vertices[i])) {
                    skin.add(surface.mesh.vertices[i]);
                }
            }
        }
    }
    found.push_back(
        skin.report("only its own clusters move its skin, and no skin far from it", vertices, "vertices"));
    found.back().holds = found.back().holds && vertices > 0;
    return found;
}

/// Connected components through clusters, links and tetrahedra.
class UnionFind {
  public:
    explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t root(std::uint32_t i) {
        while (parent_[i] != i) {
            i = parent_[i] = parent_[parent_[i]];
        }
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

  private:
    std::vector<std::uint32_t> parent_;
};

std::vector<Invariant> tissue_is_attached_to_bone(const Patient& patient) {
    const ParticleSet& set = patient.particles;
    UnionFind parts(set.size());
    std::vector<std::uint8_t> held(set.size(), 0);
    Faults small;
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        const auto members = patient.clusters.members(c);
        if (members.size() < 4) {
            small.add(patient.frame_rest_centre[bone_count + c]);
        }
        for (const std::uint32_t i : members) {
            held[i] = 1;
            parts.join(i, members.front());
        }
    }
    for (const auto& ends : patient.links.ends) {
        parts.join(ends[0], ends[1]);
    }
    for (const auto& corners : patient.tetrahedra.corners) {
        for (const std::uint32_t i : corners) {
            held[i] = 1;
            parts.join(i, corners[0]);
        }
    }
    std::vector<std::uint8_t> anchored(set.size(), 0);
    std::size_t moving = 0;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        moving += set.mass[i] > 0.0f ? 1 : 0;
        if (set.mass[i] == 0.0f) {
            anchored[parts.root(i)] = 1;
        }
    }
    Faults loose, adrift;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.mass[i] > 0.0f && held[i] == 0) {
            loose.add(set.rest[i]);
        }
        if (set.mass[i] > 0.0f && anchored[parts.root(i)] == 0) {
            adrift.add(set.rest[i]);
        }
    }
    std::vector<Invariant> found;
    found.push_back(small.report("clusters have four members or more", patient.clusters.size(), "clusters"));
    found.push_back(loose.report("each moving particle is in a cluster or tetrahedron", moving, "particles"));
    found.push_back(adrift.report("each moving particle is connected to bone", moving, "particles"));

    std::size_t ligament = 0, floor = 0, left = 0, right = 0;
    for (const auto& [a, b] : patient.links.ends) {
        const int one = family_of(set.tissue[a]);
        const int other = family_of(set.tissue[b]);
        const auto joins = [&](int x, int y) { return (one == x && other == y) || (one == y && other == x); };
        if (joins(0, 2)) {
            (set.rest[a].x() < 0.0f ? right : left) += 1;
        }
        ligament += joins(1, 2) ? 1 : 0;
        floor += joins(0, 1) ? 1 : 0;
    }
    found.push_back({"the hyoepiglottic ligament exists", ligament > 0, fmt::format("{} links", ligament)});
    found.push_back({"aryepiglottic folds hold the epiglottis on both sides", left > 0 && right > 0,
                     fmt::format("{} and {} links", left, right)});
    found.push_back(
        {"the tongue is attached to the floor of the mouth", floor > 0, fmt::format("{} links", floor)});
    return found;
}

Invariant tetrahedra_are_valid(const Patient& patient) {
    Faults faults;
    const ParticleSet& set = patient.particles;
    for (const auto& c : patient.tetrahedra.corners) {
        const Vec3f a = set.rest[c[1]] - set.rest[c[0]];
        const Vec3f b = set.rest[c[2]] - set.rest[c[0]];
        const Vec3f d = set.rest[c[3]] - set.rest[c[0]];
        const float longest = std::max({a.norm(), b.norm(), d.norm()});
        const bool mixed = std::ranges::any_of(
            c, [&](std::uint32_t i) { return family_of(set.tissue[i]) != family_of(set.tissue[c[0]]); });
        // Corners of a cube: at least 1/6 of the edge cubed, for a longest edge of sqrt(2) edges.
        if (mixed || std::fabs(a.cross(b).dot(d)) < 0.2f * longest * longest * longest) {
            faults.add(set.rest[c[0]]);
        }
    }
    return faults.report("tetrahedra have volume and stay within one tissue",
                         patient.tetrahedra.corners.size(), "tetrahedra");
}

/// Distances to a surface on a grid's nodes, exact within three spacings.
DistanceGrid distance_to(const TriangleMesh& mesh, const DistanceGrid& grid) {
    return mesh_distance(mesh, grid.origin, grid.spacing, grid.size, 3.0f * grid.spacing);
}

Invariant particles_are_outside_bone(const Patient& patient) {
    const ParticleSet& set = patient.particles;
    Faults faults;
    for (const Surface& surface : patient.surfaces) {
        if (!is_bone(surface.tissue) || surface.tissue == Tissue::hyoid) {
            continue;  // the hyoid moves with the surrounding tissue
        }
        const DistanceGrid& shell = patient.shell.distance;
        const DistanceGrid bone = distance_to(surface.mesh, shell);
        for (std::size_t i = 0; i < set.size(); ++i) {
            // The surface comes from a grid of 1.5 spacings and is simplified, which limits the accuracy of
            // bone.
            if (bone.distance(set.rest[i]) < -1.5f * shell.spacing) {
                faults.add(set.rest[i]);
            }
        }
    }
    return faults.report("particles keep out of bone", set.size(), "particles");
}

std::vector<Invariant> distances_agree(const Patient& patient) {
    const Shell& shell = patient.shell;
    const DistanceGrid& grid = shell.distance;
    // A node's distance is at most that to the vertex; interpolated, at most half a cell's diagonal.
    const float tolerance = 0.5f * std::sqrt(3.0f) * grid.spacing;
    Faults off, wrong, outside;
    for (const Vec3f& v : shell.mesh.vertices) {
        if (std::fabs(grid.distance(v)) > tolerance) {
            off.add(v);
        }
    }
    const DistanceGrid exact = distance_to(shell.mesh, grid);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < exact.value.size(); ++i) {
        if (std::fabs(exact.value[i]) > tolerance) {
            ++compared;
            if ((exact.value[i] < 0.0f) != (grid.value[i] < 0.0f)) {
                const auto nx = static_cast<std::size_t>(grid.size[0]);
                const auto ny = static_cast<std::size_t>(grid.size[1]);
                wrong.add(grid.node(static_cast<int>(i % nx), static_cast<int>(i / nx % ny),
                                    static_cast<int>(i / nx / ny)));
            }
        }
    }
    const auto body = std::ranges::find(patient.surfaces, "body", &Surface::name);
    std::vector<Invariant> found;
    found.push_back(
        off.report("the shell's distances are zero on its mesh", shell.mesh.vertices.size(), "vertices"));
    found.push_back(wrong.report("they have the mesh's sign", compared, "grid nodes"));
    if (body == patient.surfaces.end()) {
        found.push_back({"the shell lies inside tissue or mandible", false, "there is no surface 'body'"});
        return found;
    }
    const DistanceGrid skin = distance_to(body->mesh, grid);
    // The mandible is solid to tools also where the tongue is attached to it.
    std::vector<DistanceGrid> mandible;
    for (const Surface& surface : patient.surfaces) {
        if (surface.tissue == Tissue::mandible) {
            mandible.push_back(distance_to(surface.mesh, grid));
        }
    }
    // The body is cut off at the shoulders; the shell may continue below.
    float floor = body->mesh.vertices.front().z();
    for (const Vec3f& v : body->mesh.vertices) {
        floor = std::min(floor, v.z());
    }
    std::size_t inner = 0;
    for (const Vec3f& v : shell.mesh.vertices) {
        if (v.z() < floor + 3.0f * grid.spacing) {
            continue;
        }
        ++inner;
        // Tolerance for simplification: one spacing for displacement of skin, two for loss of a bony ridge.
        if (skin.distance(v) > grid.spacing && std::ranges::none_of(mandible, [&](const DistanceGrid& bone) {
                return bone.distance(v) <= 2.0f * grid.spacing;
            })) {
            outside.add(v);
        }
    }
    found.push_back(outside.report("the shell lies inside tissue or mandible", inner, "vertices"));
    return found;
}

// Behind the gums the shell encloses the mouth: no path leads from there to the edge of its grid, except
// downwards, where a volume may cut through trachea and gullet.
Invariant shell_has_no_hole(const Patient& patient) {
    const DistanceGrid& grid = patient.shell.distance;
    const Vec3f gum = rest_of(patient, Landmark::upper_gum);
    const float size = (rest_of(patient, Landmark::glottis) - gum).norm();
    // Farther back than the corners of a wide mouth.
    const float behind = std::max(gum.y(), rest_of(patient, Landmark::lower_gum).y()) + 0.2f * size;
    const float room = 0.02f * size;  // half the width of the thinnest tube
    std::vector<std::uint8_t> free(grid.value.size(), 0);
    const auto for_nodes = [&](const auto& visit) {
        for (int z = 0; z < grid.size[2]; ++z) {
            for (int y = 0; y < grid.size[1]; ++y) {
                for (int x = 0; x < grid.size[0]; ++x) {
                    visit(x, y, z, grid.index(x, y, z));
                }
            }
        }
    };
    for_nodes([&](int x, int y, int z, std::size_t i) {
        free[i] = grid.value[i] > room && grid.node(x, y, z).y() >= behind ? 1 : 0;
    });
    const Components parts = components(grid.size, free);
    std::vector<bool> within(parts.voxels.size(), false);
    for (const Landmark inside : {Landmark::tongue_dorsum, Landmark::vallecula, Landmark::epiglottis_tip}) {
        const Vec3f at = (rest_of(patient, inside) - grid.origin) / grid.spacing;
        const Eigen::Array3i node = at.array().round().cast<int>();
        if ((node >= 0).all() && (node < Eigen::Map<const Eigen::Array3i>(grid.size.data())).all()) {
            within[parts.part[grid.index(node.x(), node.y(), node.z())]] = true;
        }
    }
    within[0] = false;  // a landmark inside the shell
    Faults out;
    std::size_t count = 0;
    for_nodes([&](int x, int y, int z, std::size_t i) {
        if (!within[parts.part[i]]) {
            return;
        }
        ++count;
        if (x == 0 || y == 0 || x == grid.size[0] - 1 || y == grid.size[1] - 1 || z == grid.size[2] - 1) {
            out.add(grid.node(x, y, z));
        }
    });
    if (count == 0) {
        out.add(rest_of(patient, Landmark::tongue_dorsum));  // the shell fills the mouth
    }
    return out.report("the only path out of the mouth leads between the gums", count, "grid nodes");
}

std::vector<Invariant> airway_is_open(const Patient& patient) {
    std::vector<Invariant> found;
    // The shell's lumen is wider than the tissue's by the depth that yields to a tool.
    Faults closed;
    std::size_t samples = 0;
    const auto walk = [&](Landmark from, Landmark to) {
        for (int i = 0; i <= 40; ++i) {
            const float t = static_cast<float>(i) / 40.0f;
            const Vec3f p = (1.0f - t) * rest_of(patient, from) + t * rest_of(patient, to);
            ++samples;
            if (patient.shell.distance.distance(p) <= 0.0f) {
                closed.add(p);
            }
        }
    };
    walk(Landmark::glottis, Landmark::trachea_mid);
    walk(Landmark::trachea_mid, Landmark::carina);
    found.push_back(closed.report("the path from glottis to carina is open", samples, "points"));

    const Vec3f glottis = rest_of(patient, Landmark::glottis);
    double area = 0.0;
    const auto& contour = patient.glottis_contour;
    Vec3f twice = Vec3f::Zero();
    for (std::size_t i = 0; i < contour.size(); ++i) {
        twice += (contour[i].rest - glottis).cross(contour[(i + 1) % contour.size()].rest - glottis);
    }
    area = 0.5 * static_cast<double>(twice.norm());
    const float size = std::cbrt(patient.weight / 3.5f);
    // At least a slit of 1 mm^2 at term, at most a circle.
    const double least = 1e-6 * static_cast<double>(size * size);
    const auto length = static_cast<double>(
        (rest_of(patient, Landmark::glottis_anterior) - rest_of(patient, Landmark::glottis_posterior))
            .norm());
    const bool open = contour.size() >= 8 && area > least && area < 0.25 * std::numbers::pi * length * length;
    found.push_back({"the glottis is open", open,
                     fmt::format("{:.1f} mm^2 within {} points", 1e6 * area, contour.size())});

    const auto above = [&](Landmark a, Landmark b) {
        return rest_of(patient, a).z() > rest_of(patient, b).z();
    };
    const auto before = [&](Landmark a, Landmark b) {
        return rest_of(patient, a).y() < rest_of(patient, b).y();
    };
    const bool order = above(Landmark::upper_gum, Landmark::lower_gum) &&
                       above(Landmark::mouth_opening, Landmark::vallecula) &&
                       above(Landmark::epiglottis_tip, Landmark::epiglottis_base) &&
                       above(Landmark::epiglottis_base, Landmark::glottis) &&
                       above(Landmark::glottis, Landmark::trachea_mid) &&
                       above(Landmark::trachea_mid, Landmark::carina) &&
                       before(Landmark::mouth_opening, Landmark::tongue_dorsum) &&
                       before(Landmark::tongue_dorsum, Landmark::vallecula) &&
                       before(Landmark::glottis_anterior, Landmark::glottis_posterior) &&
                       before(Landmark::trachea_mid, Landmark::oesophagus_mid);
    found.push_back(
        {"landmarks are in anatomical order", order, fmt::format("{} landmarks", patient.landmarks.size())});
    return found;
}

Invariant frames_lie_in_their_clusters(const Patient& patient) {
    Faults faults;
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        Vec3f mean = Vec3f::Zero();
        const auto members = patient.clusters.members(c);
        for (const std::uint32_t i : members) {
            mean += patient.particles.rest[i] / static_cast<float>(members.size());
        }
        // Rounding of sums over hundreds of decimetres in single precision.
        if ((mean - patient.frame_rest_centre[bone_count + c]).norm() > 1e-5f) {
            faults.add(mean);
        }
    }
    return faults.report("frames are at their clusters' centres", patient.clusters.size(), "clusters");
}

}  // namespace

std::vector<Invariant> check_model(const Patient& patient) {
    std::vector<Invariant> found;
    const auto add = [&](std::vector<Invariant> more) {
        found.insert(found.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    };
    for (const Surface& surface : patient.surfaces) {
        found.push_back(sound("surface '" + surface.name + "'", surface.mesh));
    }
    found.push_back(closed_shell(patient.shell.mesh));
    add(distances_agree(patient));
    found.push_back(shell_has_no_hole(patient));
    found.push_back(weights_sum_to_one(patient));
    found.push_back(frames_lie_in_their_clusters(patient));
    add(epiglottis_has_own_cluster(patient));
    add(tissue_is_attached_to_bone(patient));
    found.push_back(tetrahedra_are_valid(patient));
    found.push_back(particles_are_outside_bone(patient));
    add(airway_is_open(patient));
    return found;
}

}  // namespace eti::patient
