// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/segment.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "server/patient/imaging/level_set.hpp"
#include "server/patient/imaging/resample.hpp"
#include "server/patient/mesh/components.hpp"
#include "server/patient/segmentation/grids/own_grid.hpp"
#include "server/patient/segmentation/noise.hpp"
#include "server/patient/segmentation/organ_check.hpp"
#include "server/patient/segmentation/placement/place_seeds.hpp"
#include "server/patient/segmentation/placement/volume_orientation.hpp"
#include "server/patient/segmentation/tissue_map.hpp"

namespace eti::segmentation {

namespace {

using imaging::Bits;
using imaging::Geometry;
using imaging::Size;

/// A box of voxels cut out of the volume, on which a level set runs.
class Region {
  public:
    /// The box from `low` to `high` [voxels, inclusive], clipped to the volume.
    Region(const Geometry& whole, std::array<int, 3> low, std::array<int, 3> high) : whole_(whole) {
        for (std::size_t k = 0; k < 3; ++k) {
            low_[k] = std::clamp(low[k], 0, whole.size[k] - 1);
            high[k] = std::clamp(high[k], low_[k], whole.size[k] - 1);
            size_[k] = high[k] - low_[k] + 1;
        }
    }
    /// The bounding box of a mask, extended by `margin` [voxels].
    static Region around(const Geometry& whole, const Bits& mask, int margin) {
        std::array<int, 3> low = whole.size;
        std::array<int, 3> high = {0, 0, 0};
        for (std::size_t i = 0; i < mask.size(); ++i) {
            if (mask[i] != 0) {
                const auto at = whole.coordinates(i);
                for (std::size_t k = 0; k < 3; ++k) {
                    low[k] = std::min(low[k], at[k]);
                    high[k] = std::max(high[k], at[k]);
                }
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] -= margin;
            high[k] += margin;
        }
        return {whole, low, high};
    }

    [[nodiscard]] const Size& size() const { return size_; }
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
               static_cast<std::size_t>(size_[2]);
    }
    /// Calls visit(index in the box, index in the volume) for every voxel.
    template <class Visit>
    void for_each(const Visit& visit) const {
        std::size_t i = 0;
        for (int z = 0; z < size_[2]; ++z) {
            for (int y = 0; y < size_[1]; ++y) {
                for (int x = 0; x < size_[0]; ++x) {
                    visit(i++, whole_.index(low_[0] + x, low_[1] + y, low_[2] + z));
                }
            }
        }
    }
    template <class T>
    [[nodiscard]] std::vector<T> cut(const std::vector<T>& from) const {
        std::vector<T> part(count());
        for_each([&](std::size_t i, std::size_t j) { part[i] = from[j]; });
        return part;
    }
    /// Initial distance, negative in the mask: half a voxel on either side of its border.
    [[nodiscard]] DistanceGrid start(const Bits& inside, float spacing) const {
        DistanceGrid grid;
        grid.spacing = spacing;
        grid.size = size_;
        grid.value.resize(count());
        for (std::size_t i = 0; i < grid.value.size(); ++i) {
            grid.value[i] = (inside[i] != 0 ? -0.5f : 0.5f) * spacing;
        }
        return grid;
    }

  private:
    const Geometry& whole_;
    std::array<int, 3> low_{};
    Size size_{};
};

/// A CT on an isotropic grid along LPS and the results so far.
struct Work {
    const imaging::Volume& ct;
    const SegmentSettings& settings;
    const Progress& progress;
    TissueMap map;
    std::vector<float> bone_depth;  ///< [voxels], to the nearest voxel that is not bone
    Points points;

