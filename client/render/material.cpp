// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/material.hpp"

#include <algorithm>
#include <cmath>

#include "client/render/skin/newborn_skin.hpp"
#include "client/render/skin/value_noise.hpp"
#include "client/view/sight/sky_visibility.hpp"
#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

const Vec3f cord_colour(0.97f, 0.93f, 0.89f);
const Vec3f lip_colour(0.82f, 0.50f, 0.47f), preterm_lip_colour(0.68f, 0.35f, 0.34f);

// Skin sees at least this fraction of the sky, the lining of a closed mouth almost none. The lips lie
// between.
constexpr float lining_sky = 0.10f;
constexpr float skin_sky = 0.30f;

// Rounds of diffusion across a border of tissues.
constexpr int border_rounds = 4;

float wetness(Tissue tissue) {
    switch (tissue) {
        case Tissue::skull:
        case Tissue::mandible:
        case Tissue::spine:
        case Tissue::hyoid:
            return 0.25f;
        case Tissue::cloth:
            return 0.0f;
        case Tissue::lip:
            return 0.4f;
        case Tissue::tongue:
            return 0.75f;
        default:
            return 1.0f;
    }
}

std::uint8_t byte_of(float share) {
    return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(share, 0.0f, 1.0f)));
}

// Hair never grows on hands and feet: their half of the range says how acral a place is.
std::uint8_t hair_or_acral(float hair, float acral) {
    return static_cast<std::uint8_t>(127 + std::lround(128.0f * std::clamp(hair, 0.0f, 1.0f)) -
                                     std::lround(127.0f * std::clamp(acral, 0.0f, 1.0f)));
}

// Sky visibility through an open mouth of organs with their own surface, which lie inside the body's
// surface.
float organ_sky(Tissue tissue) {
    return tissue == Tissue::tongue ? 0.50f : 0.08f;
}

// Share of the superficial vessels that a lens shows: none on a cord's epithelium, few below a tongue's
// papillae.
float vascularity(Tissue tissue) {
    switch (tissue) {
        case Tissue::vocal_cord:
        case Tissue::cloth:
            return 0.0f;
        case Tissue::tongue:
            return 0.4f;
        default:
            return is_bone(tissue) ? 0.0f : 1.0f;
    }
}

// Replaces each value by the mean over the vertex and its neighbours, `rounds` times.
template <typename Value>
void diffuse(const std::vector<Triangle>& triangles, std::vector<Value>& value, int rounds) {
    std::vector<Value> sum(value.size());
    std::vector<float> count(value.size());
    for (int round = 0; round < rounds; ++round) {
        sum = value;
        std::fill(count.begin(), count.end(), 1.0f);
        for (const Triangle& t : triangles) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t from = t[corner], to = t[(corner + 1) % 3];
                // A closed surface contains every edge twice, once per direction.
                sum[from] += value[to];
                count[from] += 1.0f;
            }
        }
        for (std::size_t v = 0; v < value.size(); ++v) {
            value[v] = sum[v] / count[v];
        }
    }
}

// Share of the vermilion at a point of the face: at term 1 within 2 mm of a lip's edge, which extends 16 mm,
// half the mouth's width, to either side and recedes by 8 mm there.
float vermilion(const Vec3f& p, const Landmarks& rest, float size) {
    const float half_width = 0.016f * size, setback = 0.008f * size;
    const float side = p.x() / half_width;
    float nearest = 1.0f;
    for (const Landmark lip : {Landmark::upper_lip, Landmark::lower_lip}) {
        const Vec3f edge = at(rest, lip) + Vec3f(p.x(), setback * side * side, 0.0f);
        nearest = std::min(nearest, (p - edge).norm());
    }
    return (1.0f - smoothstep(2.0e-3f * size, 4.5e-3f * size, nearest)) *
           (1.0f - smoothstep(0.8f, 1.2f, std::abs(side)));
}

}  // namespace

Vec3f tissue_colour(Tissue tissue) {
    switch (tissue) {
        case Tissue::soft:
            return {0.82f, 0.52f, 0.48f};
        case Tissue::tongue:
            return {0.84f, 0.54f, 0.52f};
        case Tissue::epiglottis:
            return {0.93f, 0.72f, 0.66f};
        case Tissue::larynx:
            return {0.89f, 0.64f, 0.59f};
        case Tissue::trachea:
            return {0.62f, 0.37f, 0.34f};
        case Tissue::oesophagus:
            return {0.74f, 0.44f, 0.42f};
        case Tissue::upper_gum:
        case Tissue::lower_gum:
            return {0.93f, 0.72f, 0.68f};
        case Tissue::palate:
            return {0.90f, 0.66f, 0.62f};
        case Tissue::skull:
        case Tissue::mandible:
        case Tissue::spine:
        case Tissue::hyoid:
            return {0.93f, 0.88f, 0.76f};
        case Tissue::vocal_cord:
            return cord_colour;
        case Tissue::lip:
            return lip_colour;
        case Tissue::cloth:
            return {0.86f, 0.90f, 0.93f};
    }
    return {0.8f, 0.4f, 0.4f};
}

