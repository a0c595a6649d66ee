// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/devices/grid.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/bus/codec/convert.hpp"
#include "common/device/hand.hpp"
#include "devices/haptics/haptic_loop.hpp"
#include "tests/bench/devices/relay.hpp"
#include "tests/bench/devices/server_process.hpp"

namespace eti::bench {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Closed mouth, coarse particles: tissue is not involved, and the server keeps up even on a loaded machine.
constexpr const char* scenario = R"(
name: wall
patient: {weight_kg: 3.5, head_elevation_deg: 0, jaw_opening_deg: 0}
physics: {tissue_method: clusters, substeps: 1, spacing_mm: 4, fine_spacing_mm: 2, region_mm: 4}
)";

constexpr float along = 0.02f;                    // [m], from the tool's origin to the contact
constexpr float above = 5e-3f, pressed = -4e-3f;  // [m], of the blade's underside
constexpr float approach = 0.05f;                 // [m/s]
constexpr float engaged_after = 0.9f;             // [s], out of contact, with the ramp
constexpr float bumped_at = 1.4f, bump = 1e-3f;   // [s], [m] for 20 ms
constexpr float watched_from = 2.0f;              // [s]
constexpr float cell_length = 3.05f;              // [s]
constexpr std::chrono::seconds patience{20};      // timeout for the blade to reach its position
constexpr int most_passes = 4;                    // over the cells not yet measured

/// Where the blade is pressed: it lies perpendicular to `normal`, which points out of the wall.
struct Place {
    Vec3f contact = Vec3f::Zero(), normal = -Vec3f::UnitY(), blade = Vec3f::UnitX();

    /// The tool with its underside `height` [m] above the contact.
    [[nodiscard]] RigidTransform pose(float height, float radius) const {
        Mat3f axes;
        axes << normal.cross(blade), normal, blade;
        return {Quatf(axes), contact - along * blade + (radius + height) * normal};
    }
};

/// A device in a light grip that follows a plan of heights above a place.
class PressingHand final : public devices::Sensor {
  public:
    using Plan = float (*)(float time);

    PressingHand(const Place& place, float radius, float height)
        : place_(place), radius_(radius), hand_(settings(), place.pose(height, radius)) {
        wanted_ = hand_.motion().pose;
    }

    /// Starts a plan; not while a loop runs.
    void begin(const Place& place, Plan plan) {
        place_ = place;
        plan_ = plan;
        time_ = 0.0f;
        still_ = {};
        force_ = 0.0;
        watched_ = 0;
        seconds_.store(0.0f);
    }
    [[nodiscard]] float seconds() const { return seconds_.load(); }
    [[nodiscard]] double excursion() const { return still_.excursion(); }
    [[nodiscard]] double force() const { return watched_ > 0 ? force_ / watched_ : 0.0; }

    devices::Reading exchange(const Wrench& wrench, float elapsed) override {
        constexpr float longest_step = 1e-3f;
        for (float left = elapsed; left > 1e-6f; left -= longest_step) {
            step(wrench, std::min(left, longest_step));
        }
        const float height = (hand_.motion().pose.translation - place_.contact).dot(place_.normal) - radius_;
        const int at_ms = static_cast<int>(1e3f * (time_ - watched_from));
        if (time_ >= watched_from && at_ms < validation::Stillness::length_ms) {
            still_.add(at_ms, static_cast<double>(height));
            force_ += static_cast<double>(wrench.force.norm());
            ++watched_;
        }
        seconds_.store(time_);
        devices::Reading reading;
        reading.motion = hand_.motion();
        reading.motion.pose = hand_.reported();
        reading.sample = ++sample_;
        return reading;
    }
    [[nodiscard]] devices::DeviceCapabilities capabilities() const override {
        return {
            .force = CouplingSettings{}.force_limit, .torque = CouplingSettings{}.torque_limit, .rate = 0.0f};
    }

