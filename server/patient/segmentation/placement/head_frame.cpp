// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/head_frame.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "server/parallel/loops.hpp"
#include "server/patient/segmentation/placement/head_sketch.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

namespace {

using Eigen::Matrix3d;

constexpr std::size_t kinds = sketch_kinds;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Cost of a point that the volume does not cover: that of a mediocre match.
constexpr double not_shown = 0.3;

/// Mean distance of moved points from those of the same kind, in units of `cap` [m]: 0 to 1.
template <class Move>
double mean_distance(const std::vector<Vec3d>& points, const Sketch& to, std::size_t kind, double cap,
                     const Move& move) {
    if (points.empty()) {
        return 1.0;
    }
    double sum = 0.0;
    for (const Vec3d& p : points) {
        const auto i = to.at(move(p));
        sum += i && to.seen[*i] != 0 ? std::min(1.0, static_cast<double>(to.distance[kind][*i]) / cap)
                                     : not_shown;
    }
    return sum / static_cast<double>(points.size());
}

/// A plane of symmetry: normal and distance from the origin [m].
struct Plane {
    Vec3d normal = Vec3d::UnitX();
    double offset = 0.0;
    double cost = infinity;

    [[nodiscard]] Vec3d mirrored(const Vec3d& p) const { return p - 2.0 * (normal.dot(p) - offset) * normal; }
    [[nodiscard]] Vec3d nearest(const Vec3d& p) const { return p - (normal.dot(p) - offset) * normal; }
};

/// Searches for the mirror plane, and fits heads into it.
class Finder {
  public:
    Finder(const Sketch& sketch, const Vec3d& anchor, double size)
        : sketch_(sketch), anchor_(anchor), size_(size) {
        for (std::size_t k = 0; k < kinds; ++k) {
            for (const Vec3d& p : sketch.points[k]) {
                if ((p - anchor).norm() < 2.6 * size) {
                    near_[k].push_back(p);
                }
            }
        }
    }

    /// The planes of best symmetry, at least 25 degrees apart, best first.
    [[nodiscard]] std::vector<Plane> planes(std::size_t most) const {
        const std::vector<Vec3d> all = directions(1600);  // 5 degrees apart; one of each pair of opposites
        std::vector<Plane> tried(all.size());
        parallel::for_each(all.size(), 16, [&](std::size_t i) {
            tried[i].normal = all[i];
            if (all[i].z() < -0.03) {
                return;
            }
            for (const double off : {-0.08, 0.0, 0.08}) {
                const Plane plane = judged({all[i], all[i].dot(anchor_) + off * size_, 0.0});
                tried[i] = plane.cost < tried[i].cost ? plane : tried[i];
            }
        });
        std::sort(tried.begin(), tried.end(), [](const Plane& a, const Plane& b) { return a.cost < b.cost; });
        std::vector<Plane> best;
        for (const Plane& plane : tried) {
            const bool apart = std::none_of(best.begin(), best.end(), [&](const Plane& b) {
                return std::fabs(b.normal.dot(plane.normal)) > std::cos(25.0 * std::numbers::pi / 180.0);
            });
            if (apart && best.size() < most && plane.cost < infinity) {
                best.push_back(plane);
            }
        }
        for (Plane& plane : best) {
            plane = refined(plane);
        }
        std::sort(best.begin(), best.end(), [](const Plane& a, const Plane& b) { return a.cost < b.cost; });
        return best;
    }

    /// A head fitted to the volume: the atlas's anchor `from` is at `centre`.
    struct Place {
        Matrix3d axes = Matrix3d::Identity();
        Vec3d centre = Vec3d::Zero();
        double scale = 1.0;
        double cost = infinity;
        const Atlas* atlas = nullptr;
        Vec3d from = Vec3d::Zero();

