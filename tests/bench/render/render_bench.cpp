// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/render_bench.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/render/views/view_table.hpp"
#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "common/model/tools/lip_retraction.hpp"
#include "common/process/files/folder.hpp"
#include "common/process/stop_signal.hpp"
#include "common/scenario/data_file.hpp"
#include "server/metrics/glottic_view.hpp"
#include "tests/bench/render/attempt.hpp"
#include "tests/bench/render/attempt_scene.hpp"
#include "tests/bench/render/contact_sheet.hpp"
#include "tests/bench/render/cost.hpp"
#include "tests/bench/render/measures.hpp"
#include "tests/bench/render/surface_faults.hpp"

namespace eti::bench {

namespace {

// From issue and paper: requirements on a picture. A goal is an upper bound, except for outlines.
struct Goal {
    const char* measure;
    const char* unit;
    double bound;
    bool at_least;
    const char* meaning;
};
constexpr std::array goals = {
    Goal{"back_faces", "%", 0.02, false, "pixels that show a surface from behind"},
    Goal{"blade_in_tissue", "%", 0.02, false, "pixels in which the blade's face lies within tissue"},
    Goal{"edge_stretch", "", 3.0, false, "longest edge against its rest length, before contact"},
    Goal{"lumen_to_cords", "", 0.4, false, "luminance of the lumen against the cords', at best view"},
    Goal{"lumen_to_tongue", "", 1.0, false, "the same against the tongue's"},
    Goal{"clipped", "%", 3.0, false, "pixels of a lens's picture that are as bright as a channel can be"},
    Goal{"fine_outline", "%", 50.0, true, "an organ's outline in edges under 10 pixels at 1080p"},
    Goal{"open_contours", "", 0.0, false, "contours of the section that are not closed"},
    Goal{"open_edges", "", 0.0, false, "open edges of a surface in a lens's view"},
    Goal{"crossings", "", 0.0, false, "pairs of triangles in a lens's view that pass through each other"},
    Goal{"pogo_apart", "points", 3.0, false, "POGO of the picture against the server's rays"},
    Goal{"golden_apart", "%", 2.0, false, "pixels that differ from the golden picture by 24 levels"},
    Goal{"kilobytes", "kB", 150.0, false, "sent to the graphics card for a picture"},
    Goal{"vertices_apart", "mm", 0.1, false, "drawn vertices from the server's surface"},
};

const Goal& goal_of(std::string_view measure) {
    return *std::ranges::find(goals, measure, &Goal::measure);
}

/// Rows of the table, and each measure against its goal.
class Results {
  public:
    explicit Results(const std::filesystem::path& file) : path_(file), stream_(file) {
        if (!stream_) {
            throw std::runtime_error("cannot write " + file.string() + "; choose another folder with --out");
        }
        stream_ << "scenario,operator,moment,view,measure,value,goal,met,where" << std::endl;
    }

    /// `where` in words, without commas.
    void add(std::string_view scenario, std::string_view script, std::string_view moment,
             std::string_view view, std::string_view measure, double value, std::string_view where = "") {
        if (!std::isfinite(value)) {
            return;
        }
        const Goal& goal = goal_of(measure);
        const bool met = goal.at_least ? value >= goal.bound : value <= goal.bound;
        stream_ << fmt::format("{},{},{},{},{},{:.6g},{:g},{},{}", scenario, script, moment, view, measure,
                               value, goal.bound, met ? "yes" : "no", where)
                << std::endl;
        Standing& s = standings_[goal.measure];
        ++s.cases;
        s.met += met ? 1 : 0;
        const bool worse = s.cases == 1 || (goal.at_least ? value < s.worst : value > s.worst);
        if (worse) {
            s.worst = value;
            s.where = fmt::format("{} {} {} {}{}{}", scenario, script, moment, view,
                                  where.empty() ? "" : ", ", where);
        }
    }

