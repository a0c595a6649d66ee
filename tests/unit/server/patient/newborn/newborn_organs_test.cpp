// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Shapes of single organs, each against anatomy. Coordinates are the model's: millimetres of a newborn of 3.5
// kg, x left, y anterior, z superior.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/math/units.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {
namespace {

constexpr float step = 0.05f;

struct NamedShape {
    const char* name;
    NewbornShape shape;
};

std::vector<NamedShape> shapes() {
    std::vector<NamedShape> all{{"usual", {}}};
    NewbornShape small;
    small.weight = 0.6f;
    small.gestational_age = 25.0f;
    all.push_back({"0.6 kg", small});
    NewbornShape open;
    open.jaw_opening = 20.0f * degree;
    all.push_back({"open mouth", open});
    for (const AirwayVariant variant : {AirwayVariant::micrognathia, AirwayVariant::macroglossia}) {
        NewbornShape shape;
        apply(variant, shape);
        all.push_back({variant == AirwayVariant::micrognathia ? "micrognathia" : "macroglossia", shape});
    }
    return all;
}

/// Queries a newborn's fields in model coordinates.
class Place {
  public:
    explicit Place(const NewbornShape& shape) : newborn_(shape) {}

    /// Lengths are millimetres of the model.
    [[nodiscard]] Fields at(float x, float y, float z) const {
        Fields f = newborn_.fields(newborn_.from_model({x, y, z}));
        for (float* const field :
             {&f.cavity, &f.tongue, &f.sublingual, &f.epiglottis, &f.larynx, &f.cricoid}) {
            *field /= newborn_.scale();
        }
        return f;
    }
    [[nodiscard]] bool air(float x, float y, float z) const {
        const Fields f = at(x, y, z);
        return f.cavity < 0.0f && std::max(f.tongue, -f.sublingual) > 0.0f && f.epiglottis > 0.0f;
    }
    [[nodiscard]] bool wall(float x, float y, float z) const {
        const Fields f = at(x, y, z);
        return f.cavity > 0.0f && f.larynx < 0.0f;
    }
    [[nodiscard]] bool tongue(float x, float y, float z) const {
        const Fields f = at(x, y, z);
        return std::max(f.tongue, -f.sublingual) < 0.0f;
    }
    [[nodiscard]] bool cartilage(float x, float y, float z) const { return at(x, y, z).cricoid < 0.0f; }
    /// Whether a tool can be at this point outside the offset shell.
    [[nodiscard]] bool yields(float x, float y, float z) const {
        const Vec3f point = newborn_.from_model({x, y, z});
        const Fields f = newborn_.fields(point);
        return newborn_.shell_field(point, f) > 0.0f;
    }
    [[nodiscard]] Vec3f landmark(Landmark which) const {
        return newborn_.to_model(newborn_.landmarks()[static_cast<std::size_t>(which)]);
    }

    /// From the axis of the larynx to its side wall.
    [[nodiscard]] float half_width(float y, float z) const {
        float x = 0.0f;
        while (x < 8.0f && at(x, y, z).cavity < 0.0f) {
            x += step;
        }
        return x;
    }
    [[nodiscard]] float half_width(float z) const {
        float widest = 0.0f;
        for (float y = 2.0f; y < 9.0f; y += 0.2f) {
            widest = std::max(widest, half_width(y, z));
        }
        return widest;
    }
    [[nodiscard]] double area(float z) const {
        double sum = 0.0;
        for (float y = 0.0f; y < 11.0f; y += step) {
            sum += static_cast<double>(2.0f * half_width(y, z) * step);
        }
        return sum;
    }
    /// Thickness of the cartilage from the lumen's middle in a direction.
    [[nodiscard]] float cartilage_towards(float x, float y, float z) const {
        float thickness = 0.0f;
        for (float r = 0.0f; r < 7.0f; r += step) {
            thickness += cartilage(r * x, middle_of_subglottis + r * y, z) ? step : 0.0f;
        }
        return thickness;
    }
    static constexpr float middle_of_subglottis = 4.9f;

