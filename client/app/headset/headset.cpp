// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/headset.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/app/client_session.hpp"
#include "client/app/headset/eye_compositor.hpp"
#include "client/app/headset/headset_panel.hpp"
#include "client/app/window/compositor.hpp"
#include "client/app/window/hand_keys.hpp"
#include "client/app/window/window.hpp"
#include "client/hmd/graphics.hpp"
#include "client/hmd/session.hpp"
#include "client/render/gl/headless_context.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int headset_nice = 5;
constexpr std::uint64_t frames_with_help = 900;  // 10 s of help on the hand controls
constexpr auto headset_poll_interval = 500ms;    // for a headset
constexpr auto runtime_retry_interval = 2000ms;  // for a lost runtime; OpenXR's loader logs each failure
constexpr auto hidden_poll_interval = 20ms;      // between events while the runtime wants no frames
constexpr auto exit_timeout = 2s;                // for a runtime that does not end the session

// Behind the patient at a comfortable distance for vergence, 0.7 to 1.5 m. Its small letters are 14 mm high
// there, the smallest that read well at a metre.
const hmd::Quad readout_quad{
    RigidTransform::from(Quatf(Eigen::AngleAxisf(0.1f, Vec3f::UnitX())), {0.0f, 0.10f, -1.0f}), 0.80f,
    0.80f * EyeCompositor::readout_height / EyeCompositor::readout_width};

// A window if there is a display, as a mirror for bystanders and for keys; otherwise none.
class Screen {
  public:
    Screen(const Options& options, bool egl) {
        if (std::getenv("DISPLAY") != nullptr || !egl) {
            window_.emplace(options.width, options.height, "NeoETI - " + options.bus.session);
            window_->disable_vsync();
        } else {
            no_window_.emplace();
        }
    }
    [[nodiscard]] Window* window() { return window_ ? &*window_ : nullptr; }

  private:
    std::optional<Window> window_;
    std::optional<render::HeadlessContext> no_window_;
};

class HeadsetClient {
  public:
    /// `egl`: the runtime supports headless contexts.
    HeadsetClient(const Options& options, bool egl)
        : options_(options),
          screen_(options, egl),
          client_(options),
          panel_(*client_.panel, options.panel),
          room_{options.gum_in_room} {}

    void run(std::optional<hmd::Runtime>& runtime) {
        bool absent = false;
        while (!over()) {
            try {
                if (!runtime) {
                    runtime.emplace();
                    spdlog::info("connected to the headset's runtime again: {}", runtime->name());
                }
                const auto headset = runtime->headset();
                if (headset) {
                    absent = false;
                    wear(*runtime, *headset);
                } else if (!absent) {
                    absent = true;
                    spdlog::info("{}: no headset found yet; waiting for one (Ctrl-C quits)", runtime->name());
                }
            } catch (const hmd::RuntimeUnavailable&) {
                if (ends_.empty()) {
                    throw;  // there was never a headset
                }
            } catch (const hmd::OpenXrError& failed) {
                if (!failed.runtime_lost() && !failed.headset_lost()) {
                    throw;
                }
                ended(failed.runtime_lost() ? hmd::SessionEnd::runtime_lost : hmd::SessionEnd::headset_lost);
            }
            if (!ends_.empty() && ends_.back() == hmd::SessionEnd::runtime_lost) {
                runtime.reset();
            }
            if (!over()) {
                idle(runtime ? headset_poll_interval : runtime_retry_interval);
            }
        }
        client_.finish();
    }

    [[nodiscard]] nlohmann::json report() {
        nlohmann::json out = client_.report(end(), frames_);
        out.update({{"view", "hmd"},
                    {"sessions", ends_.size()},
                    {"recentred", recentred_},
                    {"layered", layered_},
                    {"draw_ms",
                     {{"eyes", eyes_time_.mean_ms()},
                      {"sheet", sheet_time_.mean_ms()},
                      {"hand_over", hand_over_time_.mean_ms()}}}});
        return out;
    }

