// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/dimensions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/units.hpp"
#include "common/model/landmark.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/tools/tools.hpp"
#include "server/patient/model/skeleton.hpp"

namespace eti::patient {

namespace {

/// A landmark in a posture, with frames moved by their bones.
Vec3f posed_landmark(const Patient& patient, Landmark which, const BonePoses& bones) {
    const CarriedPoint& point = patient.landmarks[static_cast<std::size_t>(which)];
    const std::vector<BoneWeights> of_frame = frame_bones(patient);
    BoneWeights weights{};
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        for (std::size_t b = 0; b < bone_count; ++b) {
            weights[b] += point.skin.weight[k] * of_frame[point.skin.frame[k]][b];
        }
    }
    return pose_point(point.rest, weights, bones);
}

/// Perimeter [m] of the convex hull of points in a plane (Andrew's monotone chain).
double hull_perimeter(std::vector<Eigen::Vector2f> points) {
    std::ranges::sort(
        points, [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    std::vector<Eigen::Vector2f> hull;
    const auto turns_left = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x() > 0.0f;
    };
    for (int side = 0; side < 2; ++side) {
        const std::size_t base = hull.size();
        for (const Eigen::Vector2f& p : points) {
            while (hull.size() >= base + 2 && !turns_left(hull[hull.size() - 2], hull.back(), p)) {
                hull.pop_back();
            }
            hull.push_back(p);
        }
        hull.pop_back();
        std::ranges::reverse(points);
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        sum += static_cast<double>((hull[i] - hull[(i + 1) % hull.size()]).norm());
    }
    return sum;
}

/// Intersections of a mesh's edges with the plane z = `height`.
std::vector<Eigen::Vector2f> cut(const TriangleMesh& mesh, float height) {
    std::vector<Eigen::Vector2f> points;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f& a = mesh.vertices[t[k]];
            const Vec3f& b = mesh.vertices[t[(k + 1) % 3]];
            if ((a.z() < height) != (b.z() < height)) {
                const float s = (height - a.z()) / (b.z() - a.z());
                points.emplace_back(a.x() + s * (b.x() - a.x()), a.y() + s * (b.y() - a.y()));
            }
        }
    }
    return points;
}

/// Greatest circumference [m] of horizontal sections of the head above the ears.
double head_circumference(const Patient& patient, float size) {
    constexpr float above_ears = 46e-3f;  // from the gum
    const auto body = std::ranges::find(patient.surfaces, "body", &Surface::name);
    double greatest = 0.0;
    if (body != patient.surfaces.end()) {
        for (float height = above_ears * size; height < 90e-3f; height += 2e-3f) {
            const auto section = cut(body->mesh, height);
            if (section.size() > 8) {
                greatest = std::max(greatest, hull_perimeter(section));
            }
        }
    }
    return greatest;
}

struct Jaw {
    double gonial_width = 0.0;  // [m]
    double menton_to_gonia = 0.0;
};

/// Gonia: the most posterior-inferior point of each side; menton: the chin's lowest point.
Jaw measure_jaw(const Patient& patient) {
    const auto bone = std::ranges::find(patient.surfaces, "mandible", &Surface::name);
    if (bone == patient.surfaces.end()) {
        return {};
    }
    std::array<Vec3f, 2> gonion{};
    std::array<float, 2> best{-1.0f, -1.0f};
    const Vec3f downwards_back = Vec3f(0.0f, 1.0f, -1.0f).normalized();
    Vec3f menton = Vec3f::Constant(1.0f);
    std::array<float, 2> side{};
    for (const Vec3f& v : bone->mesh.vertices) {
        const std::size_t s = v.x() > 0.0f ? 1 : 0;
        if (const float far = v.dot(downwards_back) + 1.0f; far > best[s]) {
            best[s] = far;
            gonion[s] = v;
        }
        if (std::fabs(v.x()) < 5e-3f && v.z() < menton.z()) {
            menton = v;
        }
    }
    // Width between the outer sides of the angles.
    for (const Vec3f& v : bone->mesh.vertices) {
        const std::size_t s = v.x() > 0.0f ? 1 : 0;
        if (std::hypot(v.y() - gonion[s].y(), v.z() - gonion[s].z()) < 5e-3f) {
            side[s] = std::max(side[s], std::fabs(v.x()));
        }
    }
    const Vec3f line = (gonion[1] - gonion[0]).normalized();
    const Vec3f to = menton - gonion[0];
    return {static_cast<double>(side[0] + side[1]), static_cast<double>((to - to.dot(line) * line).norm())};
}