  private:
    static HandSettings settings() {
        HandSettings out;
        out.hand_stiffness = validation::light.stiffness;
        out.hand_damping = validation::light.damping;
        return out;
    }
    void step(const Wrench& wrench, float dt) {
        constexpr float fastest = 0.1f, turning = 2.0f;  // [m/s], [rad/s], limits where the plan jumps
        time_ += dt;
        const RigidTransform goal = place_.pose(plan_(time_), radius_);
        const Vec3f way = goal.translation - wanted_.translation;
        const Vec3f turn = rotation_vector(goal.rotation * wanted_.rotation.conjugate());
        wanted_.translation += way * std::min(1.0f, fastest * dt / std::max(way.norm(), 1e-9f));
        wanted_.rotation =
            (quaternion_from(turn * std::min(1.0f, turning * dt / std::max(turn.norm(), 1e-9f))) *
             wanted_.rotation)
                .normalized();
        hand_.step(wanted_, wrench, dt);
    }

    Place place_;
    float radius_;
    HandDevice hand_;
    RigidTransform wanted_;
    Plan plan_ = [](float) { return above; };
    float time_ = 0.0f;
    validation::Stillness still_;
    double force_ = 0.0;
    int watched_ = 0;
    std::uint64_t sample_ = 0;
    std::atomic<float> seconds_{0.0f};
};

float search(float time) {
    constexpr float from = 0.05f, speed = 0.02f;  // [m], [m/s]
    return from - speed * time;
}

float wait_above(float) {
    return above;
}

float press(float time) {
    if (time < engaged_after) {
        return above;
    }
    const float bumped = time >= bumped_at && time < bumped_at + 0.02f ? bump : 0.0f;
    return std::max(pressed, above - approach * (time - engaged_after)) + bumped;
}

/// The stiffnesses of one delay and loss, with or without the controller, in ascending order.
struct Ladder {
    bool passivity;
    Channel channel;
    std::vector<GridOutcome> outcomes;

    /// Number of stiffnesses up to and including the first unstable one: higher ones are not tried.
    [[nodiscard]] std::size_t steps() const {
        const auto first = std::ranges::find_if(
            outcomes, [](const GridOutcome& o) { return o.not_measured.empty() && !o.stable(); });
        return first == outcomes.end() ? outcomes.size()
                                       : static_cast<std::size_t>(first - outcomes.begin()) + 1;
    }
    [[nodiscard]] GridCell cell(float multiple) const {
        return {passivity, channel, multiple * CouplingSettings{}.stiffness};
    }
};

/// The server, the relay and the device's side of it.
class Stage {
  public:
    Stage()
        : file_(std::filesystem::temp_directory_path() / (there_ + ".yaml")),
          server_((std::ofstream(file_) << scenario, file_.string()), there_, domain_),
          relay_(place(there_, domain_, "relay"), place(here_, domain_, bus::server_name.data()), {}),
          node_(place(here_, domain_, "eti-haptics")),
          link_(node_, devices::SceneLink::ForceSource::tissue),
          listener_(place(there_, domain_, "listener")),
          proxies_(listener_, bus::topics::proxy),
          statuses_(listener_, bus::topics::session_status),
          radius_(make_laryngoscope(Blade::miller_1).capsules[1].radius),
          hand_(wall_, radius_, search(0.0f)) {
        (void)server_.scene(link_);
        std::error_code ignored;
        std::filesystem::remove(file_, ignored);
        find_wall();
    }

    GridOutcome run(const GridCell& cell) {
        server_.check();
        relay_.set(cell.channel);
        devices::RenderSettings settings;
        settings.passivity.on = cell.passivity;
        settings.coupling.stiffness = cell.stiffness;
        hand_.begin(wall_, press);
        GridOutcome out;
        devices::HapticLoop loop(node_, hand_, link_.newest(), settings);
        std::optional<std::pair<float, float>> first, last;  // [s] of the hand's time, [s] behind
        while (hand_.seconds() < cell_length) {
            std::this_thread::sleep_for(5ms);
            if (statuses_.take_latest(status_)) {
                last = {hand_.seconds(), status_.behind_s()};
                first = first ? first : last;
            }
        }
        loop.stop();
        if (first && last->first > first->first) {
            out.server_lag =
                static_cast<double>((last->second - first->second) / (last->first - first->first));
        }
        const devices::HapticRecord& record = loop.cycle().record();
        out.excursion = hand_.excursion();
        out.force = hand_.force();
        out.faded =
            static_cast<double>(record.stale_cycles) / static_cast<double>(record.intervals.count() + 1);
        out.message_p99 = record.messages.percentile(0.99);
        out.message_max = record.messages.longest();
        out.relay_late = relay_.lateness();
        if (!first || out.server_lag > most_server_lag) {
            out.not_measured = "server behind";
        } else if (out.relay_late > most_relay_late) {
            out.not_measured = "relay late";
        } else if (out.faded > most_faded || out.force < least_force) {
            out.not_measured = "no force";
        }
        return out;
    }