    [[nodiscard]] float spacing() const { return static_cast<float>(ct.geometry.spacing().x()); }
    void report_progress(float share, std::string_view what) const {
        if (!progress(share, what)) {
            throw CancelledError();
        }
    }
    /// Progress callback for LevelSetSettings, by which the user can cancel.
    [[nodiscard]] auto listener(float share, std::string_view what) const {
        return [this, share, what](int) { return progress(share, what); };
    }
    [[nodiscard]] std::vector<std::size_t> voxels_of(const char* name) const {
        std::vector<std::size_t> found;
        if (const auto it = points.find(name); it != points.end()) {
            for (const Vec3d& point : it->second) {
                const Vec3d at = ct.geometry.to_index(point);
                const std::array<int, 3> i = {static_cast<int>(std::lround(at.x())),
                                              static_cast<int>(std::lround(at.y())),
                                              static_cast<int>(std::lround(at.z()))};
                if (!ct.geometry.contains(i[0], i[1], i[2])) {
                    throw imaging::VolumeError(
                        fmt::format("landmark '{}' at ({:.1f}, {:.1f}, {:.1f}) mm lies outside the volume; "
                                    "expected a point in "
                                    "the patient (LPS). Remedy: check its coordinate system.",
                                    name, 1e3 * point.x(), 1e3 * point.y(), 1e3 * point.z()));
                }
                found.push_back(ct.geometry.index(i[0], i[1], i[2]));
            }
        }
        return found;
    }
};

/// The bone voxel within 8 mm of a point, preferring near and thick ones; empty if there is none.
std::optional<std::size_t> bone_at(const Work& work, std::size_t seed) {
    const Geometry& g = work.ct.geometry;
    const auto [x, y, z] = g.coordinates(seed);
    const int reach = static_cast<int>(std::ceil(8e-3f / work.spacing()));
    int nearest = reach * reach + 1;
    std::optional<std::size_t> found;
    for (int dz = -reach; dz <= reach; ++dz) {
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                const int squared = dx * dx + dy * dy + dz * dz;
                if (squared < nearest && g.contains(x + dx, y + dy, z + dz)) {
                    const std::size_t i = g.index(x + dx, y + dy, z + dz);
                    if (work.map.bone[i] != 0) {
                        nearest = squared;
                        found = i;
                    }
                }
            }
        }
    }
    return found;
}

/// Splits bone at its necks: 1 around `seeds`, 2 around `others`. Empty if there is no neck, which is so if
/// it is nearly as thick as the bone at the seeds.
std::optional<std::vector<std::uint8_t>> part_bones(const Work& work, const std::vector<std::size_t>& seeds,
                                                    const std::vector<std::size_t>& others) {
    const Geometry& g = work.ct.geometry;
    std::vector<std::uint8_t> markers(g.count(), 0);
    const auto mark = [&](const std::vector<std::size_t>& places, std::uint8_t number) {
        float thickest = 0.0f;
        for (const std::size_t place : places) {
            if (const auto i = bone_at(work, place)) {
                markers[*i] = number;
                thickest = std::max(thickest, work.bone_depth[*i]);
            }
        }
        return thickest;
    };
    const float theirs = mark(others, 2);
    const float ours = mark(seeds, 1);
    const imaging::Watershed parts = imaging::watershed(g.size, work.map.bone, work.bone_depth, markers);
    constexpr float hardly_a_neck = 0.95f;
    if (ours == 0.0f || (theirs > 0.0f && parts.neck > hardly_a_neck * std::min(ours, theirs))) {
        return std::nullopt;
    }
    return parts.owner;
}

/// The bone of owner 1 with a smooth border: a level set that starts from all of it and converges where the
/// grey value falls or another bone begins.
Bits grow_bone(const Work& work, const std::vector<std::uint8_t>& owner, float share, std::string_view what) {
    Bits own(owner.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
        own[i] = owner[i] == 1 ? 1 : 0;
    }
    const Region region = Region::around(work.ct.geometry, own, 5);
    Bits seed(region.count());
    std::vector<float> speed(region.count());
    region.for_each([&](std::size_t i, std::size_t j) {
        seed[i] = own[j];
        // Full speed from half-way to compact bone on, and never so slow that curvature (at most 0.1)
        // dominates in a vertebral arch two voxels thick. The front is driven back from other bones.
        const float boniness = (work.ct.value[j] - work.settings.bone_above) / 150.0f;
        const auto [least, most] = own[j] != 0 ? std::pair(0.3f, 1.0f) : std::pair(-1.0f, -0.3f);
        speed[i] = owner[j] == 2 ? -1.0f : std::clamp(boniness, least, most);
    });
    const float h = work.spacing();
    const DistanceGrid front =
        imaging::evolve(region.start(seed, h), speed, {.curvature = 0.1f * h}, work.listener(share, what));
    work.report_progress(share, what);
    Bits grown(own.size(), 0);
    region.for_each([&](std::size_t i, std::size_t j) {
        // The front rounds off edges; owned voxels within one voxel of it are kept.
        grown[j] = own[j] != 0 && front.value[i] < h ? 1 : 0;
    });
    return grown;
}

