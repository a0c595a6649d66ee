// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/labelled_anatomy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/segmentation/grids/label_distance.hpp"

namespace eti::segmentation {

namespace {

using imaging::Bits;
using patient::Fields;

// [m], grids for outline and bone, and for the airway; finer ones cost time and show nothing more of a
// newborn.
constexpr double coarse_label_spacing = 1.0e-3;
constexpr double finest = 0.5e-3;
// [m], largest mean distance between a newborn's surfaces and the labels for a registration to be accepted.
constexpr double max_off = 4e-3;

patient::Newborn newborn_of(const Registration& found) {
    NewbornShape shape;
    shape.weight = found.weight;
    shape.gestational_age = median_gestational_age(found.weight);
    return patient::Newborn(shape);
}

Registration checked(const Registration& found) {
    const ShapeField& weight = shape_fields[0];
    if (found.off > max_off) {
        throw imaging::VolumeError(
            fmt::format("a newborn's airway and jaw differ from the labels' by {:.1f} mm on average; "
                        "expected at most {:.1f}. Remedy: check that the labels are numbered as in "
                        "docs/anatomy/segment.md and that left and right are not swapped",
                        1e3 * found.off, 1e3 * max_off));
    }
    if (found.weight < 0.8f * weight.low || found.weight > 1.5f * weight.high) {
        throw imaging::VolumeError(
            fmt::format("the labels have the size of a newborn of {:.1f} kg; expected {:g} to {:g}. Remedy: "
                        "check the volume's "
                        "spacing; models of older patients are not built",
                        found.weight, weight.low, weight.high));
    }
    return found;
}

struct Wanted {
    DistanceGrid& to;
    Bits member;
};

void find_distances(const imaging::Geometry& geometry, const std::vector<Wanted>& wanted) {
    parallel::for_each(wanted.size(), 1,
                       [&](std::size_t i) { wanted[i].to = distance_of(geometry, wanted[i].member); });
}

}  // namespace

LabelledAnatomy::LabelledAnatomy(const imaging::Mask& given_labels, const Points& given,
                                 const Progress& progress)
    : registration_(checked(register_newborn(given_labels))), newborn_(newborn_of(registration_)) {
    const auto tell = [&](float share, const char* what) {
        if (!progress(share, what)) {
            throw CancelledError();
        }
    };
    tell(0.3f, "distances to skin and bone");
    const RigidTransform back = registration_.place.inverse();
    {
        const imaging::Mask labels = upright_labels(given_labels, coarse_label_spacing);
        const imaging::Geometry& g = labels.geometry;
        Bits inside(labels.value.size());
        Bits skull(labels.value.size(), 0);
        Bits spine = select(labels, {Label::spine});
        const bool any_spine = std::find(spine.begin(), spine.end(), 1) != spine.end();
        for (std::size_t i = 0; i < inside.size(); ++i) {
            const auto label = static_cast<Label>(labels.value[i]);
            // Air in nose, mouth and throat is part of the body's outline; the cavity is subtracted later.
            inside[i] = label == Label::outside ? 0 : 1;
            if (label != Label::bone) {
                continue;
            }
            // Unnamed bone is skull, unless it is at the hyoid or is a thin vertebral arch.
            const auto [x, y, z] = g.coordinates(i);
            const Fields usual = newborn_.fields(back * g.point(x, y, z).cast<float>());
            const float near = 3e-3f * newborn_.scale() / millimetre;
            if (usual.hyoid < near && usual.hyoid < usual.skull) {
                continue;
            }
            (usual.spine < near && usual.spine < usual.skull ? spine : skull)[i] = 1;
        }
        std::vector<Wanted> wanted = {{skin_, std::move(inside)}, {skull_, std::move(skull)}};
        if (any_spine) {
            wanted.push_back({spine_.emplace(), std::move(spine)});
        } else {
            remarks_.push_back("no label of the spine: a newborn's was used");
        }
        find_distances(g, wanted);
    }
    tell(0.5f, "distances to airway, jaw and tongue");
    const float size = newborn_.scale() / millimetre;
    const auto [low, high] = newborn_.airway_bounds();
    Box part;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3f p((corner & 1) != 0 ? low.x() : high.x(), (corner & 2) != 0 ? low.y() : high.y(),
                      (corner & 4) != 0 ? low.z() : high.z());
        part.add((registration_.place * p).cast<double>());
    }
    const Vec3d room = Vec3d::Constant(static_cast<double>(12e-3f * size));
    part.low -= room;
    part.high += room;
    const imaging::Mask labels = upright_labels(given_labels, finest, &part);
    const imaging::Geometry& g = labels.geometry;
    std::vector<Wanted> wanted = {{airway_, select(labels, {Label::airway})},
                                  {mandible_, select(labels, {Label::mandible})}};
    const auto voxels = [&](Label label) {
        return std::count(labels.value.begin(), labels.value.end(), value_of(label));
    };
    if (voxels(Label::tongue) > 0) {
        wanted.push_back({tongue_.emplace(), select(labels, {Label::tongue})});
    } else {
        remarks_.push_back("no label of the tongue: a newborn's was used");
    }
    // The plate is about 1.6 mm thick at term: its shape needs two voxels across it.
    const double thickness = 1.6e-3 * static_cast<double>(size);
    if (voxels(Label::epiglottis) > 0 && given_labels.geometry.spacing().maxCoeff() <= 0.5 * thickness) {
        wanted.push_back({epiglottis_.emplace(), select(labels, {Label::epiglottis})});
    } else {
        remarks_.push_back(voxels(Label::epiglottis) > 0
                               ? "the epiglottis is thinner than two voxels: a newborn's was used"
                               : "no label of the epiglottis: a newborn's was used");
    }
    find_distances(g, wanted);
    require_larynx(labels);
    place_landmarks(given);
}

