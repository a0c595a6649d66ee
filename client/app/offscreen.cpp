// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/offscreen.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "client/app/hand_controls.hpp"
#include "client/app/pictures.hpp"
#include "client/app/session_input.hpp"
#include "client/render/headless_context.hpp"
#include "client/render/video.hpp"
#include "common/process/priority.hpp"
#include "common/process/stop_signal.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// A server that left the bus does not come back by itself; one that is merely slow does.
constexpr double gone_for_s = 1.0;
constexpr double silent_for_s = 15.0;
// Longer than this no picture is held in the video: simulation time that jumps is a new session.
constexpr std::int64_t longest_hold_s = 20;
constexpr int drawing_nice = 5;
// A server tells where all frames are within a second of being joined; on a bad link some may still be
// missing.
constexpr auto longest_without_shape = 3s;

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
    Offscreen(const Options& options, bus::Node& node)
        : options_(options),
          node_(node),
          // Frames are drawn at most at the video's rate; 30 Hz of shapes are enough for that.
          input_(node, options.frames_per_second > 30.0, options.is_trainee()),
          quality_(options.quality != nullptr ? *options.quality : render::affordable_quality()),
          compositor_(options.width, options.height, quality_),
          pictures_(options.offscreen) {
        if (options.hands) {
            hands_ = std::make_unique<HandControls>(node, options.play, options.tutorial);
        }
        if (!options.video.empty()) {
            video_ = std::make_unique<render::Video>(options.video, options.frames_per_second, options.width,
                                                     options.height);
        }
    }

    // False: no scene came.
    bool wait_for_scene() {
        auto deadline = Clock::now() + patience_;
        bool announced = false, deadline_of_shape = false;
        while (!scene_.shaped()) {
            input_.take_into(scene_);
            bus::refuse_other_protocol(node_);
            if (stop_asked()) {
                end_ = End::stopped;
                return true;
            }
            if (scene_.complete() && !deadline_of_shape) {
                deadline_of_shape = true;
                deadline = Clock::now() + longest_without_shape;
            } else if (input_.server_on_bus() && !scene_.complete()) {
                // It is there and still builds its patient: that may take longer than any fixed time.
                deadline = Clock::now() + patience_;
                if (!announced) {
                    spdlog::info("server found; waiting for its scene");
                    announced = true;
                }
            }
            if (Clock::now() > deadline) {
                return scene_.complete();
            }
            input_.wait(20ms);
        }
        spdlog::info("scene is complete: {} surfaces", scene_.surfaces().size());
        return true;
    }

    void follow() {
        while (end_ == End::none) {
            look();
            if (hands_ && hands_->look(scene_, selection())) {
                take_pictures_now(fmt::format("lesson_{}", hands_->lesson()));
            }
            end_ = why_to_end();
            if (end_ == End::none && !draw_if_due()) {
                input_.wait(10ms);
            }
        }
        if (end_ == End::finished) {
            // Shapes and status travel on different topics; let the last shapes arrive.
            for (const auto until = Clock::now() + 300ms; Clock::now() < until; input_.wait(20ms)) {
                look();
            }
        }
    }

    void finish() {
        if (scene_.complete()) {
            scene_.update();
            take_pictures(scene_, readout(), "final");
            if (video_) {
                compositor_.draw(selection().views(scene_), scene_, readout(), vantage_of(scene_), false,
                                 selection().arrangement);
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

    [[nodiscard]] nlohmann::json report() const {
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
        nlohmann::json report{
            {"session", options_.bus.session},
            {"view", std::string(options_.selection->name)},
            {"scenarios", input_.scenarios()},
            {"end", name_of(end_)},
            {"simulation_time_s", 1e-9 * static_cast<double>(scene_.simulation_time_ns())},
            {"frames", frames_},
            {"frames_drawn", drawn_},
            {"frames_held", held_},
            {"quality", std::string(quality_.name)},
            {"sync_ms", compositor_.sync_time().mean_ms()},
            {"draw_ms", times},
            {"best_glottic_opening_percent", best_.percent()},
            {"messages_dropped", scene_.dropped()},
            {"states_missed", input_.arrival().missed()},
            {"state_age_ms", {{"mean", input_.arrival().mean_ms()}, {"max", input_.arrival().most_ms()}}},
            {"pictures", pictures}};
        if (hands_) {
            report["hands"] = hands_->report();
        }
        if (video_) {
            report["video"] = {{"file", video_->file().string()},
                               {"frames", video_->frames()},
                               {"frames_per_second", options_.frames_per_second}};
        }
        return report;
    }

    [[nodiscard]] const render::Quality& quality() const { return quality_; }
    [[nodiscard]] End end() const { return end_; }
    [[nodiscard]] bool has_scene() const { return scene_.complete(); }

  private:
    [[nodiscard]] bool server_lost() const {
        return (input_.presence() == Presence::gone && input_.presence_for_s() > gone_for_s) ||
               (input_.presence() == Presence::silent && input_.presence_for_s() > silent_for_s);
    }

    [[nodiscard]] const Selection& selection() const {
        return hands_ ? hands_->shown(*options_.selection) : *options_.selection;
    }

    [[nodiscard]] hud::Readout readout() const {
        hud::Readout out = hud::readout_of(scene_, end_ == End::lost || input_.presence() == Presence::gone,
                                           node_.contested());
        if (hands_) {
            hands_->put_into(out);
        }
        return out;
    }

    /// An instructor looks through the trainee's eye.
    [[nodiscard]] render::Vantage vantage_of(const view::SceneView& scene) const {
        render::Vantage from = options_.vantage;
        if (options_.instructor && scene.trainees_eye()) {
            from.eye = view::TraineeEye::worn(*scene.trainees_eye());
        }
        return from;
    }

    [[nodiscard]] End why_to_end() const {
        if (stop_asked()) {
            return End::stopped;
        }
        if (scene_.status() && scene_.status()->phase() == msg::PHASE_FINISHED) {
            return End::finished;
        }
        if (options_.frames > 0 && frames_ >= options_.frames) {
            return End::enough_frames;
        }
        return server_lost() ? End::lost : End::none;
    }

    // Frames belong to ticks of simulation time. A tick that could not be drawn is held: the video
    // repeats the picture before, so that it keeps simulation time.
    bool draw_if_due() {
        const double time_s = 1e-9 * static_cast<double>(scene_.simulation_time_ns());
        const auto tick = static_cast<std::int64_t>(time_s * options_.frames_per_second);
        if (frames_ > 0 && tick == last_tick_) {
            return false;
        }
        const auto begin = Clock::now();
        const bool picture_due =
            options_.every_s > 0.0 && (frames_ == 0 || time_s >= next_picture_s_ || tick < last_tick_);
        if (video_) {
            scene_.update();
            compositor_.draw(selection().views(scene_), scene_, readout(), vantage_of(scene_), true,
                             selection().arrangement);
            add_to_video(tick);
            ++drawn_;
        }
        if (picture_due) {
            take_pictures_now("");
            next_picture_s_ = (std::floor(time_s / options_.every_s) + 1.0) * options_.every_s;
        }
        input_.publish_eye(scene_, options_.vantage.eye);
        ++frames_;
        last_tick_ = tick;
        const auto spent = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
        spdlog::debug("simulation time {:.2f} s drawn in {:.0f} ms", time_s, spent);
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

    void look() {
        input_.take_into(scene_);
        best_.consider(scene_);
    }

    /// Of the scene as it is now, which goes on meanwhile: what is seen best may last less than they take.
    void take_pictures_now(std::string_view occasion) {
        view::SceneView now = scene_;
        now.update();
        take_pictures(now, readout(), occasion, [this] { look(); });
    }

    /// The session is over: unless told otherwise, time is taken to draw them as well as it goes.
    void take_best_pictures(view::SceneView best) {
        best.update();
        if (options_.quality == nullptr) {
            compositor_.set_quality(render::qualities().back());
        }
        take_pictures(best, hud::readout_of(best, false), "best");
    }

    void take_pictures(const view::SceneView& scene, const hud::Readout& said, std::string_view occasion,
                       const std::function<void()>& between = {}) {
        pictures_.take(compositor_, selection(), scene, said, vantage_of(scene), occasion, between);
    }

    const Options& options_;
    const std::chrono::duration<double> patience_{options_.wait_s.value_or(Options::pictures_wait_s)};
    const bus::Node& node_;
    SessionInput input_;
    view::SceneView scene_;
    render::HeadlessContext context_;
    const render::Quality& quality_;  // of all but what is drawn when the session is over
    Compositor compositor_;
    Pictures pictures_;
    BestView best_;
    std::unique_ptr<HandControls> hands_;
    std::unique_ptr<render::Video> video_;
    render::Image last_image_;
    std::uint64_t frames_ = 0;            // that were due
    std::uint64_t drawn_ = 0, held_ = 0;  // into the video
    std::int64_t last_tick_ = -1;
    double next_picture_s_ = 0.0;
    End end_ = End::none;
};

}  // namespace

int run_offscreen(const Options& options, nlohmann::json& result) {
    prepare_folder(options.offscreen);
    bus::Node node(options.bus);
    // The software rasteriser would take every core, and nobody waits for these pictures. The bus's own
    // threads are held back less, or messages would pile up at their writers.
    yield_to_others(drawing_nice);
    Offscreen offscreen(options, node);
    spdlog::info("drawing with {}, quality {}", render::driver_name(), offscreen.quality().name);
    if (!offscreen.wait_for_scene()) {
        spdlog::error("no scene came within {} s (--wait): {}",
                      options.wait_s.value_or(Options::pictures_wait_s), bus::no_server(options.bus));
        return 1;
    }
    if (offscreen.has_scene()) {
        offscreen.follow();
    }
    if (offscreen.end() == End::lost) {
        spdlog::warn("the server is lost; keeping the last picture");
    }
    offscreen.finish();
    result = offscreen.report();
    spdlog::info("{}: {} pictures, {} frames drawn in {}", result["end"].get<std::string>(),
                 result["pictures"].size(), result["frames_drawn"].get<std::uint64_t>(),
                 options.offscreen.string());
    return 0;
}

}  // namespace eti::client