/// The threshold that best separates two classes (Otsu 1979, IEEE Trans SMC 9).
float otsu(const std::vector<float>& values) {
    constexpr float low = -150.0f;
    constexpr std::size_t bins = 300;  // 1 HU each
    std::array<double, bins> histogram{};
    for (const float v : values) {
        const auto bin = static_cast<std::size_t>(std::clamp(v - low, 0.0f, static_cast<float>(bins - 1)));
        histogram[bin] += 1.0;
    }
    double total = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < bins; ++k) {
        total += histogram[k];
        sum += histogram[k] * static_cast<double>(k);
    }
    double below = 0.0;
    double sum_below = 0.0;
    double best = -1.0;
    std::size_t at = 0;
    for (std::size_t k = 0; k + 1 < bins; ++k) {
        below += histogram[k];
        sum_below += histogram[k] * static_cast<double>(k);
        if (below == 0.0 || below == total) {
            continue;
        }
        const double apart = sum_below / below - (sum - sum_below) / (total - below);
        if (const double between = below * (total - below) * apart * apart; between > best) {
            best = between;
            at = k;
        }
    }
    return low + static_cast<float>(at) + 1.0f;
}

/// Segments the tongue: the soft tissue around its seed on the same side of the grey value that best
/// separates the mouth's soft tissue. `note` receives the reason if there is none, `contrast_to_noise` see
/// Segmentation.
Bits grow_tongue(const Work& work, double jaw_depth, float noise, float& contrast_to_noise,
                 std::string& note) {
    const Geometry& g = work.ct.geometry;
    const float h = work.spacing();
    const auto voxels = [&](double metres) { return static_cast<int>(std::ceil(metres / g.spacing().x())); };
    const std::vector<std::size_t> seeds = work.voxels_of("tongue");
    std::array<int, 3> low = g.size;
    std::array<int, 3> high = {0, 0, 0};
    for (const std::size_t seed : seeds) {
        const auto at = g.coordinates(seed);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], at[k] - voxels(0.75 * jaw_depth));
            high[k] = std::max(high[k], at[k] + voxels(0.75 * jaw_depth));
        }
    }
    const Region region(g, low, high);
    const std::vector<float> grey = region.cut(work.ct.value);
    const Bits soft = region.cut(work.map.soft);
    Bits core(soft.size());  // without voxels that are partly air or bone
    for (std::size_t i = 0; i < core.size(); ++i) {
        core[i] = soft[i] != 0 && grey[i] > -150.0f && grey[i] < 150.0f ? 1 : 0;
    }
    const float sigma = std::max(1.0f, work.settings.tongue_smoothing / h);
    const std::vector<float> mean = imaging::smooth_within(region.size(), grey, core, sigma);

    std::vector<std::uint8_t> is_seed(g.count(), 0);
    for (const std::size_t s : seeds) {
        is_seed[s] = 1;
    }
    const Bits seed_bits = region.cut(is_seed);
    const std::vector<float> to_seed = imaging::distance_to(region.size(), seed_bits);
    const float radius = std::max(2.0f, static_cast<float>(0.09 * jaw_depth) / h);
    Bits ball(core.size());
    std::vector<float> sample;
    double inside = 0.0;
    std::size_t in_ball = 0;
    std::size_t soft_in_ball = 0;
    for (std::size_t i = 0; i < core.size(); ++i) {
        ball[i] = to_seed[i] <= radius && core[i] != 0 ? 1 : 0;
        in_ball += to_seed[i] <= radius ? 1 : 0;
        soft_in_ball += ball[i];
        inside += ball[i] != 0 ? static_cast<double>(mean[i]) : 0.0;
        if (core[i] != 0) {
            sample.push_back(mean[i]);
        }
    }
    if (soft_in_ball * 10 < in_ball * 9) {
        note = "its expected position is not entirely soft tissue; give a landmark 'tongue'";
        return {};
    }
    inside /= static_cast<double>(soft_in_ball);
    const float parting = otsu(sample);
    const float contrast = static_cast<float>(inside) - parting;
    if (std::fabs(contrast) < 2.0f) {
        note = fmt::format("its grey value ({:.0f} HU) equals that of its neighbours; label it manually",
                           inside);
        return {};
    }
    contrast_to_noise = std::fabs(contrast) / (noise * noise_after_smoothing(sigma));
    std::vector<float> speed(core.size());
    for (std::size_t i = 0; i < core.size(); ++i) {
        speed[i] = soft[i] != 0 ? std::clamp((mean[i] - parting) / contrast, -1.0f, 1.0f) : -1.0f;
    }
    const DistanceGrid front =
        imaging::evolve(region.start(ball, h), speed, {.curvature = work.settings.tongue_curvature},
                        work.listener(0.8f, "tongue"));
    work.report_progress(0.9f, "tongue");
    Bits tongue(g.count(), 0);
    region.for_each(
        [&](std::size_t i, std::size_t j) { tongue[j] = soft[i] != 0 && front.value[i] < 0.0f ? 1 : 0; });
    return tongue;
}

