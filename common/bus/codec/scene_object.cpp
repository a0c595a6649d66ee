// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/scene_object.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace eti::bus {
namespace {

msg::SceneDescription named(const std::string& name, msg::ObjectKind kind) {
    msg::SceneDescription message;
    message.object(name);
    message.kind(kind);
    return message;
}

void append(std::span<const Vec3f> points, msg::SceneDescription& message) {
    for (const Vec3f& p : points) {
        message.vertices().insert(message.vertices().end(), {p.x(), p.y(), p.z()});
    }
}

void append(const TriangleMesh& mesh, msg::SceneDescription& message) {
    append(mesh.vertices, message);
    for (const Triangle& t : mesh.triangles) {
        message.triangles().insert(message.triangles().end(), t.begin(), t.end());
    }
}

bool read_points(const std::vector<float>& flat, std::vector<Vec3f>& points, std::string& why) {
    if (flat.empty() || flat.size() % 3 != 0) {
        why = fmt::format("{} vertex coordinates; expected a positive multiple of 3", flat.size());
        return false;
    }
    points.reserve(flat.size() / 3);
    for (std::size_t i = 0; i < flat.size(); i += 3) {
        const Vec3f point(flat[i], flat[i + 1], flat[i + 2]);
        if (!is_valid_point(point)) {
            why = fmt::format("vertex {} is not finite or lies beyond {} m", i / 3, max_coordinate);
            return false;
        }
        points.push_back(point);
    }
    return true;
}

bool read_mesh(const msg::SceneDescription& message, TriangleMesh& mesh, std::string& why) {
    if (!read_points(message.vertices(), mesh.vertices, why)) {
        return false;
    }
    const auto& flat = message.triangles();
    if (flat.empty() || flat.size() % 3 != 0) {
        why = fmt::format("{} triangle indices; expected a positive multiple of 3", flat.size());
        return false;
    }
    mesh.triangles.reserve(flat.size() / 3);
    for (std::size_t i = 0; i < flat.size(); i += 3) {
        const Triangle triangle{flat[i], flat[i + 1], flat[i + 2]};
        for (const std::uint32_t index : triangle) {
            if (index >= mesh.vertices.size()) {
                why =
                    fmt::format("triangle {} refers to vertex {} of {}", i / 3, index, mesh.vertices.size());
                return false;
            }
        }
        mesh.triangles.push_back(triangle);
    }
    return true;
}

bool read_tissues(const msg::SceneDescription& message, RestSurface& surface, std::string& why) {
    if (message.tissue() >= tissue_count) {
        why = fmt::format("tissue {} of {}", message.tissue(), tissue_count);
        return false;
    }
    surface.tissue = static_cast<Tissue>(message.tissue());
    const auto& octets = message.triangle_tissue();
    if (octets.empty()) {
        surface.triangle_tissue.assign(surface.mesh.triangles.size(), surface.tissue);
        return true;
    }
    if (octets.size() != surface.mesh.triangles.size()) {
        why =
            fmt::format("{} triangle tissues for {} triangles", octets.size(), surface.mesh.triangles.size());
        return false;
    }
    surface.triangle_tissue.reserve(octets.size());
    for (const std::uint8_t octet : octets) {
        if (octet >= tissue_count) {
            why = fmt::format("triangle tissue {} of {}", octet, tissue_count);
            return false;
        }
        surface.triangle_tissue.push_back(static_cast<Tissue>(octet));
    }
    return true;
}

bool read_skin(const msg::SceneDescription& message, RestSurface& surface, std::string& why) {
    const std::size_t count = surface.mesh.vertices.size();
    const auto& frames = message.skin_frame();
    const auto& weights = message.skin_weight();
    if (frames.size() != frames_per_point * count || weights.size() != frames_per_point * count) {
        why = fmt::format("{} skin frames and {} skin weights for {} vertices; expected {} each",
                          frames.size(), weights.size(), count, frames_per_point);
        return false;
    }
    surface.skin.resize(count);
    for (std::size_t v = 0; v < count; ++v) {
        const std::size_t first = frames_per_point * v;
        int sum = 0;
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            sum += weights[first + k];
        }
        if (sum == 0) {
            why = fmt::format("no frame carries vertex {}", v);
            return false;
        }
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            const bool used = weights[first + k] > 0;
            // Normalised here, so that rounding neither shrinks nor inflates the surface.
            surface.skin[v].weight[k] = static_cast<float>(weights[first + k]) / static_cast<float>(sum);
            surface.skin[v].frame[k] = used ? frames[first + k] : std::uint16_t{0};
            surface.highest_frame = std::max(surface.highest_frame, surface.skin[v].frame[k]);
        }
    }
    return true;
}

std::optional<SceneObject> decode_surface(const msg::SceneDescription& message, std::string& why) {
    RestSurface surface;
    surface.name = message.object().to_string();
    if (!read_mesh(message, surface.mesh, why) || !read_tissues(message, surface, why) ||
        !read_skin(message, surface, why)) {
        return std::nullopt;
    }
    return surface;
}

}  // namespace

msg::SceneDescription encode_frames(std::span<const Vec3f> rest_centres) {
    msg::SceneDescription message = named("frames", msg::OBJECT_FRAMES);
    append(rest_centres, message);
    return message;
}

msg::SceneDescription encode_surface(const Surface& surface) {
    msg::SceneDescription message = named(surface.name, msg::OBJECT_SURFACE);
    message.tissue(static_cast<std::uint32_t>(surface.tissue));
    append(surface.mesh, message);
    for (const Tissue tissue : surface.triangle_tissue) {
        message.triangle_tissue().push_back(static_cast<std::uint8_t>(tissue));
    }
    for (const SkinWeights& skin : surface.skin) {
        message.skin_frame().insert(message.skin_frame().end(), skin.frame.begin(), skin.frame.end());
        for (const float weight : skin.weight) {
            message.skin_weight().push_back(static_cast<std::uint16_t>(std::lround(weight * 65535.0f)));
        }
    }
    return message;
}

msg::SceneDescription encode_laryngoscope(const TriangleMesh& mesh) {
    msg::SceneDescription message = named(laryngoscope_object, msg::OBJECT_TOOL);
    append(mesh, message);
    return message;
}

std::optional<SceneObject> decode_scene_object(const msg::SceneDescription& message, std::string& why) {
    switch (message.kind()) {
        case msg::OBJECT_FRAMES: {
            std::vector<Vec3f> rest_centres;
            if (!read_points(message.vertices(), rest_centres, why)) {
                return std::nullopt;
            }
            if (rest_centres.size() > 65536) {
                why = fmt::format("{} frames, but an index has 16 bits", rest_centres.size());
                return std::nullopt;
            }
            return rest_centres;
        }
        case msg::OBJECT_SURFACE:
            return decode_surface(message, why);
        case msg::OBJECT_TOOL: {
            TriangleMesh mesh;
            if (!read_mesh(message, mesh, why)) {
                return std::nullopt;
            }
            return mesh;
        }
    }
    why = fmt::format("unknown kind {}", static_cast<int>(message.kind()));
    return std::nullopt;
}

}  // namespace eti::bus
