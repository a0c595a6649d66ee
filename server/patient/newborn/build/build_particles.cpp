// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>
#include <unordered_set>

#include "common/math/units.hpp"
#include "common/mesh/point_grid.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/build/epiglottis_plate.hpp"

namespace eti::patient {

namespace {

/// A voxel of tissue; not filled in air, in bone, or in tissue too far away to matter.
struct Voxel {
    bool filled = false;
    bool fine = false;
    bool fixed = false;
    Tissue tissue = Tissue::soft;
};

Tissue body_tissue(const Fields& f) {
    if (f.upper_gum < 0.0f) {
        return Tissue::upper_gum;
    }
    if (f.lower_gum < 0.0f) {
        return Tissue::lower_gum;
    }
    if (f.palate < 0.0f) {
        return Tissue::palate;
    }
    return f.larynx < 0.0f ? Tissue::larynx : Tissue::soft;
}

Voxel classify(const Anatomy& anatomy, const Fields& f, const Vec3f& point, float spacing, float region) {
    Voxel voxel;
    if (f.skin > 0.0f) {
        return voxel;
    }
    const Vec3f model = anatomy.to_model(point);
    const float bone = std::min({f.skull, f.mandible, f.spine});
    if (f.epiglottis < 0.0f) {
        return {true, true, false, Tissue::epiglottis};
    }
    if (f.tongue < 0.0f) {
        // The tongue is attached to the mandible; a large one touches the palate, and slides on it.
        return {bone > 0.0f, false, f.mandible < 0.7f * spacing, Tissue::tongue};
    }
    // Blade and tube do not reach above the soft palate; below the cricoid the tube touches the shell only.
    const bool in_reach = model.z() > -46.0f && !(model.z() > 3.0f && model.y() < 24.0f);
    // Tissue that the tongue is pressed into matters as much as tissue that tools touch.
    const float depth = std::min(f.cavity, f.tongue);
    if (depth < 0.0f || depth > region || bone < 0.0f || !in_reach) {
        return voxel;
    }
    voxel.filled = true;
    voxel.tissue = body_tissue(f);
    voxel.fine = f.larynx < 0.0f && model.z() > -44.0f;
    voxel.fixed = bone < 0.7f * spacing || depth > region - spacing || model.z() < -44.0f ||
                  voxel.tissue == Tissue::upper_gum || voxel.tissue == Tissue::lower_gum;
    return voxel;
}

/// Divides positions [m] along a unit vector into strips of equal length: `wished` strips, or fewer if one
/// would be shorter than `shortest` [m]. Returns the indices in each, ascending.
std::vector<std::vector<std::uint32_t>> strips(const std::vector<Vec3f>& places, const Vec3f& along,
                                               float shortest, std::size_t wished) {
    if (places.empty()) {
        return {};
    }
    const auto by_place = [&](const Vec3f& p) { return p.dot(along); };
    const auto [first, last] = std::ranges::minmax_element(places, {}, by_place);
    const float begin = by_place(*first);
    const float length = std::max(by_place(*last) - begin, 1e-9f);
    const auto fit = static_cast<std::size_t>(length / shortest);
    std::vector<std::vector<std::uint32_t>> out(std::clamp(fit, std::size_t{1}, wished));
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const float share = (by_place(places[i]) - begin) / length;
        const auto strip = static_cast<std::size_t>(share * static_cast<float>(out.size()));
        out[std::min(strip, out.size() - 1)].push_back(i);
    }
    return out;
}

/// Whether a particle of the epiglottis is in its stalk, rooted in the larynx. `size`: of the patient,
/// relative to the model.
bool of_stalk(const ParticleSet& set, std::uint32_t i, const Vec3f& stalk, float size) {
    return set.tissue[i] == Tissue::epiglottis && (set.rest[i] - stalk).norm() < 3.0e-3f * size;
}

}  // namespace