/// Area [m^2] of the lumen around a point, in a horizontal section.
double lumen_area(const Patient& patient, const Vec3f& at) {
    const auto body = std::ranges::find(patient.surfaces, "body", &Surface::name);
    if (body == patient.surfaces.end()) {
        return 0.0;
    }
    std::vector<Eigen::Vector2f> wall;
    float nearest = std::numeric_limits<float>::max();
    for (const Eigen::Vector2f& p : cut(body->mesh, at.z())) {
        wall.emplace_back(p - at.head<2>());
        nearest = std::min(nearest, wall.back().norm());
    }
    // The section also cuts the gullet and the skin of the neck, which lie beyond the wall.
    std::erase_if(wall, [&](const Eigen::Vector2f& d) { return d.norm() > 1.8f * nearest; });
    std::ranges::sort(wall, {}, [](const Eigen::Vector2f& d) { return std::atan2(d.y(), d.x()); });
    double twice = 0.0;
    for (std::size_t i = 0; i < wall.size(); ++i) {
        const Eigen::Vector2f& a = wall[i];
        const Eigen::Vector2f& b = wall[(i + 1) % wall.size()];
        twice += static_cast<double>(a.x() * b.y() - a.y() * b.x());
    }
    return 0.5 * twice;
}

/// Diameter [m] of the circle with that area.
double diameter_of(double area) {
    return 2.0 * std::sqrt(area / std::numbers::pi);
}

double polygon_area(const std::vector<CarriedPoint>& contour) {
    Vec3f twice = Vec3f::Zero();
    for (std::size_t i = 0; i < contour.size(); ++i) {
        twice += contour[i].rest.cross(contour[(i + 1) % contour.size()].rest);
    }
    return 0.5 * static_cast<double>(twice.norm());
}

float angle_between(const Vec3f& a, const Vec3f& b) {
    return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0f, 1.0f));
}

AxisAngles angles(const Patient& patient, const Posture& posture) {
    const BonePoses bones = pose_bones(patient.skeleton, posture);
    const auto point = [&](Landmark which) { return posed_landmark(patient, which, bones); };
    // Adnet et al.: the mouth's axis is parallel to the hard palate, which is horizontal in the rest posture.
    const Vec3f mouth = bones[static_cast<std::size_t>(Bone::skull)].rotation * Vec3f(0.0f, 1.0f, 0.0f);
    const Vec3f larynx = point(Landmark::trachea_mid) - point(Landmark::glottis);
    // Behind the tongue: from the epiglottis's tip to the entrance of the gullet.
    const Vec3f pharynx = point(Landmark::oesophagus_inlet) - point(Landmark::epiglottis_tip);
    const Vec3f sight = point(Landmark::glottis) - point(Landmark::upper_gum);
    return {angle_between(mouth, pharynx), angle_between(pharynx, larynx), angle_between(sight, larynx)};
}

}  // namespace

Alignment align_axes(const Patient& patient, float jaw_opening) {
    Alignment best;
    best.off_line = std::numeric_limits<float>::max();
    best.angles_at_rest = angles(patient, {0.0f, jaw_opening});
    for (int tenths = 0; tenths <= 300; ++tenths) {
        const Posture posture{static_cast<float>(tenths) * 0.1f * degree, jaw_opening};
        const BonePoses bones = pose_bones(patient.skeleton, posture);
        const std::array<Vec3f, 4> points = {posed_landmark(patient, Landmark::mouth_opening, bones),
                                             posed_landmark(patient, Landmark::epiglottis_tip, bones),
                                             posed_landmark(patient, Landmark::glottis, bones),
                                             posed_landmark(patient, Landmark::trachea_mid, bones)};
        Vec3f mean = Vec3f::Zero();
        for (const Vec3f& p : points) {
            mean += 0.25f * p;
        }
        Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
        for (const Vec3f& p : points) {
            spread += 0.25f * (p - mean) * (p - mean).transpose();
        }
        // Residual of the line of largest variance.
        const Eigen::Vector3f left = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(spread).eigenvalues();
        const float off = std::sqrt(std::max(left[0] + left[1], 0.0f));
        if (off < best.off_line) {
            best.off_line = off;
            best.head_elevation = posture.head_elevation;
            best.angles = angles(patient, posture);
        }
    }
    return best;
}