  private:
    Newborn newborn_;
};

constexpr float ring_z = -43.2f;

TEST(NewbornOrgans, FalseCordsAreWiderApartThanTrueCords) {
    for (const auto& [name, shape] : shapes()) {
        const Place place(shape);
        const float glottis_z = place.landmark(Landmark::glottis).z();
        float ventricle = 0.0f, ventricle_z = glottis_z;
        for (float z = glottis_z; z < glottis_z + 2.5f; z += 0.1f) {
            if (const float width = place.half_width(z); width > ventricle) {
                ventricle = width;
                ventricle_z = z;
            }
        }
        float false_cords = ventricle, false_cords_z = ventricle_z;
        for (float z = ventricle_z; z < glottis_z + 4.5f; z += 0.1f) {
            if (const float width = place.half_width(z); width < false_cords) {
                false_cords = width;
                false_cords_z = z;
            }
        }
        // Gray's Anatomy: the rima vestibuli is wider than the rima glottidis, so that the true cords are
        // seen between the false ones; the ventricle lies beyond both.
        EXPECT_GT(false_cords, place.half_width(glottis_z) + 0.2f) << name;
        EXPECT_GT(ventricle, false_cords + 0.5f) << name << ": less is lost on a grid of 1 mm";
        EXPECT_GT(place.half_width(false_cords_z + 2.0f), false_cords + 0.2f) << name << ": the vestibule";
        // In front, too, where the cords meet.
        const float front = place.landmark(Landmark::glottis_anterior).y() - 1.0f;
        EXPECT_GT(place.half_width(front, false_cords_z), place.half_width(front, glottis_z) + 0.2f) << name;
    }
}

// The tongue is attached to the mandible: flattened there, it is stopped by bone.
TEST(NewbornOrgans, MandibleStopsBladeBehindTongue) {
    for (const auto& [name, shape] : shapes()) {
        const Newborn newborn(shape);
        int within = 0;
        for (float x = -15.0f; x <= 15.0f; x += 1.0f) {
            for (float y = 0.0f; y <= 48.0f; y += 1.0f) {
                for (float z = -32.0f; z <= 12.0f; z += 1.0f) {
                    const Vec3f point = newborn.from_model({x, y, z});
                    const Fields f = newborn.fields(point);
                    // A blade on the gum's ridge would lever between both gums.
                    const bool at_the_ridge = f.lower_gum < newborn.scale() * 3.0f;
                    if (f.tongue > 0.0f || f.cavity < 0.0f || f.mandible > 0.0f || at_the_ridge) {
                        continue;
                    }
                    ++within;
                    ASSERT_LT(newborn.shell_field(point, f), 0.0f)
                        << name << ": a tool is let through at " << x << " " << y << " " << z << " mm";
                }
            }
        }
        EXPECT_GT(within, 20) << name;
    }
}

TEST(NewbornOrgans, GlottisIsWidestPosteriorly) {
    const Place place{NewbornShape()};
    const Vec3f front = place.landmark(Landmark::glottis_anterior);
    const Vec3f back = place.landmark(Landmark::glottis_posterior);
    const float z = place.landmark(Landmark::glottis).z();
    const float length = front.y() - back.y();
    const float behind = place.half_width(back.y() + 0.2f * length, z);
    EXPECT_GT(behind, 1.3f * place.half_width(front.y() - 0.2f * length, z));
    // The rim itself, not only its landmarks, is as long as Sato 2015 (Laryngoscope 125:E186) found, 2 SD.
    float rim = 0.0f;
    for (float y = 0.0f; y < 11.0f; y += step) {
        rim += place.air(0.0f, y, z) ? step : 0.0f;
    }
    EXPECT_GT(rim, 4.2f);
    EXPECT_LT(rim, 6.6f);
    EXPECT_TRUE(place.air(0.0f, front.y(), front.z()));
    EXPECT_TRUE(place.air(0.0f, back.y(), back.z()));
}

TEST(NewbornOrgans, ThreePointFiveTubePassesCordsAndCricoid) {
    const Place place{NewbornShape()};
    constexpr float outer_radius = 2.45f;
    const auto passes = [&](float y, float z) {
        for (int i = 0; i < 36; ++i) {
            const float angle = static_cast<float>(i) * 10.0f * degree;
            if (!place.yields(outer_radius * std::cos(angle), y + outer_radius * std::sin(angle), z)) {
                return false;
            }
        }
        return true;
    };
    for (float z = -33.0f; z > -46.0f; z -= 0.5f) {
        bool passed = false;
        for (float y = 3.5f; y < 7.0f && !passed; y += 0.1f) {
            passed = passes(y, z);
        }
        EXPECT_TRUE(passed) << z;
    }
}

TEST(NewbornOrgans, CricoidIsClosedRingWithPosteriorLamina) {
    for (const auto& [name, shape] : shapes()) {
        const Place place(shape);
        for (int i = 0; i < 36; ++i) {
            const float angle = static_cast<float>(i) * 10.0f * degree;
            EXPECT_GT(place.cartilage_towards(std::cos(angle), std::sin(angle), ring_z), 0.5f)
                << name << " at " << 10 * i;
        }
        EXPECT_GT(place.cartilage_towards(0, -1, ring_z), 1.3f * place.cartilage_towards(0, 1, ring_z))
            << name;
        // A signet ring (Gray's Anatomy): the lamina is a multiple of the arch's height.
        const auto height = [&](float way) {
            float sum = 0.0f;
            for (float z = -50.0f; z < -33.0f; z += 0.1f) {
                sum += place.cartilage_towards(0, way, z) > 0.3f ? 0.1f : 0.0f;
            }
            return sum;
        };
        EXPECT_GT(height(-1.0f), 2.0f * height(1.0f)) << name;
        EXPECT_GT(height(1.0f), 1.0f) << name;
        // In the wall, covered by mucosa.
        for (float z = -46.0f; z < -36.0f; z += 0.5f) {
            for (float y = -4.0f; y < 12.0f; y += 0.25f) {
                for (float x = 0.0f; x < 7.0f; x += 0.25f) {
                    if (const Fields f = place.at(x, y, z); f.cricoid < 0.0f) {
                        EXPECT_LT(f.larynx, 0.0f) << name;
                        EXPECT_GT(f.cavity, 0.1f) << name;
                    }
                }
            }
        }
    }
}

TEST(NewbornOrgans, LumenNarrowsToCricoidButWidensLaterally) {
    const Place place{NewbornShape()};
    const float glottis_z = place.landmark(Landmark::glottis).z();
    // With the cords apart the larynx is a funnel whose narrowest part is the ring; from side to side it
    // widens from the cords down (Litman 2003, Anesthesiology 98:41).
    EXPECT_GT(place.area(glottis_z), 1.05 * place.area(ring_z));
    EXPECT_LT(place.half_width(glottis_z), place.half_width(0.5f * (glottis_z + ring_z)) + 0.5f * step);
    EXPECT_LT(place.half_width(glottis_z), place.half_width(ring_z));
    // 19.27 +- 9.62 mm^2 from the fifth month to birth (Ann Otol Rhinol Laryngol 2008;117:774).
    EXPECT_NEAR(place.area(ring_z), 19.27, 9.62);
}

TEST(NewbornOrgans, AryepiglotticFoldsSeparateInletFromRecesses) {
    for (const auto& [name, shape] : shapes()) {
        const Place place(shape);
        for (const float side : {-1.0f, 1.0f}) {
            // The fold runs from the epiglottis's edge back and down to the arytenoid, with the inlet on one
            // side and the piriform recess on the other.
            for (const float t : {0.3f, 0.6f, 0.9f}) {
                const Vec3f p = (1.0f - t) * Vec3f(4.6f, 6.2f, -27.2f) + t * Vec3f(3.6f, 2.2f, -32.2f);
                bool solid = false;
                for (float x = 2.5f; x < 6.0f; x += step) {
                    solid = solid || place.wall(side * x, p.y(), p.z());
                }
                EXPECT_TRUE(solid) << name << " at " << t;
                EXPECT_TRUE(place.air(side * (p.x() - 2.2f), p.y() + 0.8f, p.z())) << name << " at " << t;
                EXPECT_TRUE(place.air(side * (p.x() + 2.0f), p.y(), p.z())) << name << " at " << t;
            }
            // Arytenoids rise behind the inlet, higher than the notch between them.
            const auto top = [&](float x) {
                float z = -36.0f;
                while (z < -26.0f && place.wall(x, 1.2f, z)) {
                    z += 0.1f;
                }
                return z;
            };
            EXPECT_GT(top(side * 2.9f), top(0.0f) + 1.0f) << name;
            EXPECT_GT(top(0.0f), place.landmark(Landmark::glottis).z() + 1.0f) << name;
            EXPECT_LT(place.landmark(Landmark::glottis_posterior).y() - 1.2f, 3.0f) << name;
        }
    }
}

TEST(NewbornOrgans, TheEpiglottisIsOmegaShaped) {
    for (const auto& [name, shape] : shapes()) {
        const Place place(shape);
        const Vec3f tip = place.landmark(Landmark::epiglottis_tip);
        const Vec3f base = place.landmark(Landmark::epiglottis_base);
        for (const float along : {0.4f, 0.6f, 0.8f}) {
            const Vec3f middle = (1.0f - along) * base + along * tip;
            // Middle of the plate, and its thickness, from front to back.
            const auto plate = [&](float x) {
                float sum = 0.0f, count = 0.0f;
                for (float y = middle.y() - 6.0f; y < middle.y() + 6.0f; y += step) {
                    if (place.at(x, y, middle.z()).epiglottis < 0.0f) {
                        sum += y;
                        count += 1.0f;
                    }
                }
                return std::pair(sum / count, count * step);
            };
            const auto [ridge, thickness] = plate(0.0f);
            // Its sides bend backwards increasingly, until the edge lies behind the back of the middle.
            const float inner = ridge - plate(2.4f).first;
            const float edge = ridge - plate(4.8f).first;
            EXPECT_GT(inner, 0.2f) << name << ' ' << along;
            EXPECT_GT(edge, 2.0f * inner) << name << ' ' << along;
            EXPECT_GT(edge, 0.5f * thickness) << name << ' ' << along;
            EXPECT_NEAR(ridge - plate(-4.8f).first, edge, 0.1f) << name << ' ' << along;
        }
    }
}

TEST(NewbornOrgans, FrenulumTethersTongueInMidline) {
    for (const auto& [name, shape] : shapes()) {
        const Place place(shape);
        const Vec3f gum = place.landmark(Landmark::lower_gum);
        // Air between tongue and floor of the mouth, from the gum backwards.
        const auto under_tongue = [&](float x, float y) {
            bool tongue_above = false;
            for (float z = gum.z() + 6.0f; z > gum.z() - 14.0f; z -= 0.1f) {
                tongue_above = tongue_above || place.tongue(x, y, z);
                if (tongue_above && place.air(x, y, z)) {
                    return true;
                }
            }
            return false;
        };
        const auto hindmost = [&](float x) {
            float y = gum.y() + 4.0f, found = 100.0f;
            for (; y > gum.y() - 20.0f; y -= 0.1f) {
                found = under_tongue(x, y) ? y : found;
            }
            return found;
        };
        const float in_middle = hindmost(0.0f);
        const float left = hindmost(3.0f), right = hindmost(-3.0f);
        EXPECT_NEAR(left, right, 0.15f) << name;
        // Beside it the tip is free, and in the midline a fold of some millimetres holds it.
        EXPECT_GT(in_middle - left, 2.0f) << name;
        EXPECT_LT(in_middle, gum.y()) << name << ": it holds to the floor, before it reaches the gum's ridge";
        for (float y = left + 1.0f; y < in_middle - 0.3f; y += 0.5f) {
            EXPECT_FALSE(under_tongue(0.0f, y)) << name;
            EXPECT_FALSE(under_tongue(0.4f, y)) << name;
            EXPECT_TRUE(under_tongue(1.8f, y)) << name << ": it is thin";
            EXPECT_TRUE(under_tongue(-1.8f, y)) << name;
        }
    }
}

}  // namespace
}  // namespace eti::patient
