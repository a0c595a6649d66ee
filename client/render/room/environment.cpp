// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

// A rectangle of light: towards `towards`, with half sizes as tangents of angles along two axes.
struct Softbox {
    Vec3f towards, across, along;  // unit vectors
    float half_across, half_along;
    Vec3f light;
};

Softbox softbox(const Vec3f& towards, const Vec3f& across, float half_across, float half_along,
                const Vec3f& light) {
    const Vec3f z = towards.normalized();
    const Vec3f x = (across - across.dot(z) * z).normalized();
    return {z, x, z.cross(x), half_across, half_along, light};
}

float inside(float distance, float half, float edge) {
    return 1.0f - smoothstep(half - edge, half + edge, std::abs(distance));
}

const std::array<Softbox, 5>& softboxes() {
    static const std::array boxes{
        // Two luminaires in the ceiling, the warmer, the window; last the examination lamp: light 0 of a
        // view.
        softbox({-0.55f, -1.0f, -0.15f}, Vec3f::UnitX(), 0.13f, 0.55f, Vec3f(1.35f, 1.4f, 1.45f)),
        softbox({0.75f, -1.0f, -0.35f}, Vec3f::UnitX(), 0.13f, 0.55f, Vec3f(1.35f, 1.4f, 1.45f)),
        softbox({0.0f, -0.8f, -0.45f}, Vec3f::UnitX(), 0.22f, 0.06f, Vec3f(1.6f, 0.75f, 0.35f)),
        softbox({1.0f, -0.28f, 0.25f}, Vec3f::UnitZ(), 0.42f, 0.24f, Vec3f(1.5f, 1.75f, 2.1f)),
        softbox({0.30f, -0.75f, 0.40f}, Vec3f::UnitX(), 0.16f, 0.16f, Vec3f(3.2f, 3.0f, 2.8f)),
    };
    return boxes;
}

// Direction through a texel of a face of a cube map (OpenGL 4.5 specification, table 8.19).
Vec3f through_texel(int face, int x, int y, int size) {
    const float s = 2.0f * (static_cast<float>(x) + 0.5f) / static_cast<float>(size) - 1.0f;
    const float t = 2.0f * (static_cast<float>(y) + 0.5f) / static_cast<float>(size) - 1.0f;
    const std::array<Vec3f, 6> directions{Vec3f(1.0f, -t, -s), Vec3f(-1.0f, -t, s), Vec3f(s, 1.0f, t),
                                          Vec3f(s, -1.0f, -t), Vec3f(s, -t, 1.0f),  Vec3f(-s, -t, -1.0f)};
    return directions[static_cast<std::size_t>(face)].normalized();
}

std::array<float, 9> harmonics(const Vec3f& n) {
    return {1.0f,
            n.x(),
            n.y(),
            n.z(),
            n.x() * n.y(),
            n.y() * n.z(),
            n.z() * n.x(),
            n.x() * n.x() - n.y() * n.y(),
            3.0f * n.z() * n.z() - 1.0f};
}

// The room with these of its lights.
Vec3f radiance_of(const Vec3f& direction, std::span<const Softbox> boxes) {
    const float up = -direction.y();
    const Vec3f ceiling(0.26f, 0.27f, 0.28f), wall(0.17f, 0.18f, 0.19f), floor(0.05f, 0.05f, 0.055f);
    const Vec3f bed(0.09f, 0.09f, 0.09f);  // the towel, from close above it
    Vec3f seen = up > 0.0f ? Vec3f(wall + smoothstep(0.45f, 0.60f, up) * (ceiling - wall))
                           : Vec3f(wall + smoothstep(0.05f, 0.20f, -up) * (floor - wall));
    seen += smoothstep(0.45f, 0.75f, -up) * (bed - seen);
    // Skirting and equipment darken the horizon.
    seen *= 1.0f - 0.45f * std::exp(-60.0f * (up + 0.05f) * (up + 0.05f));
    for (const Softbox& box : boxes) {
        const float ahead = direction.dot(box.towards);
        if (ahead > 0.1f) {
            const float share = inside(direction.dot(box.across) / ahead, box.half_across, 0.03f) *
                                inside(direction.dot(box.along) / ahead, box.half_along, 0.03f);
            seen += share * (box.light - seen);
        }
    }
    return seen;
}

}  // namespace

