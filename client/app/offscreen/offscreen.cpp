// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/offscreen/offscreen.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "client/app/client_session.hpp"
#include "client/app/offscreen/pictures.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/video.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Maximum time the video repeats a picture: a longer jump of simulation time is a new session.
constexpr std::int64_t longest_hold_s = 20;
constexpr int drawing_nice = 5;
// A server sends every frame within a second of a client's joining; on a bad link some may still be
// missing.
constexpr auto first_shape_timeout = 3s;

enum class End { none, finished, lost, stopped, enough_frames };

const char* name_of(End end) {
    switch (end) {
        case End::finished:
            return "finished";
        case End::lost:
            return "server lost";
        case End::stopped:
            return "stopped";
        case End::enough_frames:
            return "enough frames";
        case End::none:
            break;
    }
    return "running";
}

class Offscreen {
  public:
    Offscreen(const Options& options, ClientSession& client)
        : options_(options),
          client_(client),
          quality_(options.drawing_quality()),
          compositor_(options.width, options.height, quality_),
          pictures_(options.offscreen) {
        compositor_.set_text_scale(options.text_scale);
        if (!options.video.empty()) {
            video_ = std::make_unique<render::Video>(options.video, options.frames_per_second, options.width,
                                                     options.height);
        }
    }

    // Returns false if no scene arrived.
    bool wait_for_scene() {
        auto deadline = Clock::now() + patience_;
        bool announced = false, deadline_of_shape = false;
        while (!scene_.has_all_frames()) {
            client_.receive();
            if (stop_requested()) {
                end_ = End::stopped;
                return true;
            }
            if (scene_.complete() && !deadline_of_shape) {
                deadline_of_shape = true;
                deadline = Clock::now() + first_shape_timeout;
            } else if (client_.input.server_on_bus() && !scene_.complete()) {
                // The server is present and still builds its patient, which may take longer than any fixed
                // time.
                deadline = Clock::now() + patience_;
                if (!announced) {
                    spdlog::info("server found; waiting for the scene");
                    announced = true;
                }
            }
            if (Clock::now() > deadline) {
                return scene_.complete();
            }
            client_.input.wait(20ms);
        }
        spdlog::info("scene is complete: {} surfaces", scene_.surfaces().size());
        return true;
    }

    void follow() {
        while (end_ == End::none) {
            receive();
            if (client_.update(Clock::now())) {
                take_pictures_now(fmt::format("lesson_{}", client_.hands->lesson()));
            }
            end_ = why_to_end();
            if (end_ == End::none && !draw_if_due()) {
                client_.input.wait(10ms);
            }
        }
        if (end_ == End::finished) {
            // Deformation, status and the run's report are separate topics; wait for the last of each.
            const auto end = Clock::now();
            const auto within = [&](Clock::duration time) { return Clock::now() < end + time; };
            for (; within(300ms) || (!scene_.run_report() && within(3s)); client_.input.wait(20ms)) {
                receive();
            }
        }
    }

    void finish() {
        if (scene_.complete()) {
            scene_.update();
            take_pictures(scene_, readout(), "final");
            if (video_) {
                draw(false);
                video_->add(compositor_.target().read(),
                            static_cast<int>(std::ceil(options_.frames_per_second)));
            }
            if (best_.scene()) {
                take_best_pictures(*best_.scene());
            }
        }
        if (video_) {
            video_->finish();
        }
    }

    [[nodiscard]] nlohmann::json report() {
        nlohmann::json pictures = nlohmann::json::array();
        for (const auto& file : pictures_.files()) {
            pictures.push_back(file.string());
        }
        nlohmann::json times = nlohmann::json::object();
        for (std::size_t v = 0; v < compositor_.times().size(); ++v) {
            const DrawTime& time = compositor_.times()[v];
            if (time.frames > 0) {
                times[std::string(render::views()[v].name)] = time.mean_ms();
            }
        }
        nlohmann::json report = client_.report(name_of(end_), frames_);
        report.update({{"frames_drawn", drawn_},
                       {"frames_held", held_},
                       {"quality", std::string(quality_.name)},
                       {"sync_ms", compositor_.sync_time().mean_ms()},
                       {"draw_ms", times},
                       {"best_glottic_opening_percent", best_.percent()},
                       {"pictures", pictures}});
        if (video_) {
            report["video"] = {{"file", video_->file().string()},
                               {"frames", video_->frames()},
                               {"frames_per_second", options_.frames_per_second}};
        }
        return report;
    }

    [[nodiscard]] const render::Quality& quality() const { return quality_; }
    [[nodiscard]] bool has_scene() const { return scene_.complete(); }

  private:
    [[nodiscard]] hud::Readout readout() const { return client_.readout(Clock::now()); }

    void draw(bool measured) {
        const Selection& selection = client_.selection();
        compositor_.draw(selection.views(scene_), scene_, readout(), client_.controls.vantage(), measured,
                         selection.arrangement);
    }