  private:
    [[nodiscard]] bool over() const { return left_ || closed_ || stop_requested() || enough(); }

    [[nodiscard]] const char* end() const {
        return stop_requested() ? "stopped" : closed_ ? "closed" : enough() ? "enough frames" : "left";
    }
    [[nodiscard]] bool enough() const { return options_.frames > 0 && frames_ >= options_.frames; }

    void ended(hmd::SessionEnd why) {
        ends_.push_back(why);
        left_ = why == hmd::SessionEnd::left;
        if (why == hmd::SessionEnd::headset_lost) {
            spdlog::warn("the headset was disconnected; waiting for it (Ctrl-C quits)");
        } else if (why == hmd::SessionEnd::runtime_lost) {
            spdlog::warn("lost the headset's runtime; waiting for it (Ctrl-C quits)");
        }
    }

    // Processes messages meanwhile, so that they do not pile up.
    void idle(std::chrono::milliseconds longest) {
        for (const auto until = Clock::now() + longest; Clock::now() < until && !over();) {
            update();
        }
    }
    void update() {
        tend_window();
        client_.receive();
        client_.input.wait(hidden_poll_interval);
    }
    void tend_window() {
        if (Window* const window = screen_.window()) {
            window->poll_events();
            press(window->take_keys());
            (void)window->take_drags();  // the head moves the eye
            closed_ = closed_ || !window->open();
        }
    }

    void wear(const hmd::Runtime& runtime, const hmd::Headset& headset) {
        if (!pictures_ || pictures_->stereo().width() != 2 * headset.eye_width ||
            pictures_->stereo().height() != headset.eye_height) {
            pictures_.reset();  // only one text overlay may exist
            pictures_ = std::make_unique<EyeCompositor>(headset.eye_width, headset.eye_height,
                                                        options_.drawing_quality());
            pictures_->set_text_scale(options_.text_scale);
        }
        {
            constexpr std::array<hmd::Session::QuadSize, 2> panels{
                {{EyeCompositor::readout_width, EyeCompositor::readout_height},
                 {HeadsetPanel::width, HeadsetPanel::height}}};
            hmd::Session session(runtime, headset, graphics_, panels);
            layered_ = session.layered();
            spdlog::info("{}: {} x {} pixels per eye, {}", headset.name, headset.eye_width,
                         headset.eye_height,
                         layered_ ? "both in one image with two layers" : "one image each");
            follow(session);
            recentred_ += session.recentred();
            ended(session.life().end());
        }
        graphics_.make_current();
        release_hand_keys();
    }

    void follow(hmd::Session& session) {
        std::optional<Clock::time_point> exit_requested;
        while (session.life().end() == hmd::SessionEnd::none) {
            session.poll();
            if (over() && !exit_requested) {
                exit_requested = Clock::now();
                session.leave();
            }
            if (exit_requested && Clock::now() - *exit_requested > exit_timeout) {
                spdlog::warn("the headset's runtime does not end the session; exiting anyway");
                break;
            }
            if (!session.life().running()) {
                release_hand_keys();
                update();
            } else if (const auto frame = session.wait_frame()) {
                show(session, *frame);
            }
        }
    }

