// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/check_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/math/units.hpp"
#include "server/patient/newborn/body/body_shape.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/dimensions.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {
namespace {

constexpr BuildSettings coarse{
    .spacing = 3.0e-3f, .fine_spacing = 1.5e-3f, .surface_spacing = 2.0e-3f, .body_triangles = 18000};

const Patient& newborn() {
    static const Patient patient = build_patient(NewbornShape(), coarse);
    return patient;
}

std::string faults(const Patient& patient) {
    std::string all;
    for (const Invariant& i : check_model(patient)) {
        if (!i.holds) {
            all += i.name + ": " + i.found + "\n";
        }
    }
    return all;
}

/// The model corrupted by `spoil` has a fault with that name.
template <class Spoil>
void expect_fault(const char* named, const Spoil& spoil) {
    Patient patient = newborn();
    spoil(patient);
    EXPECT_NE(faults(patient).find(named), std::string::npos) << named << " not among:\n" << faults(patient);
}

std::uint32_t first_of(const Patient& patient, Tissue tissue) {
    return static_cast<std::uint32_t>(std::ranges::find(patient.particles.tissue, tissue) -
                                      patient.particles.tissue.begin());
}

/// Valid, and with the published head size for its age.
void expect_newborn_of(float weight) {
    NewbornShape shape;
    shape.weight = weight;
    shape.gestational_age = median_gestational_age(weight);
    const Patient patient = build_patient(shape, coarse);
    EXPECT_EQ(faults(patient), "") << weight << " kg";
    const Dimension head = measure(patient, shape.gestational_age).front();
    EXPECT_TRUE(head.within()) << weight << " kg: " << head.value << " cm, published " << head.low << " to "
                               << head.high;
}

TEST(CheckModel, NewbornsAreSound) {
    EXPECT_EQ(faults(newborn()), "");
    expect_newborn_of(0.7f);
}

TEST(WholeCheckModel, NewbornsOfAllSizesAndVariantsAreSound) {
    for (const float weight : {0.5f, 1.5f, 4.5f}) {
        expect_newborn_of(weight);
    }
    for (std::size_t k = 1; k < airway_variant_names.size(); ++k) {
        NewbornShape shape;
        apply(static_cast<AirwayVariant>(k), shape);
        EXPECT_EQ(faults(build_patient(shape, coarse)), "") << airway_variant_names[k];
    }
}

// A large tongue touches the palate; it is not attached there.
TEST(BuildPatient, TongueIsFixedOnlyToMandible) {
    const NewbornShape shape{.tongue_scale = 1.3f};
    const Patient bare;  // without surfaces, which are not needed here
    const Patient patient = build_patient(shape, coarse, &bare);
    const Newborn form(shape);
    const ParticleSet& set = patient.particles;
    int at_the_palate = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] != Tissue::tongue) {
            continue;
        }
        const Fields f = form.fields(set.rest[i]);
        const float near = 1.4f * set.radius[i];
        if (set.mass[i] == 0.0f) {
            EXPECT_LT(f.mandible, near);
        } else if (f.skull < near) {
            ++at_the_palate;
        }
    }
    EXPECT_GT(at_the_palate, 20);
}

TEST(CheckModel, FindsHolesAndCrossings) {
    expect_fault("surface 'tongue'", [](Patient& p) { p.surfaces[1].mesh.triangles.pop_back(); });
    expect_fault("surface 'mandible'", [](Patient& p) {
        std::swap(p.surfaces[4].mesh.triangles[7][0], p.surfaces[4].mesh.triangles[7][1]);
    });
    expect_fault("the offset shell", [](Patient& p) { p.shell.mesh.triangles.pop_back(); });
    expect_fault("the only path out of the mouth leads between the gums", [](Patient& p) {
        // As wide as a tube, through the floor of the mouth.
        DistanceGrid& grid = p.shell.distance;
        for (int z = 0; z < grid.size[2]; ++z) {
            for (int y = 0; y < grid.size[1]; ++y) {
                for (int x = 0; x < grid.size[0]; ++x) {
                    const Vec3f node = grid.node(x, y, z);
                    if (std::hypot(node.x(), node.y() - 15e-3f) < 2e-3f && node.z() < 0.0f) {
                        grid.value[grid.index(x, y, z)] = 2e-3f;
                    }
                }
            }
        }
    });
}