    [[nodiscard]] End why_to_end() const {
        if (stop_requested()) {
            return End::stopped;
        }
        if (scene_.status() && scene_.status()->phase() == msg::PHASE_FINISHED) {
            return End::finished;
        }
        if (options_.frames > 0 && frames_ >= options_.frames) {
            return End::enough_frames;
        }
        return client_.lost ? End::lost : End::none;
    }

    // Frames belong to ticks of simulation time. For a tick that could not be drawn the video repeats the
    // previous picture, so that it stays in step with simulation time.
    bool draw_if_due() {
        const double time_s = 1e-9 * static_cast<double>(scene_.simulation_time_ns());
        const auto tick = static_cast<std::int64_t>(time_s * options_.frames_per_second);
        if (frames_ > 0 && tick == last_tick_) {
            return false;
        }
        const auto begin = Clock::now();
        const bool picture_due = options_.picture_interval_s > 0.0 &&
                                 (frames_ == 0 || time_s >= next_picture_s_ || tick < last_tick_);
        if (video_) {
            scene_.update();
            draw(true);
            add_to_video(tick);
            ++drawn_;
        }
        if (picture_due) {
            take_pictures_now("");
            next_picture_s_ =
                (std::floor(time_s / options_.picture_interval_s) + 1.0) * options_.picture_interval_s;
        }
        client_.input.publish_eye(scene_, client_.controls.vantage().eye);
        ++frames_;
        last_tick_ = tick;
        const auto spent = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
        spdlog::debug("simulation time {:.2f} s rendered in {:.0f} ms", time_s, spent);
        return true;
    }

    void add_to_video(std::int64_t tick) {
        const std::int64_t missed = frames_ > 0 ? tick - last_tick_ - 1 : 0;
        const auto longest = static_cast<std::int64_t>(options_.frames_per_second) * longest_hold_s;
        if (missed > 0 && missed <= longest) {
            video_->add(last_image_, static_cast<int>(missed));
            held_ += static_cast<std::uint64_t>(missed);
        }
        last_image_ = compositor_.target().read();
        video_->add(last_image_);
    }

    void receive() {
        client_.receive();
        best_.consider(scene_);
    }

    /// Draws the current scene from a copy, while the session continues: the best view may last less time
    /// than drawing takes.
    void take_pictures_now(std::string_view occasion) {
        view::SceneView now = scene_;
        now.update();
        take_pictures(now, readout(), occasion, [this] { receive(); });
    }

    /// After the session: by default drawn at the best quality, as there is time.
    void take_best_pictures(view::SceneView best) {
        best.update();
        if (options_.quality == nullptr) {
            compositor_.set_quality(render::qualities().back());
        }
        take_pictures(best, hud::make_readout(best, false), "best");
    }

    void take_pictures(const view::SceneView& scene, const hud::Readout& said, std::string_view occasion,
                       const std::function<void()>& between = {}) {
        client_.controls.follow(scene);  // its own trainee's eye, for an instructor
        pictures_.take(compositor_, client_.selection(), scene, said, client_.controls.vantage(), occasion,
                       between);
    }

    const Options& options_;
    const std::chrono::duration<double> patience_{options_.wait_s.value_or(Options::offscreen_wait_s)};
    ClientSession& client_;
    view::SceneView& scene_ = client_.scene;
    render::HeadlessContext context_;
    const render::Quality& quality_;  // for all pictures except those drawn after the session
    Compositor compositor_;
    PictureWriter pictures_;
    BestView best_;
    std::unique_ptr<render::Video> video_;
    render::Image last_image_;
    std::uint64_t frames_ = 0;            // number due
    std::uint64_t drawn_ = 0, held_ = 0;  // number drawn, and number repeated in the video
    std::int64_t last_tick_ = -1;
    double next_picture_s_ = 0.0;
    End end_ = End::none;
};

}  // namespace

int run_offscreen(const Options& options, nlohmann::json& result) {
    prepare_folder(options.offscreen);
    ClientSession client(options);
    // The software rasteriser would occupy every core, and these pictures are not urgent. The bus's own
    // threads are lowered less, as messages would otherwise pile up at their writers.
    lower_priority(drawing_nice);
    Offscreen offscreen(options, client);
    spdlog::info("rendering with {}, quality {}", render::driver_name(), offscreen.quality().name);
    if (!offscreen.wait_for_scene()) {
        spdlog::error("no scene received within {} s (--wait): {}",
                      options.wait_s.value_or(Options::offscreen_wait_s),
                      bus::missing_server_message(options.bus));
        return 1;
    }
    if (offscreen.has_scene()) {
        offscreen.follow();
    }
    offscreen.finish();
    result = offscreen.report();
    spdlog::info("{}: {} pictures, {} frames rendered in {}", result["end"].get<std::string>(),
                 result["pictures"].size(), result["frames_drawn"].get<std::uint64_t>(),
                 options.offscreen.string());
    return 0;
}

}  // namespace eti::client