std::vector<Dimension> measure(const Patient& patient, float gestational_age) {
    const float size = std::cbrt(patient.weight / 3.5f);
    const auto grown = static_cast<double>(size);
    const auto distance = [&](Landmark a, Landmark b) {
        return static_cast<double>((rest_of(patient, a) - rest_of(patient, b)).norm());
    };
    std::vector<Dimension> list;
    const HeadCircumference head = mean_head_circumference(gestational_age);
    list.push_back({"head circumference", 1e2 * head_circumference(patient, size), "cm",
                    1e2 * static_cast<double>(head.mean - 2.0f * head.deviation),
                    1e2 * static_cast<double>(head.mean + 2.0f * head.deviation),
                    "Keen & Pearce 1988, Arch Dis Child 63, for the age, 2 SD"});
    // Published values of term newborns; `power` 1 for lengths, 2 for areas.
    const auto of_term = [&](const char* name, double value, const char* unit, double low, double high,
                             int power, const std::string& source) {
        const double by = std::pow(grown, power);
        const bool other = std::abs(grown - 1.0) > 0.01;
        list.push_back(
            {name, value, unit, low * by, high * by,
             other ? source + "; of term newborns, scaled to this weight by its cube root" : source});
    };
    const Jaw jaw = measure_jaw(patient);
    of_term("mandible, between the gonia", 1e3 * jaw.gonial_width, "mm", 63.6 - 2 * 6.8, 63.6 + 2 * 6.8, 1,
            "Front Pediatr 2023;11:1172909, 2 SD");
    of_term("mandible, menton to gonial line", 1e3 * jaw.menton_to_gonia, "mm", 32.0 - 2 * 3.7,
            32.0 + 2 * 3.7, 1, "Front Pediatr 2023;11:1172909, 2 SD");
    const BonePoses wide = pose_bones(patient.skeleton, {0.0f, max_jaw_opening});
    of_term("gums apart at 35 deg jaw opening",
            1e3 * static_cast<double>((posed_landmark(patient, Landmark::upper_gum, wide) -
                                       posed_landmark(patient, Landmark::lower_gum, wide))
                                          .norm()),
            "mm", 20.4, 23.6, 1,
            "maximal opening under one month, Front Pediatr 2023;11:1172909, 95 % CI of the mean");
    of_term("glottis, length", 1e3 * distance(Landmark::glottis_anterior, Landmark::glottis_posterior), "mm",
            4.2, 6.6, 1, "Sato 2015, Laryngoscope 125:E186, 2 SD");
    of_term("glottis, area", 1e6 * polygon_area(patient.glottis_contour), "mm^2", 7.5, 8.2, 2,
            "Sato 2015, means of girls and boys at rest; the model's cords are abducted as in inspiration");
    of_term("vocal cords to carina", 1e3 * distance(Landmark::glottis, Landmark::carina), "mm", 0.95 * 50.4,
            1.05 * 53.0, 1, "Ann Otol Rhinol Laryngol 2001;110:268 and Anesth Analg Aug 2013, means, 5 %");
    const Vec3f below =
        rest_of(patient, Landmark::glottis) +
        0.2f * (rest_of(patient, Landmark::trachea_mid) - rest_of(patient, Landmark::glottis));
    const double subglottis = lumen_area(patient, below);
    of_term("subglottis, diameter", 1e3 * diameter_of(subglottis), "mm", 4.5, 5.0, 1,
            "no published range available; textbook value");
    // Pooled over all weights from the fifth month to birth, hence not scaled to one weight.
    list.push_back({"cricoid, area of the lumen", 1e6 * subglottis, "mm^2", 19.27 - 9.62, 19.27 + 9.62,
                    "19 stillborn and newborn of 5-9 months, Ann Otol Rhinol Laryngol 2008;117:774, 1 SD"});
    of_term("trachea, diameter",
            1e3 * diameter_of(lumen_area(patient, rest_of(patient, Landmark::trachea_mid))), "mm", 4.5, 5.5,
            1, "no published range available; textbook value");
    const BonePoses ready = pose_bones(patient.skeleton, {26.0f * degree, 29.0f * degree});
    const double to_glottis = static_cast<double>((posed_landmark(patient, Landmark::mouth_opening, ready) -
                                                   posed_landmark(patient, Landmark::glottis, ready))
                                                      .norm());
    const double to_middle = to_glottis + distance(Landmark::glottis, Landmark::trachea_mid);
    const double rule = 1e2 * tube_depth_by_weight(static_cast<double>(patient.weight));
    list.push_back(
        {"lip to the trachea's middle, head raised", 1e2 * to_middle, "cm", rule - 1.0, rule + 1.0,
         "weight + 6 cm, Tochen 1979; mid-tracheal in 51 %, Peng 2020, Front Pediatr 8:367; 1 cm"});
    return list;
}

}  // namespace eti::patient