    /// Each measure against its goal, on standard output and as a table.
    void conclude(const std::filesystem::path& file) const {
        std::ofstream table(file);
        table << "measure,unit,goal,worst,met,cases,meaning,where\n";
        fmt::print("{:<16} {:>10} {:>10}  {:>9}  {}\n", "measure", "worst", "goal", "met",
                   "where the worst is");
        for (const Goal& goal : goals) {
            const auto found = standings_.find(goal.measure);
            if (found == standings_.end()) {
                continue;
            }
            const Standing& s = found->second;
            const std::string bound =
                fmt::format("{} {:g}", goal.at_least ? "at least" : "at most", goal.bound);
            table << fmt::format("{},{},{},{:.3g},{},{},\"{}\",\"{}\"\n", goal.measure, goal.unit, bound,
                                 s.worst, s.met, s.cases, goal.meaning, s.where);
            fmt::print("{:<16} {:>10.3g} {:>13}  {:>4}/{:<4}  {}\n", goal.measure, s.worst, bound, s.met,
                       s.cases, s.where);
        }
        table.close();
        if (!table) {
            throw std::runtime_error(file.string() + ": cannot be written; is the disk full?");
        }
        fmt::print("tables: {}, {}\n", path_.string(), file.string());
    }

  private:
    struct Standing {
        int cases = 0, met = 0;
        double worst = 0.0;
        std::string where;
    };
    std::filesystem::path path_;
    std::ofstream stream_;
    std::map<std::string, Standing, std::less<>> standings_;
};

/// Draws views off screen, with outlines as fine as in `high`.
class PictureMaker {
  public:
    PictureMaker(int width, int height) : target_(width, height, 1), quality_(render::affordable_quality()) {
        quality_.fine_outlines = true;
    }

    [[nodiscard]] render::Image draw(const render::View& view, const view::SceneView& scene,
                                     render::Shading shading = render::Shading::lit) {
        renderer_.sync(scene);
        renderer_.draw(view, scene, target_, {0, 0, target_.width(), target_.height()}, {}, shading);
        return target_.read();
    }

    [[nodiscard]] const render::PatientMesh& patient() const { return renderer_.meshes().patient(); }

  private:
    render::RenderTarget target_;
    render::Quality quality_;
    render::SceneRenderer renderer_{quality_};
};

/// Before blade clearance, which client_render_test verifies with the same function; by surface and vertex.
using Apart = std::map<std::string, std::vector<double>>;
Apart vertex_errors_mm(const view::SceneView& scene, const Attempt& attempt, const KeyMoment& moment) {
    Apart apart;
    for (const Surface& surface : attempt.patient.surfaces) {
        const auto drawn = scene.surfaces().at(surface.name).vertices();
        for (std::size_t v = 0; v < surface.skin.size(); ++v) {
            const Vec3f server = skin_point(surface.mesh.vertices[v], surface.skin[v],
                                            attempt.patient.frame_rest_centre, moment.snapshot.frames);
            apart[surface.name].push_back(1e3 * static_cast<double>((drawn[v].position - server).norm()));
        }
    }
    return apart;
}

double max_error(const Apart& apart) {
    double most = 0.0;
    for (const auto& [name, values] : apart) {
        most = std::max(most, std::ranges::max(values));
    }
    return most;
}

/// Maximum over the vertices that a view adds: displacement from their triangle's corners, and offset from
/// its plane.
double max_added_error_mm(const MeshSet& drawn, const Apart& apart) {
    double most = 0.0;
    for (const SurfaceMesh& shape : drawn.organs) {
        for (const SurfaceMesh::Added& added : shape.added) {
            double sum = 1e3 * static_cast<double>(added.bend);
            for (std::size_t k = 0; k < 3; ++k) {
                sum += static_cast<double>(added.shares[static_cast<int>(k)]) *
                       apart.at(shape.name)[added.corners[k]];
            }
            most = std::max(most, sum);
        }
    }
    return most;
}

/// Camera on the glottis from an eye; its picture is that eye's view.
render::Camera towards_glottis(const Vec3f& eye, const Landmarks& landmarks) {
    render::Camera camera;
    camera.eye = eye;
    camera.target = at(landmarks, Landmark::glottis);
    camera.vertical_fov = 5.0f * degree;
    camera.near_plane = 0.03f;
    camera.far_plane = 0.8f;
    return camera;
}

class Bench {
  public:
    explicit Bench(const RenderOptions& options)
        : options_(options), results_(options.out / "render.csv"), artist_(options.width, options.height) {}