    void show(hmd::Session& session, const hmd::Frame& frame) {
        const auto now = Clock::now();
        client_.receive();
        tend_window();
        hmd::HandInput hands = session.hands(frame);
        panel_.point(hands);
        press(hand_keys_.follow(hands));
        (void)client_.update(now);
        scene_.update();
        std::vector<hmd::Quad> panels{readout_quad};
        std::optional<hmd::Eyes> eyes = session.eyes(frame);
        if (eyes) {
            look_through(*eyes);
            client_.input.publish_eye(scene_, vantage_.eye);
        }
        if (!frame.should_render || !session.life().visible()) {
            eyes.reset();
        }
        if (eyes) {
            hud::Readout readout = client_.readout(now);
            if (frames_ < frames_with_help && !options_.observe && readout.keys.empty()) {
                for (const auto& [input, meaning] : hands_help()) {
                    readout.keys.emplace_back(std::string(input) + ':', meaning);
                }
            }
            measure(eyes_time_,
                    [&] { pictures_->draw_eyes(scene_, vantage_, scene_.has_all_frames(), rays()); });
            std::vector<const render::RenderTarget*> drawn{&pictures_->readout_picture()};
            measure(sheet_time_, [&] {
                pictures_->draw_readout(readout);
                if (panel_.shown()) {
                    drawn.push_back(&panel_.draw(now));
                    panels.push_back(HeadsetPanel::place());
                }
            });
            measure(hand_over_time_, [&] { session.draw(pictures_->stereo(), drawn); });
        }
        session.end_frame(frame, eyes, panels);
        if (Window* const window = screen_.window(); window != nullptr && eyes && !window->minimised()) {
            graphics_.make_current();
            pictures_->mirror(window->width(), window->height());
            window->swap_buffers();
        }
        frames_ += eyes && pictures_->has_patient() ? 1 : 0;
    }

    // Waits for the driver, therefore only used for --json.
    template <class Work>
    void measure(DrawTime& time, Work work) const {
        const auto begin = Clock::now();
        work();
        if (options_.json && scene_.has_all_frames()) {
            pictures_->finish();
            time.add(begin);
        }
    }

    // Pictures, published pose and metrics use a single eye: the dominant one, with which people look along
    // a blade.
    void look_through(const hmd::Eyes& eyes) {
        const RigidTransform to_patient = room_.patient(scene_.live().table_angle).inverse();
        vantage_.headset_eyes.clear();
        for (const hmd::Eye& eye : eyes) {
            vantage_.headset_eyes.push_back(render::headset_camera(to_patient * eye.pose, eye.field));
        }
        const hmd::Eye& dominant = eyes[options_.left_eye_dominant ? 0 : 1];
        vantage_.eye = view::TraineeEye::from_headset(to_patient * dominant.pose);
    }

    void press(const std::vector<KeyEvent>& keys) {
        const auto now = Clock::now();
        for (const KeyEvent& event : keys) {
            if (event.key != U'p' && event.key != key_f1) {
                client_.key(event, now);
            } else if (event.down && !event.repeated) {
                panel_.toggle();
            }
        }
    }
    // In the patient frame, like the eyes.
    [[nodiscard]] std::vector<LaserRay> rays() const {
        const RigidTransform to_patient = room_.patient(scene_.live().table_angle).inverse();
        std::vector<LaserRay> out = panel_.rays();
        for (LaserRay& ray : out) {
            ray = {to_patient * ray.from, to_patient * ray.to};
        }
        return out;
    }
    void release_hand_keys() {
        hmd::HandInput none;
        panel_.point(none);
        press(hand_keys_.follow(none));
    }

    const Options& options_;
    Screen screen_;
    hmd::Graphics graphics_;
    ClientSession client_;
    view::SceneView& scene_ = client_.scene;
    HandKeys hand_keys_;
    HeadsetPanel panel_;
    hmd::Room room_;
    render::Vantage vantage_;
    std::unique_ptr<EyeCompositor> pictures_;
    std::vector<hmd::SessionEnd> ends_;  // of headset sessions
    std::uint64_t frames_ = 0;
    DrawTime eyes_time_, sheet_time_, hand_over_time_;
    unsigned recentred_ = 0;
    bool layered_ = false, left_ = false, closed_ = false;
};

}  // namespace

int run_headset(const Options& options, nlohmann::json& result) {
    lower_priority(headset_nice);
    // First: without a runtime there is nothing to wait for.
    std::optional<hmd::Runtime> runtime(std::in_place);
    spdlog::info("headset's runtime: {}", runtime->name());
    HeadsetClient client(options, runtime->supports_egl());
    spdlog::info("rendering with {}", render::driver_name());
    client.run(runtime);
    result = client.report();
    return 0;
}

}  // namespace eti::client
