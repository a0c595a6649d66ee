// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/measures.hpp"

#include <map>
#include <unordered_map>

#include "client/render/mesh/patient_outlines.hpp"
#include "client/view/displaced_vertices.hpp"
#include "common/math/units.hpp"

namespace eti::bench {

namespace {

constexpr float shortest_edge = 0.2e-3f;  // [m], edges from this rest length on count for stretch
constexpr double fewest_pixels = 20.0;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Eigen::Matrix4f projected(const render::Camera& camera, int width, int height) {
    return camera.projection(static_cast<float>(width) / static_cast<float>(height)) * camera.view();
}

/// Distance in front of the eye [m] for an OpenGL depth.
float distance_of(float depth, const render::Camera& camera) {
    const float n = camera.near_plane, f = camera.far_plane;
    return 2.0f * f * n / (f + n - (2.0f * depth - 1.0f) * (f - n));
}

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}

bool faces(const SurfaceMesh& shape, const Triangle& t, const Vec3f& eye) {
    const Vec3f& a = shape.vertices[t[0]];
    return (shape.vertices[t[1]] - a).cross(shape.vertices[t[2]] - a).dot(eye - a) > 0.0f;
}

double linear(std::uint8_t value) {
    const double c = value / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double luminance(const std::uint8_t* rgba) {
    return 0.2126 * linear(rgba[0]) + 0.7152 * linear(rgba[1]) + 0.0722 * linear(rgba[2]);
}

struct Mean {
    double sum = 0.0, count = 0.0;
    void add(double value) {
        sum += value;
        count += 1.0;
    }
    [[nodiscard]] double value() const { return count >= fewest_pixels ? sum / count : nan; }
};

/// Calls `pixel(x, y, depth, area)` over the triangle fan that fills a closed polygon; `area` [m2] is the
/// area that the pixel represents.
template <typename Pixel>
void fill(const Eigen::Matrix4f& view_projection, int width, int height, std::span<const Vec3f> contour,
          Pixel&& pixel) {
    Vec3f centre = Vec3f::Zero();
    for (const Vec3f& p : contour) {
        centre += p / static_cast<float>(contour.size());
    }
    for (std::size_t i = 0; i < contour.size(); ++i) {
        const std::array<Vec3f, 3> fan{centre, contour[i], contour[(i + 1) % contour.size()]};
        double count = 0.0;
        rasterise(view_projection, width, height, fan, [&](int, int, float) { count += 1.0; });
        const double area = 0.5 * (fan[1] - fan[0]).cross(fan[2] - fan[0]).norm();
        rasterise(view_projection, width, height, fan,
                  [&](int x, int y, float depth) { pixel(x, y, depth, area / count); });
    }
}

}  // namespace

MeshSet meshes_of(const view::SceneView& scene) {
    MeshSet shapes;
    for (const auto& [name, surface] : scene.surfaces()) {
        SurfaceMesh& shape = shapes.organs.emplace_back();
        shape.name = name;
        shape.tissue = surface.model().tissue;
        shape.bone = is_bone(shape.tissue);
        shape.triangles = surface.model().mesh.triangles;
        shape.triangle_tissue.assign(surface.model().triangle_tissue.begin(),
                                     surface.model().triangle_tissue.end());
        shape.rest = surface.model().mesh.vertices;
        for (const view::LitVertex& vertex : view::displaced_vertices(scene, surface)) {
            shape.vertices.push_back(vertex.position);
        }
    }
    if (scene.laryngoscope() && scene.laryngoscope_pose()) {
        shapes.blade_triangles = scene.laryngoscope()->triangles;
        for (const Vec3f& p : scene.laryngoscope()->vertices) {
            shapes.blade.push_back(*scene.laryngoscope_pose() * p);
        }
    }
    if (scene.tube() != nullptr) {
        shapes.tube_triangles = scene.tube()->triangles();
        for (const auto& vertex : scene.tube()->vertices()) {
            shapes.tube.push_back(vertex.position);
        }
    }
    return shapes;
}

MeshSet with_lips_retracted(MeshSet shapes, const LipRetraction& lips) {
    for (SurfaceMesh& shape : shapes.organs) {
        for (Vec3f& vertex : shape.vertices) {
            vertex = lips.retract_lips(vertex);
        }
    }
    return shapes;
}

MeshSet with_fine_outlines(MeshSet shapes, const render::PatientMesh& patient, const view::SceneView& scene,
                           const render::PatientMesh::CullView& look) {
    render::PatientOutlines outlines;
    outlines.choose(patient, scene, look);
    const std::vector<view::LitVertex> drawn = patient.vertices();
    for (std::size_t i = 0; i < patient.parts().size(); ++i) {
        const render::PatientMesh::Part& part = patient.parts()[i];
        SurfaceMesh& shape = *std::ranges::find(shapes.organs, part.name, &SurfaceMesh::name);
        // Triangles in the shape's own order, by their corners.
        std::map<std::array<std::uint32_t, 3>, const render::TessellatedFace*> finer;
        for (const render::TessellatedFace& face : outlines.of(i)->faces()) {
            finer[face.corners] = &face;
        }
        std::map<std::array<std::uint32_t, 4>, std::uint32_t> on_edges;  // corners, step and steps
        std::vector<Triangle> triangles;
        std::vector<Tissue> tissues;
        for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
            std::array<std::uint32_t, 3> sorted = shape.triangles[t];
            std::ranges::sort(sorted);
            const auto found = finer.find(sorted);
            if (found == finer.end()) {
                triangles.push_back(shape.triangles[t]);
                tissues.push_back(shape.triangle_tissue[t]);
                continue;
            }
            const render::TessellatedFace& face = *found->second;
            std::array<view::LitVertex, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) {
                corners[k] = drawn[part.first_vertex + face.corners[k]];
            }
            const auto add = [&](const Vec3f& shares) {
                const Vec3f bent = render::curved_vertex(corners, shares).position;
                const Vec3f flat = shares.x() * corners[0].position + shares.y() * corners[1].position +
                                   shares.z() * corners[2].position;
                shape.vertices.push_back(look.lips != nullptr ? look.lips->retract_lips(bent) : bent);
                shape.added.push_back({face.corners, shares, (bent - flat).norm()});
                return static_cast<std::uint32_t>(shape.vertices.size() - 1);
            };
            const auto place = [&](int i_step, int j_step) {
                const Vec3f shares = render::barycentric_at(face, i_step, j_step);
                for (std::size_t k = 0; k < 3; ++k) {
                    if (shares[static_cast<int>(k)] == 1.0f) {
                        return face.corners[k];
                    }
                }
                constexpr std::array<std::array<std::size_t, 3>, 3> edges{{{0, 1, 2}, {1, 2, 0}, {0, 2, 1}}};
                for (std::size_t e = 0; e < 3; ++e) {
                    const auto [a, b, opposite] = edges[e];
                    if (shares[static_cast<int>(opposite)] == 0.0f) {
                        const std::uint32_t steps = face.steps[e];
                        const auto at = static_cast<std::uint32_t>(
                            std::lround(shares[static_cast<int>(b)] * static_cast<float>(steps)));
                        const auto [known, made] =
                            on_edges.try_emplace({face.corners[a], face.corners[b], at, steps}, 0u);
                        if (made) {
                            known->second = add(shares);
                        }
                        return known->second;
                    }
                }
                return add(shares);
            };
            std::vector<std::uint32_t> places;
            for (int j = 0; j <= face.grid(); ++j) {
                for (int i_step = 0; i_step <= face.grid() - j; ++i_step) {
                    places.push_back(place(i_step, j));
                }
            }
            for (const Triangle& small : render::grid_triangles(face.grid(), face.turned != 0)) {
                const Triangle moved{places[small[0]], places[small[1]], places[small[2]]};
                if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0]) {
                    triangles.push_back(moved);
                    tissues.push_back(shape.triangle_tissue[t]);
                }
            }
        }
        shape.triangles = std::move(triangles);
        shape.triangle_tissue = std::move(tissues);
    }
    return shapes;
}