double volume_of(const Geometry& g, const Bits& bits) {
    return g.voxel_volume() * static_cast<double>(std::count(bits.begin(), bits.end(), std::uint8_t{1}));
}

/// Whether the airway extends far enough below the chin to contain larynx and trachea.
Structure look_for_larynx(const Geometry& g, const Bits& airway, const PlacedSeeds& placed) {
    Structure larynx{"larynx and trachea", false, 0.0, ""};
    double lowest = 1e9;
    for (std::size_t i = 0; i < airway.size() && lowest > 1e8; ++i) {
        if (airway[i] != 0) {
            const auto [x, y, z] = g.coordinates(i);
            lowest = g.point(x, y, z).z();  // indices increase upwards
        }
    }
    const double floor = g.origin.z();
    if (!placed.jaw_depth) {
        larynx.note = placed.no_mandible.empty() ? "the pharynx was not found"
                                                 : "not in the volume: " + placed.no_mandible;
        return larynx;
    }
    const double chin = placed.chin->z();
    const double needed = chin - 0.6 * *placed.jaw_depth;
    if (lowest > needed) {
        larynx.note = fmt::format(
            "not in the volume: the airway ends {:.0f} mm below the chin's middle, {:.0f} mm above the "
            "volume's lower "
            "face",
            1e3 * (chin - lowest), 1e3 * (lowest - floor));
        return larynx;
    }
    larynx.found = true;
    larynx.note = fmt::format("part of the airway, which extends to {:.0f} mm below the chin's middle",
                              1e3 * (chin - lowest));
    return larynx;
}

/// Distances between voxels are coarsely quantized; blurred, they distinguish narrow from wide.
std::vector<float> depth_in(const imaging::Size& size, const Bits& bone) {
    Bits no_bone(bone.size());
    for (std::size_t i = 0; i < no_bone.size(); ++i) {
        no_bone[i] = 1 - bone[i];
    }
    return imaging::smooth_within(size, imaging::distance_to(size, no_bone), bone, 0.7f);
}

/// Places seeds in the head's directions and looks for the larynx there. Points are in the grid's directions.
std::pair<PlacedSeeds, Structure> place_in_head(const Work& work, const Bits& shown,
                                                const VolumeOrientation& stand, const Points& given) {
    const Geometry& g = work.ct.geometry;
    HeadPose head = stand.place;
    head.shown = &shown;
    if (stand.residual_rotation.isIdentity(0.0)) {
        const PlacedSeeds placed = place_seeds(g, work.map, work.bone_depth, head, given);
        return {placed, look_for_larynx(g, work.map.airway, placed)};
    }
    // Nearest-neighbour rotation of masks suffices: seeds need not be exact.
    const Geometry own = imaging::upright_grid(imaging::reoriented(g, stand.residual_rotation));
    const Geometry turned_grid = imaging::reoriented(own, stand.residual_rotation.transpose());
    const auto turned_bits = [&](const Bits& bits) {
        return imaging::resample_labels(turned_grid, {g, bits}).value;
    };
    const TissueMap map{turned_bits(work.map.outside),      turned_bits(work.map.airway),
                        turned_bits(work.map.enclosed_air), turned_bits(work.map.bone),
                        turned_bits(work.map.soft),         work.map.airway_opens};
    const Bits turned_shown = turned_bits(shown);
    head.shown = &turned_shown;
    PlacedSeeds placed = place_seeds(own, map, depth_in(own.size, map.bone), head,
                                     turned(given, stand.residual_rotation.transpose()));
    Structure larynx = look_for_larynx(own, map.airway, placed);
    placed.points = turned(placed.points, stand.residual_rotation);
    return {placed, larynx};
}