        /// Position of a point of the atlas in the volume.
        [[nodiscard]] Vec3d of(const Vec3d& p) const { return centre + scale * (axes * (p - from)); }
    };
    [[nodiscard]] Place judged(Place place) const {
        const double cap = 0.3 * place.scale * place.atlas->cranium.radius;
        double cost = 0.0;
        for (std::size_t k = 0; k < kinds; ++k) {
            cost += mean_distance(place.atlas->sketch.points[k], sketch_, k, cap,
                                  [&](const Vec3d& p) { return place.of(p); });
            cost += mean_distance(near_[k], place.atlas->sketch, k, cap / place.scale, [&](const Vec3d& p) {
                return Vec3d(place.from + place.axes.transpose() * (p - place.centre) / place.scale);
            });
        }
        place.cost = cost / (2.0 * kinds);
        return place;
    }
    /// Refines tilt, position in the plane and scale, but not the plane.
    [[nodiscard]] Place refined(Place best) const {
        double step = 1.0;
        while (step > 0.1) {
            bool better = false;
            for (int way = 0; way < 8; ++way) {
                Place next = best;
                const double by = (way % 2 == 0 ? 1.0 : -1.0) * step;
                switch (way / 2) {
                    case 0:
                        next.axes =
                            best.axes * Eigen::AngleAxisd(0.12 * by, Vec3d::UnitX()).toRotationMatrix();
                        break;
                    case 1:
                        next.centre += 0.08 * by * size_ * best.axes.col(1);
                        break;
                    case 2:
                        next.centre += 0.08 * by * size_ * best.axes.col(2);
                        break;
                    default:
                        next.scale *= std::exp(0.08 * by);
                }
                next = judged(next);
                if (next.cost < best.cost) {
                    best = next;
                    better = true;
                }
            }
            step *= better ? 1.0 : 0.5;
        }
        return best;
    }
    /// Cost of the plane into which a head was fitted.
    [[nodiscard]] double asymmetry(const Place& place) const {
        const Vec3d normal = place.axes.col(0);
        return judged({normal, normal.dot(place.centre), 0.0}).cost;
    }

  private:
    [[nodiscard]] Plane judged(Plane plane) const {
        const double cap = 0.25 * size_;
        plane.cost = 0.0;
        for (std::size_t k = 0; k < kinds; ++k) {
            plane.cost +=
                mean_distance(near_[k], sketch_, k, cap, [&](const Vec3d& p) { return plane.mirrored(p); }) /
                kinds;
        }
        return plane;
    }
    [[nodiscard]] Plane refined(Plane best) const {
        double step = 1.0;
        while (step > 0.06) {
            bool better = false;
            const Vec3d side = best.normal.unitOrthogonal();
            const Vec3d other = best.normal.cross(side);
            for (int way = 0; way < 6; ++way) {
                const double by = (way % 2 == 0 ? 1.0 : -1.0) * step;
                Plane next = best;
                if (way < 4) {
                    // About the anchor, so that it stays in the plane.
                    next.normal = (best.normal + 0.06 * by * (way < 2 ? side : other)).normalized();
                    next.offset += (next.normal - best.normal).dot(anchor_);
                } else {
                    next.offset += 0.04 * by * size_;
                }
                next = judged(next);
                if (next.cost < best.cost) {
                    best = next;
                    better = true;
                    break;
                }
            }
            step *= better ? 1.0 : 0.5;
        }
        return best;
    }