TEST(CheckModel, FindsForeignEpiglottisClusters) {
    // Xiao et al. 2020, Fig. 5: a cluster of the tongue that holds a particle of the plate's free end.
    expect_fault("other clusters contain only its stalk", [](Patient& p) {
        const Vec3f tip = p.landmarks[static_cast<std::size_t>(Landmark::epiglottis_tip)].rest;
        std::uint32_t nearest = first_of(p, Tissue::epiglottis);
        for (std::uint32_t i = 0; i < p.particles.size(); ++i) {
            if (p.particles.tissue[i] == Tissue::epiglottis &&
                (p.particles.rest[i] - tip).norm() < (p.particles.rest[nearest] - tip).norm()) {
                nearest = i;
            }
        }
        const auto last = std::ranges::find(p.clusters.tissue, Tissue::tongue) - p.clusters.tissue.begin();
        p.clusters.member[p.clusters.first[static_cast<std::size_t>(last)]] = nearest;
    });
    expect_fault("clusters over exactly its particles", [](Patient& p) {
        p.clusters.tissue[0] =
            p.clusters.tissue[0] == Tissue::epiglottis ? Tissue::tongue : Tissue::epiglottis;
    });
    expect_fault("only its own clusters move its skin", [](Patient& p) {
        p.surfaces[2].skin[5] = {{static_cast<std::uint16_t>(bone_count + p.clusters.size() - 1)}, {1.0f}};
    });
}

TEST(CheckModel, FindsDistantSkinBoundToEpiglottis) {
    expect_fault("no skin far from it", [](Patient& p) {
        const auto plate =
            std::ranges::find(p.clusters.tissue, Tissue::epiglottis) - p.clusters.tissue.begin();
        const Vec3f& gum = p.landmarks[static_cast<std::size_t>(Landmark::upper_gum)].rest;
        Surface& body = p.surfaces[0];
        const auto near_gum = std::ranges::find_if(body.mesh.vertices,
                                                   [&](const Vec3f& v) { return (v - gum).norm() < 10e-3f; });
        body.skin[static_cast<std::size_t>(near_gum - body.mesh.vertices.begin())] = {
            {static_cast<std::uint16_t>(bone_count + static_cast<std::size_t>(plate))}, {1.0f}};
    });
}

// Folds of the body's surface reach the plate and follow it there (docs/decisions/epiglottis.md).
TEST(BuildPatient, FoldsAreSkinnedToEpiglottis) {
    const Patient& patient = newborn();
    int wholly = 0, partly = 0;
    for (const SkinWeights& skin : patient.surfaces[0].skin) {
        float weight = 0.0f;
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            const std::size_t frame = skin.frame[k];
            if (frame >= bone_count && frame < bone_count + patient.clusters.size() &&
                patient.clusters.tissue[frame - bone_count] == Tissue::epiglottis) {
                weight += skin.weight[k];
            }
        }
        wholly += weight > 0.8f ? 1 : 0;
        partly += weight > 0.05f && weight < 0.8f ? 1 : 0;
    }
    EXPECT_GT(wholly, 10);
    EXPECT_GT(partly, 40);
}

TEST(CheckModel, FindsLooseTissueAndMissingLigaments) {
    expect_fault("each moving particle is in a cluster", [](Patient& p) {
        p.particles.rest.emplace_back(0.0f, 0.02f, 0.0f);
        p.particles.mass.push_back(1e-6f);
        p.particles.radius.push_back(1e-3f);
        p.particles.tissue.push_back(Tissue::soft);
        p.particles.bones.push_back({1, 0, 0});
    });
    expect_fault("each moving particle is connected to bone", [](Patient& p) {
        for (float& m : p.particles.mass) {
            m = 1e-6f;
        }
    });
    expect_fault("the hyoepiglottic ligament", [](Patient& p) { p.links = {}; });
    expect_fault("aryepiglottic folds", [](Patient& p) {
        // On one side they are cut.
        std::erase_if(p.links.ends, [&](const auto& ends) {
            return p.particles.rest[ends[0]].x() > 0.0f &&
                   std::ranges::any_of(ends, [&](auto i) { return p.particles.tissue[i] == Tissue::larynx; });
        });
        p.links.stiffness.resize(p.links.ends.size());
    });
    expect_fault("attached to the floor of the mouth", [](Patient& p) { p.links = {}; });
}