std::vector<LatticePlace> build_particles(const Anatomy& anatomy, const BuildSettings& settings,
                                          Patient& patient) {
    ParticleSet& set = patient.particles;
    std::vector<LatticePlace> places;
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.airway_bounds();
    const auto add = [&](const Vec3f& point, float radius, float mass, Tissue tissue, LatticePlace place) {
        set.rest.push_back(point);
        set.radius.push_back(radius);
        set.tissue.push_back(tissue);
        set.mass.push_back(mass);
        set.bones.push_back(anatomy.bone_weights(point, tissue));
        place.lattice = 2 * family_of(tissue) + place.lattice;
        places.push_back(place);
    };
    const auto fill = [&](float spacing, bool fine) {
        const Vec3f extent = (high - low) / spacing;
        // A lattice with an odd number of points about the mid-sagittal plane is left-right symmetric.
        const int half = static_cast<int>(high.x() / spacing);
        for (int k = 0; k < static_cast<int>(extent.z()); ++k) {
            for (int j = 0; j < static_cast<int>(extent.y()); ++j) {
                for (int i = -half; i <= half; ++i) {
                    const Vec3f point(static_cast<float>(i) * spacing,
                                      low.y() + (static_cast<float>(j) + 0.5f) * spacing,
                                      low.z() + (static_cast<float>(k) + 0.5f) * spacing);
                    const Voxel voxel =
                        classify(anatomy, anatomy.fields(point), point, spacing, settings.region * size);
                    const bool is_plate = settings.plate && voxel.tissue == Tissue::epiglottis;
                    if (voxel.filled && voxel.fine == fine && !is_plate) {
                        const float mass = voxel.fixed ? 0.0f : tissue_density * spacing * spacing * spacing;
                        add(point, 0.5f * spacing, mass, voxel.tissue, {fine ? 0 : 1, {i, j, k}});
                    }
                }
            }
        }
    };
    fill(settings.spacing * size, false);
    fill(settings.fine_spacing * size, true);
    if (settings.plate) {
        for (const PlateNode& node : epiglottis_plate(anatomy, settings.fine_spacing * size)) {
            add(node.position, node.radius, tissue_density * node.volume, Tissue::epiglottis,
                {0, node.index});
        }
    }
    return places;
}

void build_clusters(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const ParticleSet& set = patient.particles;
    ClusterSet& clusters = patient.clusters;
    const float size = anatomy.scale() / millimetre;
    const float coarse = settings.spacing * size;
    const PointGrid grid(set.rest, 2.0f * coarse);
    clusters.first.push_back(0);
    std::vector<std::uint8_t> covered(set.size(), 0);
    const auto add = [&](const std::vector<std::uint32_t>& members, Tissue tissue) {
        const bool moves =
            std::any_of(members.begin(), members.end(), [&](auto i) { return set.mass[i] > 0.0f; });
        if (!moves || members.size() < 4) {
            return;
        }
        for (const std::uint32_t i : members) {
            covered[i] = 1;
        }
        clusters.member.insert(clusters.member.end(), members.begin(), members.end());
        clusters.first.push_back(static_cast<std::uint32_t>(clusters.member.size()));
        clusters.tissue.push_back(tissue);
    };
    // The epiglottis has clusters of its own over exactly its particles (Xiao et al. 2020, sec. 4.2), in a
    // row from stalk to tip, so that it bends. The stalk, rooted in the larynx, is also in clusters of the
    // body: its hinge.
    const auto points = anatomy.landmarks();
    const Vec3f stalk = at(points, Landmark::epiglottis_base);
    const Vec3f along = (at(points, Landmark::epiglottis_tip) - stalk).normalized();
    const auto is_stalk = [&](std::uint32_t i) { return of_stalk(set, i, stalk, size); };
    std::vector<std::uint32_t> epiglottis;
    std::vector<Vec3f> plate;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] == Tissue::epiglottis) {
            epiglottis.push_back(i);
            plate.push_back(set.rest[i]);
        }
    }
    // Fewer than two layers of particles do not define a rotation.
    constexpr std::size_t bends_at = 4;
    for (std::vector<std::uint32_t>& strip :
         strips(plate, along, 2.0f * settings.fine_spacing * size, bends_at + 1)) {
        std::ranges::transform(strip, strip.begin(), [&](std::uint32_t k) { return epiglottis[k]; });
        add(strip, Tissue::epiglottis);
    }

    const auto gather = [&](std::uint32_t centre, float radius) {
        const int family = family_of(set.tissue[centre]);
        std::vector<std::uint32_t> members;
        grid.within(set.rest[centre], radius, [&](std::uint32_t i, float) {
            if (family_of(set.tissue[i]) == family || (family == 0 && is_stalk(i))) {
                members.push_back(i);
            }
        });
        std::sort(members.begin(), members.end());
        return members;
    };
    // Centres on every second lattice point, radius two spacings: about 33 members, 4 clusters per particle.
    const auto lattice = [](float x, float spacing) {
        return static_cast<int>(std::floor(x / spacing + 0.25f));
    };
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] == Tissue::epiglottis) {
            continue;
        }
        const float spacing = 2.0f * set.radius[i];
        const Vec3f& p = set.rest[i];
        if (((lattice(p.x(), spacing) | lattice(p.y(), spacing) | lattice(p.z(), spacing)) & 1) == 0) {
            add(gather(i, 2.01f * spacing), set.tissue[i]);
        }
    }
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (covered[i] == 0 && set.mass[i] > 0.0f) {
            const float spacing = 2.0f * set.radius[i];
            add(gather(i, 2.01f * spacing), set.tissue[i]);
            if (covered[i] == 0) {
                add(gather(i, 3.5f * spacing), set.tissue[i]);
            }
        }
    }
    // A large tongue may leave no cluster's centre near enough to the stalk: the hinge then gets one of its
    // own.
    const bool hinged =
        std::ranges::any_of(std::views::iota(std::size_t{0}, clusters.size()), [&](std::size_t c) {
            return clusters.tissue[c] != Tissue::epiglottis &&
                   std::ranges::any_of(clusters.members(c), is_stalk);
        });
    for (float reach = 2.0f * coarse; !hinged && reach < 6.0f * coarse; reach += 0.5f * coarse) {
        std::vector<std::uint32_t> members;
        std::size_t body = 0;
        grid.within(stalk, reach, [&](std::uint32_t i, float) {
            if (family_of(set.tissue[i]) == 0 || is_stalk(i)) {
                members.push_back(i);
                body += is_stalk(i) ? 0 : 1;
            }
        });
        if (body >= 6) {
            std::sort(members.begin(), members.end());
            add(members, Tissue::larynx);
            break;
        }
    }
}

