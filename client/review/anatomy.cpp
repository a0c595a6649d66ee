// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <span>

#include "client/review/report.hpp"
#include "common/hdf5/file.hpp"
#include "common/mesh/point_grid.hpp"
#include "common/mesh/simplify.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::review {

namespace {

using nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little);

/// Triangle budget per surface; the body's includes mouth and airway.
constexpr std::size_t body_triangles = 16000, tongue_triangles = 4000, other_triangles = 2500;
/// Maximum number of postures; longer sessions are sampled more coarsely than recorded.
constexpr std::size_t max_postures = 600;
/// Maximum number of tool poses.
constexpr std::size_t max_poses = 1800;
constexpr float centre_quantum = frame_shift_quantum;  ///< [m], the resolution of the recording
constexpr float rotation_quantum = 1.0f / 32767.0f;

std::string base64(std::span<const unsigned char> bytes) {
    constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        const std::uint32_t word = static_cast<std::uint32_t>(bytes[i] << 16) |
                                   static_cast<std::uint32_t>(left > 1 ? bytes[i + 1] << 8 : 0) |
                                   static_cast<std::uint32_t>(left > 2 ? bytes[i + 2] : 0);
        for (std::size_t k = 0; k < 4; ++k) {
            out += k <= left ? letters[word >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return out;
}

template <class T>
std::string packed(const std::vector<T>& values) {
    return base64({reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)});
}

/// Deflated with zlib; low bytes first, then the high ones, which hardly change.
std::string deflated(const std::vector<std::int16_t>& values) {
    std::vector<unsigned char> planes(2 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        planes[i] = static_cast<unsigned char>(values[i] & 0xff);
        planes[values.size() + i] = static_cast<unsigned char>(values[i] >> 8 & 0xff);
    }
    uLongf size = compressBound(planes.size());
    std::vector<unsigned char> out(size);
    if (compress2(out.data(), &size, planes.data(), planes.size(), 6) != Z_OK) {
        throw std::bad_alloc();
    }
    out.resize(size);
    return base64(out);
}

void append(std::vector<float>& out, const Vec3f& v) {
    out.insert(out.end(), {v.x(), v.y(), v.z()});
}

/// The vertex nearest to a point.
std::size_t nearest(const PointGrid& grid, const Vec3f& point, float cell) {
    for (float radius = cell;; radius *= 2.0f) {
        std::size_t best = 0;
        float least = INFINITY;
        grid.within(point, radius, [&](std::uint32_t i, float squared) {
            if (squared < least) {
                least = squared;
                best = i;
            }
        });
        if (least < INFINITY || radius > 1e3f) {
            return best;
        }
    }
}

/// [m]; about the vertex spacing, with a bounded number of cells for a surface of any size.
float cell_of(const std::vector<Vec3f>& vertices) {
    constexpr float usual = 2e-3f, most_along_an_axis = 150.0f;
    Vec3f low = Vec3f::Constant(INFINITY), high = -low;
    for (const Vec3f& vertex : vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    return vertices.empty() ? usual : std::max(usual, (high - low).maxCoeff() / most_along_an_axis);
}

/// Simplified; each vertex takes skinning and tissue from the nearest vertex of the surface.
ordered_json surface_json(const Surface& surface) {
    const std::size_t budget = surface.name == "body"     ? body_triangles
                               : surface.name == "tongue" ? tongue_triangles
                                                          : other_triangles;
    TriangleMesh mesh = surface.mesh;
    if (mesh.triangles.size() > budget) {
        mesh = simplify(mesh, {.triangles = budget});
    }
    std::vector<Tissue> tissue(surface.mesh.vertices.size(), surface.tissue);
    for (std::size_t t = 0; t < surface.triangle_tissue.size(); ++t) {
        for (const std::uint32_t v : surface.mesh.triangles[t]) {
            tissue[v] = surface.triangle_tissue[t];
        }
    }
    const float cell = cell_of(surface.mesh.vertices);
    const PointGrid grid(surface.mesh.vertices, cell);
    std::vector<float> rest;
    std::vector<std::uint16_t> frames;
    std::vector<std::uint8_t> weights, tissues;
    for (const Vec3f& vertex : mesh.vertices) {
        append(rest, vertex);
        const std::size_t same = nearest(grid, vertex, cell);
        const SkinWeights& skin = surface.skin[same];
        frames.insert(frames.end(), skin.frame.begin(), skin.frame.end());
        for (const float weight : skin.weight) {
            weights.push_back(
                static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(weight, 0.0f, 1.0f))));
        }
        tissues.push_back(static_cast<std::uint8_t>(tissue[same]));
    }
    std::vector<std::uint32_t> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        triangles.insert(triangles.end(), triangle.begin(), triangle.end());
    }
    return {{"name", surface.name},     {"rest", packed(rest)},       {"triangles", packed(triangles)},
            {"frames", packed(frames)}, {"weights", packed(weights)}, {"tissues", packed(tissues)}};
}