    const Sketch& sketch_;
    Vec3d anchor_;
    double size_;
    std::array<std::vector<Vec3d>, kinds> near_;
};

double angle_between(const Matrix3d& a, const Matrix3d& b) {
    return Eigen::AngleAxisd(Matrix3d(a.transpose() * b)).angle();
}

constexpr double ball_share = 0.36;  // radius of the cranium's ball over across(), in a newborn

/// Fits the atlases' heads in all tilts within the planes, and refines the best of those that are well apart;
/// best first.
std::vector<Finder::Place> lay(const Finder& finder, const std::vector<Plane>& planes,
                               const std::array<Atlas, 2>& atlases, const Vec3d& anchor, double size,
                               bool vault) {
    // Without a vault the size is estimated from the patient's volume.
    const std::vector<double> scales =
        vault ? std::vector{0.85, 1.0, 1.2} : std::vector{0.7, 0.9, 1.1, 1.35, 1.7};
    constexpr int tilts = 24;
    std::vector<Finder::Place> places;
    for (const Plane& plane : planes) {
        const Vec3d up = plane.normal.unitOrthogonal();
        for (int turn = 0; turn < 2 * tilts; ++turn) {
            Finder::Place place;
            place.axes.col(0) = turn < tilts ? plane.normal : Vec3d(-plane.normal);
            place.axes.col(2) = Eigen::AngleAxisd(2.0 * std::numbers::pi * turn / tilts, plane.normal) * up;
            place.axes.col(1) = place.axes.col(2).cross(place.axes.col(0));
            place.centre = plane.nearest(anchor);
            for (const Atlas& atlas : atlases) {
                place.atlas = &atlas;
                place.from = vault ? atlas.cranium.centre : atlas.airway;
                for (const double scale : scales) {
                    place.scale = scale * size / atlas.cranium.radius;
                    places.push_back(place);
                }
            }
        }
    }
    const auto better = [](const auto& a, const auto& b) { return a.cost < b.cost; };
    parallel::for_each(places.size(), 8, [&](std::size_t i) { places[i] = finder.judged(places[i]); });
    std::stable_sort(places.begin(), places.end(), better);
    constexpr double apart = 27.0 * std::numbers::pi / 180.0;
    std::vector<Finder::Place> best;
    for (const Finder::Place& place : places) {
        if (best.size() < 8 && std::none_of(best.begin(), best.end(), [&](const Finder::Place& b) {
                return angle_between(b.axes, place.axes) < apart;
            })) {
            best.push_back(place);
        }
    }
    parallel::for_each(best.size(), 1, [&](std::size_t i) { best[i] = finder.refined(best[i]); });
    std::stable_sort(best.begin(), best.end(), better);
    return best;
}

// Phantoms differ from their mirror image by up to 0.07, an adult's CT by 0.10; half a head and boxes by
// 0.33.
constexpr double max_asymmetry = 0.25;
// Phantoms differ from the newborn by 0.25, an adult's CT by 0.43; a hollow ball of bone by 0.50.
constexpr double max_misfit_with_vault = 0.46;
// Without a vault there is less information: phantoms differ by 0.12, a neck alone by 0.30, noise by 0.35.
constexpr double max_misfit_without = 0.25;
constexpr std::string_view remedy =
    "Remedy: use a CT of head and neck with both halves and the cranium; or place the points mouth, "
    "mandible, skull, spine and tongue manually (--landmarks).";

}  // namespace

double HeadFrame::turn() const {
    return angle_between(axes, Matrix3d::Identity());
}

HeadFrame find_head(const imaging::Volume& volume, const SegmentSettings& settings) {
    const Sketch sketch = sketch_volume(volume, settings);
    const std::optional<Ball> cranium = find_cranium(sketch);
    // A term newborn's head, and one whose cranium is small relative to its face, like an older child's.
    static const std::array<Atlas, 2> atlases = {make_atlas(1.0f), make_atlas(0.7f)};
    const Vec3d anchor = cranium ? cranium->centre : mean_of(sketch.points[1]);
    const double size = cranium ? cranium->radius : ball_share * sketch.across();
    const Finder finder(sketch, anchor, size);
    const std::vector<Plane> planes = finder.planes(4);
    const std::vector<Finder::Place> places = lay(finder, planes, atlases, anchor, size, cranium.has_value());
    if (places.empty()) {
        throw imaging::VolumeError("the volume shows no head: no air and no bone. " + std::string(remedy));
    }

    const Finder::Place& best = places.front();
    HeadFrame frame;
    frame.axes = best.axes;
    frame.centre = best.of(best.atlas->cranium.centre);
    frame.size = best.scale * best.atlas->cranium.radius;
    frame.vault = cranium.has_value();
    frame.misfit = best.cost;
    frame.asymmetry = finder.asymmetry(best);
    const double max_misfit = frame.vault ? max_misfit_with_vault : max_misfit_without;
    if (frame.asymmetry > max_asymmetry || frame.misfit > max_misfit) {
        throw imaging::VolumeError(fmt::format(
            "the volume shows no head: {}; bone, air and skin differ from their mirror image by {:.2f} and "
            "from "
            "a head by {:.2f}; expected at most {:.2f} and {:.2f} (0: alike, 1: nothing in common). {}",
            frame.vault ? fmt::format("bone surrounds a ball of {:.0f} mm", 2e3 * size)
                        : "nothing in it is a cranium",
            frame.asymmetry, frame.misfit, max_asymmetry, max_misfit, remedy));
    }
    return frame;
}

}  // namespace eti::segmentation