TEST(CheckModel, FindsWrongWeightsFramesDistancesAndLandmarks) {
    expect_fault("weights sum to one", [](Patient& p) { p.surfaces[0].skin[9].weight[0] += 0.01f; });
    expect_fault("weights sum to one", [](Patient& p) { p.particles.bones[9] = {0.5f, 0.4f, 0.0f}; });
    expect_fault("frames are at", [](Patient& p) { p.frame_rest_centre[bone_count].x() += 1e-4f; });
    expect_fault("they have the mesh's sign", [](Patient& p) {
        float& deep = *std::ranges::min_element(p.shell.distance.value);
        deep = -deep;
    });
    expect_fault("the shell lies inside tissue or mandible", [](Patient& p) {
        p.shell.mesh.vertices[7] =
            p.landmarks[static_cast<std::size_t>(Landmark::tongue_dorsum)].rest - Vec3f(0, 0, 5e-3f);
    });
    expect_fault("distances are zero on its mesh", [](Patient& p) {
        for (float& d : p.shell.distance.value) {
            d -= 4e-3f;
        }
    });
    expect_fault("tetrahedra have volume",
                 [](Patient& p) { p.tetrahedra.corners[3][1] = p.tetrahedra.corners[3][0]; });
    expect_fault("landmarks are in anatomical order", [](Patient& p) {
        std::swap(p.landmarks[static_cast<std::size_t>(Landmark::glottis)],
                  p.landmarks[static_cast<std::size_t>(Landmark::carina)]);
    });
    expect_fault("the glottis is open", [](Patient& p) {
        for (CarriedPoint& point : p.glottis_contour) {
            point.rest = p.landmarks[static_cast<std::size_t>(Landmark::glottis)].rest;
        }
    });
    expect_fault("keep out of bone", [](Patient& p) {
        p.particles.rest[0] = {33.0e-3f, 49.3e-3f, 22.4e-3f};  // the petrous bone
    });
}

TEST(Dimensions, TermNewbornMatchesDesignValues) {
    const auto list = measure(newborn(), 40.0f);
    const auto value = [&](const char* name) {
        const auto it = std::ranges::find(list, std::string(name), &Dimension::name);
        EXPECT_NE(it, list.end()) << name;
        return it == list.end() ? 0.0 : it->value;
    };
    // From the implicit functions: the trachea's duct has semi-axes 2.6 and 2.5 mm, the cords lie 50.3 mm
    // above the carina; tolerances are half the coarse surface's spacing.
    EXPECT_NEAR(value("vocal cords to carina"), 50.3, 0.2);
    EXPECT_NEAR(value("trachea, diameter"), 5.1, 1.0);
    // A circle of 4.8 mm, 1 mm less for the coarse surface's corners and half as much more.
    EXPECT_GT(value("cricoid, area of the lumen"), 11.0);
    EXPECT_LT(value("cricoid, area of the lumen"), 22.0);
    EXPECT_NEAR(value("glottis, length"), 5.5, 0.1);
    // Keen & Pearce 1988 have 35.0 +- 1.1 cm for the mean at term. Without a body's data the cranium is an
    // ellipse of 47 by 58 mm: Ramanujan's perimeter 330.7 mm, skin and brow added.
    EXPECT_NEAR(value("head circumference"), BodyShape::is_available() ? 35.2 : 33.1, 1.0);
}

TEST(Dimensions, HeadElevationAlignsOralAndLaryngealAxes) {
    const Alignment axes = align_axes(newborn(), 29.0f * degree);
    // As measured in people: the mouth's axis and the line of sight approach the larynx's, the pharynx's
    // hardly changes (Adnet et al. 2001; Vialet et al. 2008 in infants).
    EXPECT_LT(axes.angles.mouth_pharynx, axes.angles_at_rest.mouth_pharynx - 15.0f * degree);
    EXPECT_LT(axes.angles.sight_larynx, axes.angles_at_rest.sight_larynx - 10.0f * degree);
    EXPECT_GE(axes.angles.pharynx_larynx, axes.angles_at_rest.pharynx_larynx);
    EXPECT_GT(axes.head_elevation, 15.0f * degree);
}

}  // namespace
}  // namespace eti::patient
