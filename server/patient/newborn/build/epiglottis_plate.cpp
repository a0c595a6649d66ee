// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/epiglottis_plate.hpp"

#include <algorithm>
#include <cmath>

namespace eti::patient {

namespace {

constexpr int samples = 75;       // of the field along a line through the plate
constexpr float thinnest = 0.5f;  // of the thickness in the middle; where it is less, the plate ends
constexpr float quarter = 0.25f;  // of the thickness, a node's depth and radius
constexpr int halvings = 8;       // of a step, to find where the plate ends

/// The plate seen along its normal in the middle, from the front.
class PlateField {
  public:
    explicit PlateField(const Anatomy& anatomy) : anatomy_(anatomy) {
        const auto points = anatomy.landmarks();
        const Vec3f& base = at(points, Landmark::epiglottis_base);
        const Vec3f axis = at(points, Landmark::epiglottis_tip) - base;
        length_ = axis.norm();
        middle_ = base + 0.5f * axis;
        along_ = axis / length_;
        left_ = (Vec3f::UnitX() - along_.x() * along_).normalized();
        behind_ = left_.cross(along_);
    }

    /// Where a line through the plate is within it [m], front and back of the middle plane.
    struct Column {
        float front = 0.0f, back = 0.0f;
        [[nodiscard]] float thickness() const { return back - front; }
    };

    /// The longest part of a line on which the field is negative, at a place towards tip and left [m].
    [[nodiscard]] Column column(float along, float left) const {
        const float reach = 0.75f * length_;
        const float step = 2.0f * reach / samples;
        Column longest;
        Column now;
        float last = 1.0f;
        for (int n = 0; n <= samples; ++n) {
            const float depth = static_cast<float>(n) * step - reach;
            const float field = anatomy_.fields(point(along, left, depth)).epiglottis;
            if ((field < 0.0f) != (last < 0.0f)) {
                const float border = depth - step * field / (field - last);
                (field < 0.0f ? now.front : now.back) = border;
                if (field >= 0.0f && now.thickness() > longest.thickness()) {
                    longest = now;
                }
            }
            last = field;
        }
        return longest;
    }

    [[nodiscard]] Vec3f point(float along, float left, float depth) const {
        return middle_ + along * along_ + left * left_ + depth * behind_;
    }

    /// How far the plate reaches [m] from a place within it, in steps towards tip and left.
    [[nodiscard]] float reach(float along, float left, float towards_tip, float towards_left,
                              float least) const {
        const auto inside = [&](float way) {
            return column(along + way * towards_tip, left + way * towards_left).thickness() >= least;
        };
        const float step = 0.05f * length_;
        float in = 0.0f;
        while (in < length_ && inside(in + step)) {
            in += step;
        }
        float out = in + step;
        for (int n = 0; n < halvings; ++n) {
            (inside(0.5f * (in + out)) ? in : out) = 0.5f * (in + out);
        }
        return in;
    }

  private:
    const Anatomy& anatomy_;
    Vec3f middle_, along_, left_, behind_;
    float length_ = 0.0f;
};

/// Positions [m] from one end to the other, `spacing` apart or a little less or more.
struct Row {
    float first = 0.0f, last = 0.0f;
    [[nodiscard]] float step(int count) const { return (last - first) / static_cast<float>(count); }
};

}  // namespace

std::vector<PlateNode> epiglottis_plate(const Anatomy& anatomy, float spacing) {
    const PlateField plate(anatomy);
    const float typical = plate.column(0.0f, 0.0f).thickness();
    const float least = thinnest * typical;
    const float rim = quarter * typical;  // balls of the outermost nodes reach the rim
    if (!(typical > 0.0f)) {
        return {};
    }
    const Row length{rim - plate.reach(0.0f, 0.0f, -1.0f, 0.0f, least),
                     plate.reach(0.0f, 0.0f, 1.0f, 0.0f, least) - rim};
    const int rows = std::max(1, static_cast<int>(std::lround((length.last - length.first) / spacing)));
    std::vector<Row> width;
    float widest = 0.0f;
    for (int j = 0; j <= rows; ++j) {
        const float along = length.first + static_cast<float>(j) * length.step(rows);
        width.push_back({rim - plate.reach(along, 0.0f, 0.0f, -1.0f, least),
                         plate.reach(along, 0.0f, 0.0f, 1.0f, least) - rim});
        widest = std::max(widest, width.back().last - width.back().first);
    }
    // An even number of cells across has nodes on the midline.
    const int cells = 2 * std::max(1, static_cast<int>(std::lround(0.5f * widest / spacing)));
    std::vector<PlateNode> nodes;
    for (int j = 0; j <= rows; ++j) {
        const Row& row = width[static_cast<std::size_t>(j)];
        const float along = length.first + static_cast<float>(j) * length.step(rows);
        for (int i = 0; i <= cells; ++i) {
            const float left = row.first + static_cast<float>(i) * row.step(cells);
            const PlateField::Column column = plate.column(along, left);
            const float area = length.step(rows) * row.step(cells);
            for (int k = 0; k < 2; ++k) {
                const float depth = column.front + (k == 0 ? quarter : 1.0f - quarter) * column.thickness();
                nodes.push_back({plate.point(along, left, depth),
                                 quarter * column.thickness(),
                                 0.5f * area * column.thickness(),
                                 {i, j, k}});
            }
        }
    }
    return nodes;
}

}  // namespace eti::patient