Raster raster_of(const MeshSet& shapes, const render::Camera& camera, int width, int height) {
    Raster raster(width, height, projected(camera, width, height), camera.eye);
    for (std::size_t i = 0; i < shapes.organs.size(); ++i) {
        if (!shapes.organs[i].bone) {
            raster.draw(shapes.organs[i].triangles, shapes.organs[i].vertices, static_cast<std::int16_t>(i));
        }
    }
    raster.draw(shapes.blade_triangles, shapes.blade, MeshSet::blade_id);
    raster.draw(shapes.tube_triangles, shapes.tube, MeshSet::tube_id);
    return raster;
}

double back_faces_percent(const render::Image& ids) {
    std::vector<std::array<std::uint8_t, 3>> behind;
    for (std::size_t t = 0; t < tissue_count; ++t) {
        behind.push_back(render::back_colour(static_cast<Tissue>(t)));
    }
    int back = 0;
    for (std::size_t p = 0; p < ids.rgba.size(); p += 4) {
        const std::array<std::uint8_t, 3> colour{ids.rgba[p], ids.rgba[p + 1], ids.rgba[p + 2]};
        back += std::ranges::find(behind, colour) != behind.end() ? 1 : 0;
    }
    return 100.0 * back / (ids.width * ids.height);
}