void build_links(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const ParticleSet& set = patient.particles;
    const float size = anatomy.scale() / millimetre;
    const float spacing = settings.spacing * size;
    const PointGrid grid(set.rest, 2.0f * spacing);
    // Where the tongue's underside is attached to the floor of the mouth, it is outside the cavity.
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] != Tissue::tongue || anatomy.fields(set.rest[i]).cavity < -0.3f * spacing) {
            continue;
        }
        grid.within(set.rest[i], 1.5f * spacing, [&](std::uint32_t k, float) {
            if (family_of(set.tissue[k]) == 0 && set.tissue[k] != Tissue::palate &&
                set.tissue[k] != Tissue::upper_gum) {
                patient.links.ends.push_back({i, k});
            }
        });
    }
    // Hyoepiglottic ligament: from the midline of the epiglottis's lower half to the tongue's root anterior
    // to it. A blade in the vallecula pulls on it and so lifts the epiglottis.
    const auto points = anatomy.landmarks();
    const Vec3f base = at(points, Landmark::epiglottis_base);
    const Vec3f axis = at(points, Landmark::epiglottis_tip) - base;
    const float reach =
        std::max(5.0e-3f * size, 2.0f * spacing);  // across the vallecula, on coarse lattices too
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] != Tissue::epiglottis || std::fabs(set.rest[i].x()) > 3.0e-3f * size) {
            continue;
        }
        const float along = (set.rest[i] - base).dot(axis) / axis.squaredNorm();
        if (along < 0.1f || along > 0.6f) {
            continue;
        }
        grid.within(set.rest[i], reach, [&](std::uint32_t k, float) {
            if (set.tissue[k] == Tissue::tongue && std::fabs(set.rest[k].x()) < 3.0e-3f * size) {
                patient.links.ends.push_back({i, k});
            }
        });
    }
    // Aryepiglottic folds start at the plate's edges, above its stalk.
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] != Tissue::epiglottis || of_stalk(set, i, base, size)) {
            continue;
        }
        grid.within(set.rest[i], 1.5f * settings.fine_spacing * size, [&](std::uint32_t k, float) {
            if (set.tissue[k] == Tissue::larynx && set.mass[k] > 0.0f) {
                patient.links.ends.push_back({i, k});
            }
        });
    }
}

}  // namespace eti::patient