    void look_at(const Attempt& attempt) {
        const std::string scenario = attempt.scenario.name, script = attempt.script.name;
        const view::SceneView rest = scene_of(attempt);
        ContactSheet sheet(render::views().size(), options_.width, options_.height);
        for (std::size_t m = 0; m < attempt.moments.size(); ++m) {
            if (stop_requested() || !attempt.moments[m]) {
                continue;
            }
            const KeyMoment& moment = *attempt.moments[m];
            const view::SceneView scene = scene_of(rest, moment);
            const MeshSet shapes = meshes_of(scene);
            const auto add = [&](std::string_view view, std::string_view measure, double value,
                                 std::string_view where = "") {
                results_.add(scenario, script, moment_names[m], view, measure, value, where);
            };
            const Apart apart = vertex_errors_mm(scene, attempt, moment);
            add("all", "vertices_apart", max_error(apart));
            if (m < touch) {
                const Stretch stretch = edge_stretch(shapes);
                add("all", "edge_stretch", stretch.ratio, stretch.where);
            }
            for (const Contours& c : section_contours(shapes, Vec3f::Zero(), Vec3f::UnitX())) {
                add("section", "open_contours", c.open, c.name);
            }
            for (std::size_t v = 0; v < render::views().size(); ++v) {
                const render::View& view = render::views()[v];
                measure_view(attempt, moment, m, view, scene, shapes, apart, add, sheet, v);
            }
            if (m == best) {
                compare_eyes(attempt, moment, scene, shapes, add);
            }
            if (m == touch || m == best || m == tube) {
                look_around(scene, add);
            }
            if (m == start || m == best || m == tube) {
                survey(scene, shapes, m == start, add);
            }
        }
        if (options_.pictures) {
            sheet.write(options_.out / fmt::format("{}_{}.png", scenario, script));
        }
    }

    /// Drawing cost while the blade lifts the tongue.
    void measure_costs(const Attempt& attempt) {
        if (!attempt.moments[touch] || !attempt.moments[best]) {
            return;
        }
        const view::SceneView rest = scene_of(attempt);
        const view::SceneView a = scene_of(rest, *attempt.moments[touch]),
                              b = scene_of(rest, *attempt.moments[best]);
        std::ofstream table(options_.out / "render-costs.csv");
        table << "driver,quality,width,height,view,sync_ms,draw_ms,cpu_ms,slowest_ms,kilobytes\n";
        const render::Quality* const named = render::quality_named(options_.quality);
        const render::Quality& quality = named != nullptr ? *named : render::affordable_quality();
        std::vector<std::pair<int, int>> sizes{{960, 540}, {1920, 1080}, {2880, 1600}};
        if (options_.only_costs) {
            sizes = {{options_.width, options_.height}};
        }
        for (const auto& [width, height] : sizes) {
            for (const Cost& cost : costs(a, b, width, height, options_.costs, quality)) {
                table << fmt::format("\"{}\",{},{},{},{},{:.3g},{:.4g},{:.4g},{:.4g},{:.4g}\n",
                                     render::driver_name(), quality.name, width, height, cost.view,
                                     cost.sync_ms, cost.draw_ms, cost.cpu_ms, cost.slowest_ms,
                                     cost.kilobytes);
                results_.add(attempt.scenario.name, attempt.script.name, "lift", cost.view, "kilobytes",
                             cost.kilobytes);
            }
        }
    }

    void conclude() const { results_.conclude(options_.out / "render-goals.csv"); }

  private:
    static constexpr std::size_t start = 0, mouth = 1, touch = 2, best = 3, tube = 4;

