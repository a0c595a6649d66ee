// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <thread>
#include <vector>

#include "client/view/scene_view.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/process/stop_signal.hpp"
#include "tests/bench/bus/parts.hpp"
#include "tests/bench/bus/percentiles.hpp"
#include "tests/bench/bus/surface_error.hpp"

namespace eti::bench {

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::microseconds picture_every{16'667};  // a display of 60 Hz
constexpr std::chrono::minutes other_within{5};
// States that arrived while the scene was incomplete waited for it; their age says nothing about later ones.
constexpr std::chrono::seconds settling{2};

double age_ms(const msg::Header& header) {
    return 1e-6 * (static_cast<double>(bus::wall_clock_ns()) - static_cast<double>(header.send_time_ns()));
}

bus::Options as_client(bus::Options options) {
    options.shared_multicast = true;
    return options;
}

class Reader {
  public:
    explicit Reader(const PartOptions& options)
        : node_(as_client(options.bus)),
          description_(node_, bus::topics::session_description),
          scene_(node_, bus::topics::scene),
          states_(node_, options.every_state ? bus::topics::deformation : bus::topics::deformation_slow),
          proxies_(node_, bus::topics::proxy),
          status_(node_, bus::topics::session_status) {}

    bool wait_for_scene(double seconds) {
        const auto end = Clock::now() + std::chrono::duration<double>(seconds);
        while (!view_.complete()) {
            if (stop_requested() || Clock::now() > end) {
                return false;
            }
            while (description_.take(description_message_)) {
                view_.apply(description_message_);
            }
            while (scene_.take(object_message_)) {
                view_.apply(object_message_);
            }
            std::this_thread::sleep_for(1ms);
        }
        scene_ms_ = since_start_ms();
        return true;
    }

    template <class Until>
    void follow(const Until& over) {
        steady_at_ = Clock::now() + settling;
        auto picture = Clock::now() + picture_every;
        while (!over() && !stop_requested()) {
            // A picture shows what arrives before it is drawn; until then samples are only taken.
            (void)states_.wait(
                std::max(1ms, std::chrono::duration_cast<std::chrono::milliseconds>(picture - Clock::now())));
            take();
            if (Clock::now() >= picture) {
                if (steady() && newest_.send_time_ns() > 0) {
                    drawn_.push_back(age_ms(newest_));
                }
                picture += picture_every;
            }
        }
    }

    [[nodiscard]] nlohmann::json report() const {
        return {{"scene_ms", scene_ms_},
                {"chunks", chunks_.size()},
                {"state_age_ms", percentiles(arrived_)},
                {"drawn_age_ms", percentiles(drawn_)},
                {"proxy_age_ms", percentiles(proxy_ages_)},
                {"phase", static_cast<int>(phase_)}};
    }
    [[nodiscard]] const view::SceneView& rest() const { return view_; }
    [[nodiscard]] const Chunks& chunks() const { return chunks_; }

  private:
    [[nodiscard]] bool steady() const { return Clock::now() >= steady_at_; }
    void note(std::vector<double>& ages, const msg::Header& header) const {
        if (steady()) {
            ages.push_back(age_ms(header));
        }
    }
    void take() {
        while (states_.take(state_message_)) {
            note(arrived_, state_message_.header());
            if (state_message_.header().number() >= newest_.number()) {
                newest_ = state_message_.header();
            }
            chunks_.push_back(state_message_);
        }
        while (proxies_.take(proxy_message_)) {
            note(proxy_ages_, proxy_message_.header());
        }
        while (status_.take(status_message_)) {
            phase_ = status_message_.phase();
        }
    }

    bus::Node node_;
    bus::Subscriber<msg::SessionDescription> description_;
    bus::Subscriber<msg::SceneDescription> scene_;
    bus::Subscriber<msg::DeformationState> states_;
    bus::Subscriber<msg::ProxyState> proxies_;
    bus::Subscriber<msg::SessionStatus> status_;
    msg::SessionDescription description_message_;
    msg::SceneDescription object_message_;
    msg::DeformationState state_message_;
    msg::ProxyState proxy_message_;
    msg::SessionStatus status_message_;
    msg::SessionPhase phase_ = msg::PHASE_WAITING;
    view::SceneView view_;
    Chunks chunks_;
    msg::Header newest_;
    double scene_ms_ = 0.0;
    Clock::time_point steady_at_ = Clock::time_point::max();
    std::vector<double> arrived_, drawn_, proxy_ages_;
};

}  // namespace

nlohmann::json read_states(const PartOptions& options) {
    Reader reader(options);
    if (!reader.wait_for_scene(options.wait_s)) {
        return {{"scene_ms", nullptr}};
    }
    fmt::print("{}\n", reader.report().dump());
    std::fflush(stdout);
    if (options.other.empty()) {
        const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
        reader.follow([&] { return Clock::now() >= end; });
    } else {
        const auto end = Clock::now() + other_within;
        reader.follow([&] {
            if (Clock::now() > end) {
                throw std::runtime_error(options.other.string() +
                                         ": the other reader left no file within 5 minutes");
            }
            return std::filesystem::exists(options.other);
        });
    }
    nlohmann::json out = reader.report();
    if (!options.keep.empty()) {
        save_chunks(options.keep, reader.chunks());
    }
    if (!options.other.empty()) {
        out["other"] = surface_error(reader.rest(), reader.chunks(), load_chunks(options.other));
    }
    return out;
}

}  // namespace eti::bench