double blade_in_tissue_percent(const MeshSet& shapes, const render::Camera& camera, int width, int height) {
    const Eigen::Matrix4f view_projection = projected(camera, width, height);
    Raster blade(width, height, view_projection, camera.eye);
    blade.draw(shapes.blade_triangles, shapes.blade, MeshSet::blade_id);
    std::vector<std::uint8_t> within(blade.hits().size(), 0), hidden(blade.hits().size(), 0);
    std::vector<std::int8_t> entered(blade.hits().size());
    for (const SurfaceMesh& shape : shapes.organs) {
        if (shape.bone) {
            continue;
        }
        std::ranges::fill(entered, std::int8_t{0});
        for (const Triangle& t : shape.triangles) {
            const std::int8_t into = faces(shape, t, camera.eye) ? 1 : -1;
            rasterise(view_projection, width, height,
                      {shape.vertices[t[0]], shape.vertices[t[1]], shape.vertices[t[2]]},
                      [&](int x, int y, float depth) {
                          if (depth < blade.at(x, y).depth && blade.at(x, y).object >= 0) {
                              const auto i = static_cast<std::size_t>(y * width + x);
                              entered[i] += into;
                              hidden[i] |= into < 0 ? 1 : 0;
                          }
                      });
        }
        for (std::size_t i = 0; i < entered.size(); ++i) {
            if (entered[i] > 0) {
                within[i] = 1;
            }
        }
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < within.size(); ++i) {
        count += within[i] != 0 && hidden[i] == 0 ? 1 : 0;
    }
    return 100.0 * static_cast<double>(count) / static_cast<double>(within.size());
}

Stretch edge_stretch(const MeshSet& shapes) {
    Stretch most;
    for (const SurfaceMesh& shape : shapes.organs) {
        if (shape.bone) {
            continue;
        }
        for (const Triangle& t : shape.triangles) {
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t a = t[i], b = t[(i + 1) % 3];
                const float rest = (shape.rest[a] - shape.rest[b]).norm();
                const double ratio = (shape.vertices[a] - shape.vertices[b]).norm() / rest;
                if (rest >= shortest_edge && ratio > most.ratio) {
                    const Vec3f place = 1e3f * shape.rest[a];
                    most = {ratio, shape.name + " at " + std::to_string(std::lround(place.x())) + " " +
                                       std::to_string(std::lround(place.y())) + " " +
                                       std::to_string(std::lround(place.z())) + " mm"};
                }
            }
        }
    }
    return most;
}