Vec3f cut_colour(Tissue tissue) {
    switch (tissue) {
        case Tissue::soft:
            return {0.85f, 0.58f, 0.50f};
        case Tissue::tongue:
            return {0.72f, 0.30f, 0.30f};
        case Tissue::epiglottis:
            return {0.93f, 0.80f, 0.66f};
        case Tissue::skull:
        case Tissue::mandible:
        case Tissue::spine:
        case Tissue::hyoid:
            return {0.95f, 0.91f, 0.80f};
        default:
            return 0.92f * tissue_colour(tissue);
    }
}

SurfaceAppearance surface_appearance(const bus::RestSurface& surface, const Landmarks& rest) {
    const std::size_t count = surface.mesh.vertices.size();
    std::vector<Vec3f> colour(count, Vec3f::Zero());
    std::vector<float> wet(count, 0.0f), softness(count, 0.0f), corners(count, 0.0f), vessels(count, 0.0f);
    std::vector<Tissue> label(count, Tissue::soft);
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const Tissue tissue = surface.triangle_tissue[t];
        for (const std::uint32_t v : surface.mesh.triangles[t]) {
            colour[v] += tissue_colour(tissue);
            wet[v] += wetness(tissue);
            softness[v] += tissue == Tissue::soft ? 1.0f : 0.0f;
            vessels[v] += vascularity(tissue);
            corners[v] += 1.0f;
            // At a border the vertex belongs to the specific tissue.
            label[v] = label[v] == Tissue::soft ? tissue : label[v];
        }
    }
    const bool has_soft = std::find(surface.triangle_tissue.begin(), surface.triangle_tissue.end(),
                                    Tissue::soft) != surface.triangle_tissue.end();
    std::vector<float> sky(count, organ_sky(surface.tissue));
    if (has_soft) {
        sky = view::sky_visibility(surface.mesh);
        diffuse(surface.mesh.triangles, sky, 3);
    }
    for (std::size_t v = 0; v < count; ++v) {
        const float shares = std::max(corners[v], 1.0f);
        colour[v] /= shares;
        vessels[v] /= shares;
    }
    // Half a millimetre wide at the cords: a border along edges is a saw before a lens.
    diffuse(surface.mesh.triangles, colour, border_rounds);
    diffuse(surface.mesh.triangles, vessels, border_rounds);
    const NewbornSkin newborn(rest);
    std::vector<VertexColour> result(count);
    std::vector<VertexRelief> relief(count);
    for (std::size_t v = 0; v < count; ++v) {
        const float shares = std::max(corners[v], 1.0f);
        const Vec3f& p = surface.mesh.vertices[v];
        Vec3f c = colour[v];
        float w = wet[v] / shares;
        float mucosa = vessels[v], grown = 0.0f, acral = 0.0f;
        if (softness[v] > 0.0f) {
            const float skin = smoothstep(lining_sky, skin_sky, sky[v]) * softness[v] / shares;
            const float lip = skin * vermilion(p, rest, newborn.size());
            const Vec3f place = newborn.to_model(p);
            const NewbornSkin::Look look = newborn.look(place, sky[v]);
            c += skin * (look.colour - c);
            c += 0.75f * lip * (lip_colour - c);
            w += skin * (look.wetness - w) + 0.3f * lip;
            grown = skin * (1.0f - lip) * newborn.hair(place);
            acral = skin * newborn.acral(place);
            mucosa -= skin;
        }
        if (label[v] == Tissue::lip) {
            c -= newborn.prematurity() * (c - preterm_lip_colour);
        }
        // Blotches of about 4 mm and 1.5 mm; blood absorbs mainly red's complement.
        const float blotch = 0.6f * value_noise(p * 250.0f) + 0.4f * value_noise(p * 700.0f) - 0.5f;
        c = c.cwiseProduct(Vec3f(1.0f + 0.06f * blotch, 1.0f + 0.16f * blotch, 1.0f + 0.15f * blotch));
        for (int k = 0; k < 3; ++k) {
            result[v][static_cast<std::size_t>(k)] = byte_of(c[k]);
        }
        result[v][3] = byte_of(w);
        relief[v] = {byte_of(sky[v]), byte_of(mucosa), tissue_label(label[v]), hair_or_acral(grown, acral)};
    }
    return {std::move(result), std::move(relief)};
}

}  // namespace eti::render