    template <typename Add>
    void measure_view(const Attempt& attempt, const KeyMoment& moment, std::size_t m,
                      const render::View& view, const view::SceneView& scene, const MeshSet& shapes,
                      const Apart& apart, Add&& add, ContactSheet& sheet, std::size_t v) {
        const render::Camera camera = view.camera(scene, {});
        if (options_.pictures || m == best || !options_.golden.empty()) {
            const render::Image picture = artist_.draw(view, scene);
            sheet.put(m, v, picture);
            if (!options_.golden.empty() && (m == mouth || m == best)) {
                compare_golden(attempt, picture, m, view, add);
            }
            if (options_.pictures) {
                const std::string name = fmt::format("{}_{}_{}_{}.png", attempt.scenario.name,
                                                     attempt.script.name, moment_names[m], view.name);
                render::write_png(picture, options_.out / name);
                write_beside_before(name, picture);
            }
            // In a stereo picture, pixels do not match one camera's raster.
            if (m == best && view.lips_retracted && view.cameras(scene, {}).size() == 1) {
                const Raster raster =
                    raster_of(with_lips_retracted(shapes, lip_retraction(camera.eye, scene.landmarks())),
                              camera, options_.width, options_.height);
                // Beyond this a vignette takes more than half of the light.
                const float within = view.tone.vignette > 0.0f ? 1.1f : std::numeric_limits<float>::max();
                const Luminances light =
                    luminances(picture, raster, shapes, camera, moment.snapshot.glottis_contour, within);
                add(view.name, "lumen_to_cords", light.lumen / light.cords);
                add(view.name, "lumen_to_tongue", light.lumen / light.tongue);
            }
        }
        add(view.name, "back_faces",
            back_faces_percent(artist_.draw(view, scene, render::Shading::object_id_both_sides)));
        if (view.cut) {
            return;
        }
        // As drawn: retracted relative to the trainee's eye, wherever the camera is.
        const LipRetraction lips =
            lip_retraction(render::Vantage{}.eye.position(scene.landmarks()), scene.landmarks());
        const Eigen::Matrix4f view_projection =
            camera.projection(static_cast<float>(options_.width) / static_cast<float>(options_.height)) *
            camera.view();
        const MeshSet seen = with_fine_outlines(
            view.lips_retracted ? with_lips_retracted(shapes, lips) : shapes, artist_.patient(), scene,
            {view_projection, camera.eye, render::no_clipping, view.lips_retracted ? &lips : nullptr});
        add(view.name, "vertices_apart", max_added_error_mm(seen, apart));
        const Raster raster = raster_of(seen, camera, options_.width, options_.height);
        add(view.name, "blade_in_tissue",
            blade_in_tissue_percent(seen, camera, options_.width, options_.height));
        for (const Outline& outline : outlines(seen, raster, 10.0 * options_.height / 1080.0)) {
            add(view.name, "fine_outline", outline.fine_percent, outline.name);
        }
    }

    /// Seeded gazes of the blade's lens: a hole or a fold turned over shows as a back face. Only the worst of
    /// each is a row.
    template <typename Add>
    void look_around(const view::SceneView& scene, Add&& add) {
        Random random(50);
        static thread_local render::Camera gaze;
        render::View view = *render::view_named("laryngoscope");
        const render::Camera straight = view.camera(scene, {});
        view.cameras = [](const view::SceneView&, const render::Vantage&) {
            return std::vector<render::Camera>{gaze};
        };
        double back_faces = 0.0, clipped = 0.0;
        for (int i = 0; i < options_.eyes && !stop_requested(); ++i) {
            gaze = gaze_beside(straight, random);
            back_faces =
                std::max(back_faces,
                         back_faces_percent(lens_.draw(view, scene, render::Shading::object_id_both_sides)));
            clipped = std::max(clipped, clipped_percent(lens_.draw(view, scene)));
        }
        const std::string where = fmt::format("worst of {} gazes", options_.eyes);
        add("lens", "back_faces", back_faces, where);
        add("lens", "clipped", clipped, where);
    }