  private:
    /// Moves towards the bridge of the nose until the server reports a contact, and stores its position and
    /// normal.
    void find_wall() {
        wall_.contact = {0.0f, -0.03f, 0.02f};  // just above the bridge of the nose
        hand_.begin(wall_, search);
        devices::HapticLoop loop(node_, hand_, link_.newest(), {});
        const auto end = Clock::now() + patience;
        for (bool found = false; !found;) {
            if (Clock::now() > end) {
                throw std::runtime_error("the blade reached no wall within 20 s");
            }
            (void)proxies_.wait(5ms);
            if (!proxies_.take_latest(proxy_) || proxy_.contacts().empty()) {
                continue;
            }
            const auto& contacts = proxy_.contacts();
            const auto& most = *std::ranges::max_element(
                contacts, {}, [](const msg::ShellContact& contact) { return contact.force(); });
            found = most.force() > 0.0f;
            wall_.contact = bus::from_msg(most.position());
            // The blade stays perpendicular: only the component of the normal across it counts.
            const Vec3f normal = bus::from_msg(most.normal());
            wall_.normal = (normal - normal.dot(wall_.blade) * wall_.blade).normalized();
        }
        loop.stop();
        hand_.begin(wall_, wait_above);
        devices::HapticLoop back(node_, hand_, link_.newest(), {});
        while (hand_.seconds() < 3.0f) {
            std::this_thread::sleep_for(10ms);
        }
        const Vec3f at = 1e3f * wall_.contact, normal = wall_.normal;
        spdlog::info("the wall is at ({:.1f}, {:.1f}, {:.1f}) mm, its normal ({:.2f}, {:.2f}, {:.2f})",
                     at.x(), at.y(), at.z(), normal.x(), normal.y(), normal.z());
    }

    const int domain_ = bench_domain();
    const std::string there_ = "grid-" + std::to_string(::getpid()), here_ = there_ + "-far";
    std::filesystem::path file_;
    ServerProcess server_;
    Relay relay_;
    bus::Node node_;
    devices::SceneLink link_;
    bus::Node listener_;
    bus::Subscriber<msg::ProxyState> proxies_;
    bus::Subscriber<msg::SessionStatus> statuses_;
    msg::ProxyState proxy_;
    msg::SessionStatus status_;
    Place wall_;
    float radius_;
    PressingHand hand_;
};

}  // namespace

void run_grid(const GridPlan& plan, const std::function<void(const GridCell&, const GridOutcome&)>& done) {
    const auto end = Clock::now() + std::chrono::duration<double>(60.0 * plan.minutes);
    const std::vector<double> delays =
        plan.whole ? std::vector{0.0, 0.005, 0.010, 0.020, 0.050} : std::vector{0.0, 0.010, 0.050};
    const std::vector<double> losses = plan.whole ? std::vector{0.0, 0.01, 0.05} : std::vector{0.01};
    const std::vector<float> multiples =
        plan.whole ? std::vector{1.0f, 2.0f, 4.0f, 8.0f, 16.0f} : std::vector{1.0f, 4.0f};
    std::vector<Ladder> ladders;
    for (const bool passivity : {true, false}) {
        for (const double delay : delays) {
            for (const double loss : losses) {
                ladders.push_back({passivity, {delay, 0.1 * delay, loss}, {}});
                ladders.back().outcomes.resize(multiples.size(), {.not_measured = "no time left"});
            }
        }
    }
    Stage stage;
    // A cell that a busy machine made invalid is repeated after the others.
    for (int pass = 0; pass < most_passes; ++pass) {
        for (Ladder& ladder : ladders) {
            for (std::size_t i = 0; i < ladder.steps() && Clock::now() < end; ++i) {
                if (!ladder.outcomes[i].not_measured.empty()) {
                    ladder.outcomes[i] = stage.run(ladder.cell(multiples[i]));
                }
            }
        }
    }
    for (const Ladder& ladder : ladders) {
        for (std::size_t i = 0; i < ladder.steps(); ++i) {
            done(ladder.cell(multiples[i]), ladder.outcomes[i]);
        }
    }
}

}  // namespace eti::bench