void LabelledAnatomy::require_larynx(const imaging::Mask& labels) const {
    const imaging::Geometry& g = labels.geometry;
    const float size = newborn_.scale() / millimetre;
    for (const Landmark which : {Landmark::glottis, Landmark::trachea_mid}) {
        const Vec3f at_rest = newborn_.landmarks()[static_cast<std::size_t>(which)];
        const Vec3f place = registration_.place * at_rest;
        const Vec3d index = g.to_index(place.cast<double>());
        const bool in =
            g.contains(static_cast<int>(std::lround(index.x())), static_cast<int>(std::lround(index.y())),
                       static_cast<int>(std::lround(index.z())));
        if (!in || airway_.distance(place) > 3e-3f * size) {
            throw NoLarynxError(
                fmt::format("the labels show no larynx: {} would lie at ({:.0f}, {:.0f}, {:.0f}) mm, {}; "
                            "none is invented",
                            which == Landmark::glottis ? "the glottis" : "the trachea", 1e3f * place.x(),
                            1e3f * place.y(), 1e3f * place.z(),
                            in ? fmt::format("{:.0f} mm from the airway", 1e3f * airway_.distance(place))
                               : std::string("outside the volume")));
        }
    }
}

void LabelledAnatomy::place_landmarks(const Points& given) {
    landmarks_ = newborn_.landmarks();
    const RigidTransform back = registration_.place.inverse();
    for (std::size_t i = 0; i < landmark_count; ++i) {
        if (const auto it = given.find(std::string(landmark_names[i])); it != given.end()) {
            landmarks_[i] = back * it->second.front().cast<float>();
        }
    }
    // The centre of the lumen near that of the newborn: the contour starts there.
    for (const Landmark which : {Landmark::glottis, Landmark::trachea_mid, Landmark::carina}) {
        if (given.contains(std::string(landmark_names[static_cast<std::size_t>(which)]))) {
            continue;
        }
        Vec3f& place = landmarks_[static_cast<std::size_t>(which)];
        const float step = 0.5e-3f * newborn_.scale() / millimetre;
        Vec3f best = place;
        for (int y = -6; y <= 6; ++y) {
            for (int x = -4; x <= 4; ++x) {
                const Vec3f there = place + step * Vec3f(static_cast<float>(x), static_cast<float>(y), 0.0f);
                const auto off = [&](const Vec3f& p) {
                    // A displacement of a millimetre must gain at least a tenth of a millimetre of distance.
                    return fields(p).cavity + 0.1f * (p - place).norm();
                };
                if (off(there) < off(best)) {
                    best = there;
                }
            }
        }
        if (fields(best).cavity >= 0.0f) {
            throw NoLarynxError(
                fmt::format("the airway is closed at the {}; expected a lumen there. Remedy: correct "
                            "the label of the airway, or give the landmark",
                            landmark_names[static_cast<std::size_t>(which)]));
        }
        if (which != Landmark::glottis) {
            place = best;
        }
        if (which == Landmark::glottis && fields(place).cavity >= 0.0f) {
            place = best;
        }
    }
}

Fields LabelledAnatomy::fields(const Vec3f& point) const {
    Fields f;
    const Vec3f place = registration_.place * point;
    f.skin = skin_.distance(place);
    if (f.skin > 2e-3f) {
        return f;
    }
    const Fields usual = newborn_.fields(point);
    const float scale = newborn_.scale();
    f.tongue = tongue_ ? tongue_->distance(place) : usual.tongue;
    f.epiglottis = epiglottis_ ? epiglottis_->distance(place) : usual.epiglottis;
    const float away = airway_.distance(place);
    // An unlabelled plate was classified as soft tissue: it is cut out, with a margin for its position.
    const float plate = epiglottis_ ? f.epiglottis : f.epiglottis - 1.2f * scale;
    // A rim that the segmentation leaves between tongue and air belongs to the tongue, not to the body.
    const float rind = std::max({f.tongue - 2.0f * scale, -away, usual.cavity + 0.5f * scale, -plate});
    f.tongue = std::min(f.tongue, rind);
    // The cavity is as if without tongue and epiglottis: CT does not show which part of them lies in it.
    // Steeper than a distance, so that only their very surface counts as the cavity's border.
    f.cavity = std::min(away, std::max(4.0f * std::min(f.tongue, plate), usual.cavity));
    // A collapsed gullet is not air.
    const Vec3f model = newborn_.to_model(point);
    if (model.z() < -40.0f && model.y() < 1.4f + 0.19f * (model.z() + 40.0f)) {
        f.cavity = std::min(f.cavity, usual.cavity);
    }
    f.sublingual = usual.sublingual;
    f.upper_gum = usual.upper_gum;
    f.lower_gum = usual.lower_gum;
    f.palate = usual.palate;
    f.larynx = usual.larynx;
    f.cricoid = usual.cricoid;
    // Bone stays away from the lumen, as in the newborn.
    const float clear = scale - f.cavity;
    f.skull = std::max(skull_.distance(place), clear);
    f.mandible = std::max(mandible_.distance(place), clear);
    f.spine = std::max(spine_ ? spine_->distance(place) : usual.spine, clear);
    f.hyoid = std::max(usual.hyoid, clear);
    return f;
}

}  // namespace eti::segmentation