std::int16_t quantised(float value, float quantum) {
    return static_cast<std::int16_t>(
        std::isfinite(value) ? std::clamp(std::round(value / quantum), -32767.0f, 32767.0f) : 0.0f);
}

/// Each frame's displacement from rest and its rotation x y z w; each posture as the difference to the
/// previous one.
ordered_json postures_json(const session::SessionReader& reader, const std::vector<Vec3f>& rest) {
    constexpr std::size_t numbers = 7;
    const std::vector<session::DeformationRecord> records = reader.deformations();
    const std::size_t stride = std::max<std::size_t>(1, (records.size() + max_postures - 1) / max_postures);
    std::vector<std::int16_t> now(numbers * rest.size(), 0), shown(now.size(), 0), differences;
    for (std::size_t frame = 0; frame < rest.size(); ++frame) {
        now[numbers * frame + 6] = 32767;
    }
    std::vector<double> time;
    for (std::size_t i = 0; i < records.size(); ++i) {
        for (std::size_t k = 0; k < records[i].frame.size(); ++k) {
            const std::size_t frame = records[i].frame[k];
            if (frame >= rest.size()) {
                continue;
            }
            const FramePose& pose = records[i].pose[k];
            const Vec3f shift = pose.centre - rest[frame];
            const Quatf& q = pose.rotation;
            // The nearer of a rotation's two quaternions, to keep differences small.
            const float sign = q.w() < 0 ? -1.0f : 1.0f;
            std::int16_t* const out = &now[numbers * frame];
            for (int axis = 0; axis < 3; ++axis) {
                out[axis] = quantised(shift[axis], centre_quantum);
                out[3 + axis] = quantised(sign * q.vec()[axis], rotation_quantum);
            }
            out[6] = quantised(sign * q.w(), rotation_quantum);
        }
        if ((i + 1) % stride != 0 && i + 1 != records.size()) {
            continue;
        }
        time.push_back(1e-9 * static_cast<double>(records[i].time_ns));
        for (std::size_t j = 0; j < now.size(); ++j) {
            differences.push_back(static_cast<std::int16_t>(now[j] - shown[j]));
        }
        shown = now;
    }
    return {{"time_s", time},
            {"centre_quantum_m", centre_quantum},
            {"rotation_quantum", rotation_quantum},
            {"differences", deflated(differences)}};
}

/// The laryngoscope's pose (x y z, quaternion x y z w) and the tube's centre line, where finite.
ordered_json tools_json(const session::SessionReader& reader, const session::SceneRecord& scene) {
    const std::vector<session::StepRecord> steps = reader.steps();
    const std::size_t stride = std::max<std::size_t>(6, (steps.size() + max_poses - 1) / max_poses);
    std::vector<double> time;
    std::vector<float> laryngoscope, tube;
    for (std::size_t i = 0; i < steps.size(); i += stride) {
        const session::StepRecord& step = steps[i];
        if (!is_valid_pose(step.proxy) || step.tube_nodes.size() != scene.tube_nodes ||
            !std::ranges::all_of(step.tube_nodes, [](const Vec3f& node) { return node.allFinite(); })) {
            continue;
        }
        time.push_back(1e-9 * static_cast<double>(step.time_ns));
        append(laryngoscope, step.proxy.translation);
        append(laryngoscope, step.proxy.rotation.vec());
        laryngoscope.push_back(step.proxy.rotation.w());
        for (const Vec3f& node : step.tube_nodes) {
            append(tube, node);
        }
    }
    std::vector<float> vertices;
    std::vector<std::uint32_t> triangles;
    for (const Vec3f& vertex : scene.laryngoscope.vertices) {
        append(vertices, vertex);
    }
    for (const Triangle& triangle : scene.laryngoscope.triangles) {
        triangles.insert(triangles.end(), triangle.begin(), triangle.end());
    }
    const Blade blade = scene.blade == name_of(Blade::miller_0) ? Blade::miller_0 : Blade::miller_1;
    return {{"time_s", time},
            {"vertices", packed(vertices)},
            {"triangles", packed(triangles)},
            {"blade_length_m", make_laryngoscope(blade).blade_length},
            {"tube_diameter_m", scene.tube_outer_diameter},
            {"tube_nodes", scene.tube_nodes},
            {"laryngoscope", packed(laryngoscope)},
            {"tube", packed(tube)}};
}

}  // namespace

ordered_json anatomy_json(const session::SessionReader& reader) {
    const session::SceneRecord scene = reader.scene();
    std::vector<float> centres;
    for (const Vec3f& centre : scene.frame_rest_centre) {
        append(centres, centre);
    }
    ordered_json out{{"frame_rest_centre", packed(centres)}, {"surfaces", ordered_json::array()}};
    for (const Surface& surface : scene.surfaces) {
        out["surfaces"].push_back(surface_json(surface));
    }
    for (const session::PointRecord& point : scene.landmarks) {
        out["landmarks"][point.name] = {point.rest.x(), point.rest.y(), point.rest.z()};
    }
    out["postures"] = postures_json(reader, scene.frame_rest_centre);
    out["tools"] = tools_json(reader, scene);
    return out;
}

}  // namespace eti::review