/// Vertebral arches are too thin for the level set, and in a newborn are attached by cartilage, which CT does
/// not show: separate pieces of bone that start within reach of a vertebral body are assigned to the spine.
void add_arches(const Work& work, const Vec3d& up, const Bits& mandible, Bits& spine) {
    const Geometry& g = work.ct.geometry;
    Bits rest(spine.size());
    double top = -1e9;  // [m], of the spine
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const bool jaw = !mandible.empty() && mandible[i] != 0;
        rest[i] = work.map.bone[i] != 0 && spine[i] == 0 && !jaw ? 1 : 0;
        if (spine[i] != 0) {
            const auto [x, y, z] = g.coordinates(i);
            top = std::max(top, up.dot(g.point(x, y, z)));
        }
    }
    constexpr double reach = 4e-3;    // [m], from the body to the start of the arch
    constexpr double largest = 2e-6;  // [m^3], of half an arch; pieces of the skull are larger
    const Components pieces = components(g.size, rest);
    const std::vector<float> to_spine = imaging::distance_to(g.size, spine);
    std::vector<std::uint8_t> near(pieces.voxels.size(), 0);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const auto [x, y, z] = g.coordinates(i);
        if (rest[i] != 0 && static_cast<double>(to_spine[i]) * g.spacing()[0] < reach &&
            up.dot(g.point(x, y, z)) < top) {
            near[pieces.part[i]] = 1;
        }
    }
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const std::uint32_t part = pieces.part[i];
        if (rest[i] != 0 && near[part] != 0 &&
            static_cast<double>(pieces.voxels[part]) * g.voxel_volume() < largest) {
            spine[i] = 1;
        }
    }
}

constexpr std::size_t max_voxels = std::size_t{1} << 26;

}  // namespace