    /// Seeded poses of a lens: before the blade is in, as it looks around later.
    template <typename Add>
    void survey(const view::SceneView& scene, const MeshSet& shapes, bool without_blade, Add&& add) {
        constexpr int moments = 3, width = 640, height = 360;
        const int poses = (options_.poses + moments - 1) / moments;
        const render::Camera lens = render::view_named("laryngoscope")->camera(scene, {});
        const SurfaceFaults faults(shapes);
        Random random(50'50);
        SurfaceFaults::Count worst;
        int faulty = 0;
        for (int i = 0; i < poses && !stop_requested(); ++i) {
            const render::Camera gaze = without_blade
                                            ? gaze_in_throat(shapes, scene.landmarks(), lens, random)
                                            : gaze_beside(lens, random);
            const SurfaceFaults::Count seen = faults.in_view(raster_of(shapes, gaze, width, height), gaze);
            worst.open_edges = std::max(worst.open_edges, seen.open_edges);
            worst.crossings = std::max(worst.crossings, seen.crossings);
            faulty += seen.open_edges + seen.crossings > 0 ? 1 : 0;
        }
        if (poses > 0) {
            const std::string where = fmt::format("worst of {} poses; {} show any", poses, faulty);
            add("lens", "open_edges", worst.open_edges, where);
            add("lens", "crossings", worst.crossings, where);
        }
    }

    void write_beside_before(const std::string& name, const render::Image& picture) const {
        constexpr int width = 640;
        const auto before = options_.before / name;
        if (options_.before.empty() || !std::filesystem::exists(before)) {
            return;
        }
        const int height = width * options_.height / options_.width;
        const auto folder = options_.out / "before_after";
        std::filesystem::create_directories(folder);
        render::write_png(side_by_side(downscaled(render::read_png(before), width, height),
                                       downscaled(picture, width, height)),
                          folder / name);
    }

    // An edge shifted by half a pixel is no fault: another processor's rounding causes it.
    template <typename Add>
    void compare_golden(const Attempt& attempt, const render::Image& picture, std::size_t m,
                        const render::View& view, Add&& add) {
        constexpr int width = 320, height = 180, levels = 24;
        const auto file = options_.golden / fmt::format("{}_{}_{}_{}.png", attempt.scenario.name,
                                                        attempt.script.name, moment_names[m], view.name);
        const render::Image small = downscaled(picture, width, height);
        if (options_.renew) {
            render::write_png(small, file);
        } else if (std::filesystem::exists(file)) {
            const double apart = differing_pixels_percent(small, render::read_png(file), levels);
            add(view.name, "golden_apart", apart);
        }
    }

    template <typename Add>
    void compare_eyes(const Attempt& attempt, const KeyMoment& moment, const view::SceneView& scene,
                      const MeshSet& shapes, Add&& add) {
        constexpr float reach = 20e-3f;       // [m], of the eyes around the best one, to each side
        constexpr float tolerance = 0.5e-3f;  // [m], as in the server's rays
        constexpr int side = 360;             // pixels
        metrics::GlotticViewer viewer(attempt.patient, attempt.scope,
                                      {.tube_radius = attempt.scenario.tube.outer_radius()});
        Random random(20'20);
        for (int i = 0; i < options_.eyes && !stop_requested(); ++i) {
            Vec3f aside;
            for (int axis = 0; axis < 3; ++axis) {
                aside[axis] = reach * (2.0f * random.uniform() - 1.0f);
            }
            const Vec3f eye = best_eye(scene.landmarks()) + (i == 0 ? Vec3f(Vec3f::Zero()) : aside);
            const render::Camera camera = towards_glottis(eye, scene.landmarks());
            const MeshSet aside_lips = with_lips_retracted(shapes, lip_retraction(eye, scene.landmarks()));
            const double seen = opening_in_picture(raster_of(aside_lips, camera, side, side), camera,
                                                   moment.snapshot.glottis_contour, tolerance);
            const double rays = viewer.evaluate(moment.snapshot, eye).opening_percent;
            add("eye", "pogo_apart", std::abs(seen - rays),
                fmt::format("picture {:.1f} rays {:.1f}", seen, rays));
        }
    }

    const RenderOptions& options_;
    Results results_;
    render::HeadlessContext context_;
    PictureMaker artist_;
    PictureMaker lens_{640, 360};  // of seeded gazes
};

}  // namespace

int render_bench(const RenderOptions& options) {
    make_folder(options.out);
    if (options.renew) {
        make_folder(options.golden, "--golden");
    } else if (!options.golden.empty() && !std::filesystem::is_directory(options.golden)) {
        throw std::runtime_error(options.golden.string() +
                                 ": there is no such folder of golden pictures; write them with --renew");
    }
    Bench bench(options);
    for (const std::string& scenario : options.scenarios) {
        for (const std::string& script : options.operators) {
            if (stop_requested()) {
                break;
            }
            spdlog::info("{} by {}", scenario, script);
            const Attempt attempt = record_attempt(load_scenario(find_data_file(scenario, "scenarios")),
                                                   load_operator(find_data_file(script, "operators")));
            spdlog::info("{} by {}: {}", scenario, script, attempt.reason);
            if (!options.only_costs) {
                bench.look_at(attempt);
            }
            if (options.costs > 0 && scenario == options.scenarios.front() &&
                script == options.operators.front()) {
                bench.measure_costs(attempt);
            }
        }
    }
    bench.conclude();
    return stop_requested() ? 1 : 0;
}

}  // namespace eti::bench