Vec3f room_radiance(const Vec3f& direction) {
    return radiance_of(direction, softboxes());
}

Irradiance irradiance_of(const Radiance& radiance) {
    // Convolution with the clamped cosine / pi, by band: 1, 2/3, 1/4; times the squared norms of the
    // polynomials: 1/(4 pi), 3/(4 pi), 15/(4 pi) and, for those of squares, 15/(16 pi) and 5/(16 pi).
    constexpr std::array<float, 9> factor{
        0.25f, 0.5f, 0.5f, 0.5f, 15.0f / 16.0f, 15.0f / 16.0f, 15.0f / 16.0f, 15.0f / 64.0f, 5.0f / 64.0f};
    constexpr int size = 32;
    Irradiance sum;
    sum.fill(Vec3f::Zero());
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const Vec3f direction = through_texel(face, x, y, size);
                // Solid angle of a texel: its area times the cube of the cosine at the cube's face.
                const float side = direction.cwiseAbs().maxCoeff();
                const float area = 4.0f / (size * size) * side * side * side;
                const Vec3f light = area * radiance(direction);
                const std::array<float, 9> basis = harmonics(direction);
                for (std::size_t k = 0; k < 9; ++k) {
                    sum[k] += factor[k] / std::numbers::pi_v<float> * basis[k] * light;
                }
            }
        }
    }
    return sum;
}

const Irradiance& room_irradiance() {
    static const Irradiance irradiance = irradiance_of([](const Vec3f& direction) {
        // The examination lamp's light is that of a view's light 0.
        return radiance_of(direction, std::span(softboxes()).first(softboxes().size() - 1));
    });
    return irradiance;
}

Vec3f evaluate(const Irradiance& irradiance, const Vec3f& normal) {
    const std::array<float, 9> basis = harmonics(normal);
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < 9; ++k) {
        sum += basis[k] * irradiance[k];
    }
    return sum;
}

Vec3f prefiltered(const Radiance& radiance, const Vec3f& direction, float roughness, int samples) {
    const Vec3f aside = direction.unitOrthogonal(), up = direction.cross(aside);
    const float alpha = roughness * roughness;
    Vec3f sum = Vec3f::Zero();
    float weights = 0.0f;
    for (int i = 0; i < samples; ++i) {
        // Stratified in the cosine, golden ratio in azimuth.
        const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples);
        const float turn = 2.0f * std::numbers::pi_v<float> * 0.61803399f * static_cast<float>(i);
        const float cosine = std::sqrt((1.0f - u) / (1.0f + (alpha * alpha - 1.0f) * u));
        const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
        const Vec3f half = cosine * direction + sine * (std::cos(turn) * aside + std::sin(turn) * up);
        const Vec3f light = 2.0f * cosine * half - direction;
        const float weight = light.dot(direction);
        if (weight > 0.0f) {
            sum += weight * radiance(light);
            weights += weight;
        }
    }
    return sum / weights;
}

EnvironmentMap::EnvironmentMap() {
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_.name());
    int level = 0;
    for (int side = size; side >= 1; side /= 2, ++level) {
        const float roughness = std::max(static_cast<float>(level) / rough_level, 0.05f);
        for (int face = 0; face < 6; ++face) {
            std::vector<Vec3f> texels;
            for (int y = 0; y < side; ++y) {
                for (int x = 0; x < side; ++x) {
                    texels.push_back(prefiltered(room_radiance, through_texel(face, x, y, side), roughness,
                                                 level == 0 ? 4 : 64));
                }
            }
            glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), level, GL_RGB16F, side,
                         side, 0, GL_RGB, GL_FLOAT, texels.data());
        }
    }
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, level - 1);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glBindTexture(GL_TEXTURE_CUBE_MAP, 0);
}

}  // namespace eti::render