std::vector<Outline> outlines(const MeshSet& shapes, const Raster& raster, double pixels) {
    std::vector<Outline> all;
    for (std::size_t o = 0; o < shapes.organs.size(); ++o) {
        const SurfaceMesh& shape = shapes.organs[o];
        if (shape.bone) {
            continue;
        }
        std::unordered_map<std::uint64_t, int> towards;  // number of front-facing triangles at an edge
        for (const Triangle& t : shape.triangles) {
            const int toward = faces(shape, t, raster.eye()) ? 1 : 0;
            for (std::size_t i = 0; i < 3; ++i) {
                towards[edge_key(t[i], t[(i + 1) % 3])] += toward;
            }
        }
        double fine = 0.0, length = 0.0;
        for (const auto& [key, count] : towards) {
            if (count != 1) {
                continue;
            }
            const auto seen = [&](const Vec3f& p) -> Eigen::Vector3f {
                const Eigen::Vector4f clip = raster.view_projection() * p.homogeneous();
                if (clip.w() <= 0.0f) {
                    return Eigen::Vector3f::Constant(2.0f);
                }
                return clip.head<3>() / clip.w();
            };
            const Eigen::Vector3f a = seen(shape.vertices[key >> 32]);
            const Eigen::Vector3f b = seen(shape.vertices[key & 0xffffffffu]);
            const Eigen::Vector3f middle = 0.5f * (a + b);
            if (middle.head<2>().cwiseAbs().maxCoeff() >= 1.0f || middle.z() >= 1.0f || middle.z() <= -1.0f) {
                continue;
            }
            const int x = static_cast<int>(0.5f * (1.0f + middle.x()) * static_cast<float>(raster.width()));
            const int y = static_cast<int>(0.5f * (1.0f - middle.y()) * static_cast<float>(raster.height()));
            // Nothing lies clearly in front of it: an outline's own pixel may show its immediate
            // surroundings.
            bool hidden = raster.at(x, y).object != static_cast<std::int16_t>(o) &&
                          raster.at(x, y).depth < 0.5f * (1.0f + middle.z()) - 1e-4f;
            if (hidden) {
                continue;
            }
            const Eigen::Vector2f half(0.5f * static_cast<float>(raster.width()),
                                       0.5f * static_cast<float>(raster.height()));
            const double long_px = (b - a).head<2>().cwiseProduct(half).norm();
            length += long_px;
            fine += long_px < pixels ? long_px : 0.0;
        }
        if (length >= 2.0 * pixels) {
            all.push_back({shape.name, 100.0 * fine / length, length});
        }
    }
    return all;
}

std::vector<Contours> section_contours(const MeshSet& shapes, const Vec3f& origin, const Vec3f& normal) {
    std::vector<Contours> all;
    for (const SurfaceMesh& shape : shapes.organs) {
        // A contour passes from edge to edge of the mesh, two per triangle cut by the plane.
        std::map<std::uint64_t, std::vector<std::uint64_t>> next;
        const auto above = [&](std::uint32_t v) { return normal.dot(shape.vertices[v] - origin) > 0.0f; };
        for (const Triangle& t : shape.triangles) {
            std::vector<std::uint64_t> cut;
            for (std::size_t i = 0; i < 3; ++i) {
                if (above(t[i]) != above(t[(i + 1) % 3])) {
                    cut.push_back(edge_key(t[i], t[(i + 1) % 3]));
                }
            }
            if (cut.size() == 2) {
                next[cut[0]].push_back(cut[1]);
                next[cut[1]].push_back(cut[0]);
            }
        }
        Contours contours{.name = shape.name};
        std::map<std::uint64_t, bool> visited;
        for (const auto& [start, neighbours] : next) {
            if (visited[start]) {
                continue;
            }
            bool closed = true;
            std::vector<std::uint64_t> reach{start};
            visited[start] = true;
            while (!reach.empty()) {
                const std::uint64_t at = reach.back();
                reach.pop_back();
                closed &= next[at].size() == 2;
                for (const std::uint64_t to : next[at]) {
                    if (!visited[to]) {
                        visited[to] = true;
                        reach.push_back(to);
                    }
                }
            }
            ++(closed ? contours.closed : contours.open);
        }
        if (contours.closed + contours.open > 0) {
            all.push_back(contours);
        }
    }
    return all;
}