Segmentation segment(const imaging::Volume& volume, const Points& given, const SegmentSettings& settings,
                     const Progress& progress) {
    if (!progress(0.0f, "rotating the volume upright")) {
        throw CancelledError();
    }
    require_ct(volume, settings);
    Segmentation result;
    result.noise = estimate_noise(volume);
    const VolumeOrientation stand = orient_volume(volume, given, settings, result.contradictions);
    result.turn = stand.turn;
    const imaging::Geometry own = imaging::reoriented(volume.geometry, stand.axes);
    const imaging::Volume ct = imaging::resample_upright(volume, own, max_voxels);
    const Geometry& g = ct.geometry;
    const Bits shown = imaging::covered(g, own);
    Work work{ct, settings, progress, {}, {}, {}};
    work.report_progress(0.05f, "air, bone, soft tissue");
    work.map = map_tissues(ct, settings);
    work.report_progress(0.3f, "landmarks");
    work.bone_depth = depth_in(g.size, work.map.bone);
    const auto [placed, larynx] = place_in_head(work, shown, stand, turned(given, stand.axes.transpose()));
    work.points = placed.points;

    std::vector<Structure>& structures = result.structures;
    Bits inside(g.count());
    for (std::size_t i = 0; i < inside.size(); ++i) {
        inside[i] = 1 - work.map.outside[i];
    }
    structures.push_back({"skin", true, volume_of(g, inside), ""});
    structures.push_back({"bone", true, volume_of(g, work.map.bone), ""});
    structures.back().found = structures.back().volume > 0.0;
    structures.push_back({"airway", true, volume_of(g, work.map.airway), ""});
    structures.back().found = structures.back().volume > 0.0;
    if (structures.back().found && !work.map.airway_opens) {
        structures.back().note = "it opens neither at the nose nor at the mouth; the largest space was used";
    }
    structures.push_back(larynx);

    const std::vector<std::size_t> chin = work.voxels_of("mandible");
    const std::vector<std::size_t> skull = work.voxels_of("skull");
    const std::vector<std::size_t> spine_seeds = work.voxels_of("spine");
    // In coarser voxels a newborn's mandible merges with the skull, and the tongue with its neighbours.
    constexpr double coarsest = 0.053;  // in cranial radii: 1.9 mm at term, 3.3 mm in adults
    const double widest = volume.geometry.spacing().maxCoeff();
    const std::string too_coarse =
        stand.place.size > 0.0 && widest > coarsest * stand.place.size
            ? fmt::format(
                  "voxels of {:.1f} mm do not show it; expected at most {:.1f} mm in a head of this size",
                  1e3 * widest, 1e3 * coarsest * stand.place.size)
            : "";
    Bits mandible;
    Bits spine;
    Bits tongue;
    const auto search_bone = [&](const char* name, const std::vector<std::size_t>& seeds,
                                 std::vector<std::size_t> others, float share, const std::string& why_not) {
        work.report_progress(share, name);
        Structure found{name, false, 0.0, why_not};
        Bits bits;
        if (!seeds.empty() && !too_coarse.empty()) {
            found.note = too_coarse;
        } else if (!seeds.empty()) {
            if (const auto owner = part_bones(work, seeds, others)) {
                bits = grow_bone(work, *owner, share, name);
                found.volume = volume_of(g, bits);
                found.found = found.volume > 0.0;
                found.note.clear();
            } else {
                const bool by_hand = given.contains(name) && given.contains("skull");
                found.note = fmt::format("it could not be separated from the skull; {}",
                                         by_hand ? "no narrow bridge of bone separates the given points: "
                                                   "move them apart, or label it manually"
                                                 : fmt::format("give landmarks '{}' and 'skull'", name));
            }
        }
        structures.push_back(found);
        return bits;
    };
    std::vector<std::size_t> rest = skull;
    rest.insert(rest.end(), spine_seeds.begin(), spine_seeds.end());
    mandible = search_bone("mandible", chin, rest, 0.4f, "not in the volume: " + placed.no_mandible);
    rest = skull;
    rest.insert(rest.end(), chin.begin(), chin.end());
    spine = search_bone("spine", spine_seeds, rest, 0.6f,
                        "not in the volume: no bone behind the airway below the mouth");
    if (!spine.empty()) {
        add_arches(work, stand.residual_rotation.col(2), mandible, spine);
        structures.back().volume = volume_of(g, spine);
    }

    const OrganCheck check(imaging::reoriented(g, stand.residual_rotation), stand.place, work.map.airway);
    const auto withdraw = [&](Structure& organ, Bits& bits, const OrganLimits& limits) {
        if (const std::string why = check.implausibility(bits, limits); !why.empty()) {
            organ.found = false;
            organ.volume = 0.0;
            organ.note = why;
            result.contradictions.push_back(fmt::format("{}: {}", organ.name, why));
            bits.clear();
        }
    };

    Structure found_tongue{"tongue", false, 0.0, ""};
    work.report_progress(0.8f, "tongue");
    if (!work.points.contains("tongue")) {
        found_tongue.note = "not in the volume, or not to be found without the mandible";
    } else if (!too_coarse.empty()) {
        found_tongue.note = too_coarse;
    } else {
        tongue = grow_tongue(work, placed.jaw_depth.value_or(45e-3), result.noise,
                             result.tongue_contrast_to_noise, found_tongue.note);
        if (!tongue.empty()) {
            found_tongue.volume = volume_of(g, tongue);
            found_tongue.found = found_tongue.volume > 0.0;
        }
    }
    structures.push_back(found_tongue);
    // Chosen between phantoms of 1.5 mm with 20 HU (3.6, Dice of the tongue 0.89) and 60 HU (1.5, 0.48).
    constexpr float least_contrast_to_noise = 2.5f;
    if (found_tongue.found && result.tongue_contrast_to_noise < least_contrast_to_noise) {
        result.uncertainties.push_back(fmt::format(
            "tongue: the noise is {:.0f} HU, and the contrast {:.1f} times what smoothing leaves of it; "
            "expected at least {:g}. Remedy: use a softer kernel, or correct the tongue manually.",
            result.noise, result.tongue_contrast_to_noise, least_contrast_to_noise));
    }
    for (Structure& organ : structures) {
        if (organ.name == "mandible") {
            withdraw(organ, mandible, mandible_limits);
        } else if (organ.name == "spine") {
            withdraw(organ, spine, spine_limits);
        } else if (organ.name == "tongue") {
            withdraw(organ, tongue, tongue_limits);
        }
    }
    if (const std::string why = check.out_of_order(mandible, tongue, spine); !why.empty()) {
        result.contradictions.push_back(why);
    }

    imaging::Mask labels{g, std::vector<std::uint8_t>(g.count(), value_of(Label::outside))};
    const auto paint = [&](const Bits& bits, Label label) {
        for (std::size_t i = 0; i < bits.size(); ++i) {
            labels.value[i] = bits[i] != 0 ? value_of(label) : labels.value[i];
        }
    };
    paint(work.map.soft, Label::soft);
    paint(tongue, Label::tongue);
    paint(work.map.bone, Label::bone);
    paint(spine, Label::spine);
    paint(mandible, Label::mandible);
    paint(work.map.airway, Label::airway);
    paint(work.map.enclosed_air, Label::enclosed_air);
    find_stray_seeds(labels, work.points, given, result.contradictions);
    result.labels = labels_on_own_grid(volume, own, labels, settings);
    result.labels.geometry = volume.geometry;
    result.points = turned(work.points, stand.axes);
    return result;
}

}  // namespace eti::segmentation