double opening_in_picture(const Raster& raster, const render::Camera& camera, std::span<const Vec3f> contour,
                          float tolerance) {
    double seen = 0.0, whole = 0.0;
    fill(raster.view_projection(), raster.width(), raster.height(), contour,
         [&](int x, int y, float depth, double area) {
             whole += area;
             if (distance_of(raster.at(x, y).depth, camera) > distance_of(depth, camera) - tolerance) {
                 seen += area;
             }
         });
    return whole > 0.0 ? 100.0 * seen / whole : nan;
}

Luminances luminances(const render::Image& picture, const Raster& raster, const MeshSet& shapes,
                      const render::Camera& camera, std::span<const Vec3f> contour, float within) {
    constexpr float below = 0.5e-3f;  // [m]
    Mean cords, lumen, tongue;
    std::vector<std::uint8_t> in_opening(raster.hits().size(), 0);
    fill(raster.view_projection(), raster.width(), raster.height(), contour,
         [&](int x, int y, float depth, double) {
             if (distance_of(raster.at(x, y).depth, camera) > distance_of(depth, camera) + below) {
                 in_opening[static_cast<std::size_t>(y * raster.width() + x)] = 1;
             }
         });
    const auto opens = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < raster.width() && y < raster.height() &&
               in_opening[static_cast<std::size_t>(y * raster.width() + x)] != 0;
    };
    for (int y = 0; y < raster.height(); ++y) {
        for (int x = 0; x < raster.width(); ++x) {
            const Hit& hit = raster.at(x, y);
            if (std::hypot(2 * x - raster.width(), 2 * y - raster.height()) >
                within * static_cast<float>(raster.height())) {
                continue;
            }
            const double light = luminance(picture.pixel(x, y));
            if (opens(x, y)) {
                // Antialiasing mixes pixels at the border with the cords.
                if (opens(x - 1, y) && opens(x + 1, y) && opens(x, y - 1) && opens(x, y + 1)) {
                    lumen.add(light);
                }
            } else if (hit.object >= 0 && hit.object < MeshSet::blade_id) {
                const SurfaceMesh& shape = shapes.organs[static_cast<std::size_t>(hit.object)];
                const std::string_view tissue = name_of(shape.triangle_tissue[hit.triangle]);
                if (tissue == "vocal cord") {
                    cords.add(light);
                } else if (tissue == "tongue") {
                    tongue.add(light);
                }
            }
        }
    }
    return {cords.value(), lumen.value(), tongue.value()};
}

double clipped_percent(const render::Image& picture) {
    constexpr std::uint8_t brightest = 255;
    int clipped = 0;
    for (std::size_t p = 0; p < picture.rgba.size(); p += 4) {
        const std::uint8_t* const colour = picture.rgba.data() + p;
        clipped += std::max({colour[0], colour[1], colour[2]}) == brightest ? 1 : 0;
    }
    return 100.0 * clipped / (picture.width * picture.height);
}

double differing_pixels_percent(const render::Image& a, const render::Image& b, int levels) {
    if (a.width != b.width || a.height != b.height) {
        return 100.0;
    }
    int apart = 0;
    for (std::size_t p = 0; p < a.rgba.size(); p += 4) {
        bool differs = false;
        for (std::size_t k = 0; k < 3; ++k) {
            differs |= std::abs(int{a.rgba[p + k]} - int{b.rgba[p + k]}) > levels;
        }
        apart += differs ? 1 : 0;
    }
    return 100.0 * apart / (a.width * a.height);
}

}  // namespace eti::bench
