// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/bus/codec/convert.hpp"
#include "common/bus/codec/fluid_state.hpp"
#include "common/bus/codec/frame_pose.hpp"
#include "common/model/utf8.hpp"

namespace eti::view {
namespace {

bool same(const FramePose& a, const FramePose& b) {
    return a.centre == b.centre && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

bool SceneView::reject(const char* topic, const std::string& why) {
    const auto now = std::chrono::steady_clock::now();
    if (++dropped_ == 1 || now - last_drop_line_ >= std::chrono::seconds(1)) {
        last_drop_line_ = now;
        spdlog::warn("dropped a message on {}: {} ({} dropped so far)", topic, why, dropped_);
    }
    return false;
}

bool SceneView::apply(const msg::SessionDescription& message) {
    std::string why;
    auto keys = bus::SessionKeys::of(message, why);
    if (!keys) {
        return reject("eti/session_description", why);
    }
    if (!printable(message.scenario().to_string()) || !printable(message.description().to_string())) {
        return reject("eti/session_description", "a name or description with control characters");
    }
    if (!keys->key_mismatch().empty()) {
        spdlog::warn("{}", keys->key_mismatch());
    }
    keys_ = std::move(*keys);
    liquid_detail_.set_kind(properties_of(keys_->liquid()));
    description_ = message;
    scenario_ = shown_scenario(message.scenario_text());
    tube_.emplace(keys_->tube());
    tube_moved_ = !tube_nodes_.empty();
    rest_landmarks_ = keys_->rest_landmarks();
    if (!metrics_) {
        live_ = keys_->start();
    }
    if (!live_landmarks_) {
        landmarks_ = rest_landmarks_;
    }
    scene_revision_ = next_revision();
    return true;
}

bool SceneView::apply(const msg::SceneDescription& message) {
    const std::string name = message.object().to_string();
    std::string why;
    auto object = bus::decode_scene_object(message, why);
    if (!object) {
        return reject("eti/scene", fmt::format("object '{}': {}", name, why));
    }
    if (message.object_count() == 0 || message.object_count() > 4096) {
        return reject("eti/scene",
                      fmt::format("object '{}': a scene of {} objects", name, message.object_count()));
    }
    const auto* surface = std::get_if<bus::RestSurface>(&*object);
    if (surface != nullptr && !rest_centres_.empty() && surface->highest_frame >= rest_centres_.size()) {
        return reject("eti/scene", fmt::format("object '{}': frame {} of {}", name, surface->highest_frame,
                                               rest_centres_.size()));
    }
    if (message.object_count() != object_count_) {
        clear_scene();
        object_count_ = message.object_count();
    }
    std::visit([&](auto&& part) { keep(name, std::move(part)); }, std::move(*object));
    arrived_[name] = message.kind();
    scene_revision_ = next_revision();
    return true;
}

void SceneView::keep(const std::string&, std::vector<Vec3f>&& rest_centres) {
    rest_centres_ = std::move(rest_centres);
    frames_.assign(rest_centres_.size(), FramePose{});
    maps_.assign(rest_centres_.size(), FrameMap{});
    for (std::size_t f = 0; f < frames_.size(); ++f) {
        frames_[f].centre = rest_centres_[f];
    }
    moved_.assign(rest_centres_.size(), 1);
    unskinned_.assign(rest_centres_.size(), 0);
    any_moved_ = true;
    frame_time_ns_.assign(rest_centres_.size(), 0);
    heard_.assign(rest_centres_.size(), 0);
    heard_count_ = 0;
    for (auto surface = surfaces_.begin(); surface != surfaces_.end();) {
        const std::uint16_t highest = surface->second.model().highest_frame;
        if (highest >= rest_centres_.size()) {
            reject("eti/scene",
                   fmt::format("object '{}': frame {} of {}", surface->first, highest, rest_centres_.size()));
            arrived_.erase(surface->first);
            surface = surfaces_.erase(surface);
        } else {
            ++surface;
        }
    }
}

void SceneView::keep(const std::string& name, bus::RestSurface&& object) {
    surfaces_.erase(name);
    surfaces_.emplace(name, SkinnedSurface(std::move(object)));
    std::fill(moved_.begin(), moved_.end(), std::uint8_t{1});
    any_moved_ = !moved_.empty();
}

void SceneView::keep(const std::string&, TriangleMesh&& object) {
    laryngoscope_ = std::move(object);
}

void SceneView::clear_scene() {
    arrived_.clear();
    surfaces_.clear();
    laryngoscope_.reset();
    rest_centres_.clear();
    frames_.clear();
    maps_.clear();
    moved_.clear();
    unskinned_.clear();
    frame_time_ns_.clear();
    heard_.clear();
    heard_count_ = 0;
    any_moved_ = any_unskinned_ = false;
}

void SceneView::note_time(std::uint64_t time_ns) {
    if (time_ns + restart_gap_ns < simulation_time_ns_) {
        std::fill(frame_time_ns_.begin(), frame_time_ns_.end(), std::uint64_t{0});
        tube_time_ns_ = 0;
        liquid_time_ns_ = 0;
        liquid_chunks_.clear();
        liquid_detail_.clear();
        attempt_report_.reset();
        run_report_.reset();
        annotations_.clear();
        simulation_time_ns_ = time_ns;
    }
    simulation_time_ns_ = std::max(simulation_time_ns_, time_ns);
}

bool SceneView::apply(const msg::DeformationState& message) {
    if (message.chunks() == 0 || message.chunk() >= message.chunks()) {
        return reject("eti/deformation", fmt::format("chunk {} of {}", message.chunk(), message.chunks()));
    }
    // Without the frames' rest centres a chunk is unusable; the slow refresh repeats it.
    const bool usable = !rest_centres_.empty();
    decoded_.clear();
    for (const msg::FrameUpdate& update : message.frames()) {
        if (usable && update.frame() >= frames_.size()) {
            return reject("eti/deformation", fmt::format("frame {} of {}", update.frame(), frames_.size()));
        }
        const auto pose = bus::decode_frame_pose(update);
        if (!pose) {
            return reject("eti/deformation", fmt::format("invalid pose of frame {}", update.frame()));
        }
        decoded_.push_back(*pose);
    }
    for (const msg::Vec3& node : message.tube_nodes()) {
        if (!bus::is_valid_point(node)) {
            return reject("eti/deformation", "invalid tube node");
        }
    }
    if (message.tube_nodes().size() == 1) {
        return reject("eti/deformation", "a tube with one node");
    }
    const std::uint64_t time = message.header().simulation_time_ns();
    note_time(time);
    if (!message.tube_nodes().empty() && time >= tube_time_ns_) {
        tube_time_ns_ = time;
        const auto same_node = [](const Vec3f& known, const msg::Vec3& node) {
            return known == bus::from_msg(node);
        };
        // Every state repeats the nodes of a resting tube.
        if (!std::ranges::equal(tube_nodes_, message.tube_nodes(), same_node)) {
            tube_nodes_.clear();
            for (const msg::Vec3& node : message.tube_nodes()) {
                tube_nodes_.push_back(bus::from_msg(node));
            }
            tube_moved_ = true;
        }
    }
    if (!usable) {
        return true;
    }
    for (std::size_t i = 0; i < decoded_.size(); ++i) {
        const std::size_t f = message.frames()[i].frame();
        // Datagrams may arrive out of order; an older pose never replaces a newer one.
        if (time < frame_time_ns_[f]) {
            continue;
        }
        frame_time_ns_[f] = time;
        heard_count_ += heard_[f] == 0 ? 1 : 0;
        heard_[f] = 1;
        // The slow refresh repeats known poses.
        if (!same(frames_[f], decoded_[i])) {
            frames_[f] = decoded_[i];
            moved_[f] = 1;
            any_moved_ = true;
        }
    }
    return true;
}

bool SceneView::apply(const msg::FluidState& message) {
    arriving_.clear();
    if (!bus::decode_fluid_chunk(message, max_coordinate, arriving_)) {
        return reject("eti/fluid", fmt::format("invalid chunk {} of {} with {} numbers", message.chunk(),
                                               message.chunks(), message.places().size()));
    }
    const std::uint64_t time = message.header().simulation_time_ns();
    note_time(time);
    if (time > liquid_time_ns_) {
        advance_liquid();
    }
    if (time >= liquid_time_ns_) {
        liquid_time_ns_ = time;
        liquid_chunks_.resize(message.chunks());
        liquid_spacing_ = message.spacing();
    }
    // A lost chunk leaves its part of the liquid unchanged.
    if (message.chunk() < liquid_chunks_.size() && time >= liquid_chunks_[message.chunk()].time_ns) {
        LiquidChunk& chunk = liquid_chunks_[message.chunk()];
        chunk.time_ns = time;
        chunk.positions.swap(arriving_);
        liquid_moved_ = true;
    }
    return true;
}

/// Applies the state being received; no more of its chunks will arrive.
void SceneView::advance_liquid() {
    if (liquid_time_ns_ == 0) {
        return;
    }
    whole_.clear();
    for (const LiquidChunk& chunk : liquid_chunks_) {
        whole_.insert(whole_.end(), chunk.positions.begin(), chunk.positions.end());
    }
    std::vector<Capsule> tools;
    if (keys_ && !whole_.empty()) {
        if (laryngoscope_pose_) {
            for (const Capsule& capsule : keys_->laryngoscope().capsules) {
                tools.push_back(
                    {*laryngoscope_pose_ * capsule.a, *laryngoscope_pose_ * capsule.b, capsule.radius});
            }
        }
        for (std::size_t k = 0; k + 1 < tube_nodes_.size(); ++k) {
            tools.push_back({tube_nodes_[k], tube_nodes_[k + 1], keys_->tube().outer_radius()});
        }
    }
    liquid_detail_.advance(liquid_time_ns_, whole_, liquid_spacing_, tools);
}

bool SceneView::apply(const msg::ProxyState& message) {
    const auto pose = bus::valid_pose(message.proxy());
    if (!pose) {
        return reject("eti/proxy", "impossible pose");
    }
    // Centroid of the contacts with the upper gum, weighted by force.
    Vec3f moment = Vec3f::Zero();
    float force = 0.0f;
    for (const msg::ShellContact& contact : message.contacts()) {
        const Vec3f position = bus::from_msg(contact.position());
        if (!is_valid_point(position) || !std::isfinite(contact.force())) {
            return reject("eti/proxy", "an invalid contact");
        }
        if (contact.tissue() == static_cast<std::uint32_t>(Tissue::upper_gum) && contact.force() > 0.0f) {
            moment += contact.force() * position;
            force += contact.force();
        }
    }
    note_time(message.header().simulation_time_ns());
    laryngoscope_pose_ = *pose;
    gum_contact_ = force > 0.0f ? std::optional<Vec3f>(moment / force) : std::nullopt;
    return true;
}

bool SceneView::apply(const msg::LiveMetrics& message) {
    // Without the description the values cannot be identified.
    if (!keys_) {
        return false;
    }
    const auto points = keys_->landmarks(message);
    if (!points) {
        return reject("eti/live_metrics", "landmarks that are missing or invalid");
    }
    const LiveMeasures measures = keys_->measures(message);
    for (const LiveMeasureField& field : live_measure_fields) {
        const float value = measures.*field.value;
        if (!std::isfinite(value) && !(field.optional && std::isnan(value))) {
            return reject("eti/live_metrics", fmt::format("'{}' is {}", field.key, value));
        }
    }
    if (!std::ranges::all_of(message.live(), [](float value) { return std::isfinite(value); })) {
        return reject("eti/live_metrics", "a runtime parameter is not finite");
    }
    if (!printable(message.message().to_string())) {
        return reject("eti/live_metrics", "a message with control characters");
    }
    std::vector<Vec3f> contour;
    std::ranges::transform(message.glottis_contour(), std::back_inserter(contour),
                           [](const msg::Vec3& p) { return bus::from_msg(p); });
    if (!std::ranges::all_of(contour, [](const Vec3f& p) { return is_valid_point(p); })) {
        return reject("eti/live_metrics", "an invalid contour of the glottis");
    }
    std::optional<RigidTransform> eye;
    if (message.eye_heard()) {
        eye = bus::valid_pose(message.eye());
        if (!eye) {
            return reject("eti/live_metrics", "an invalid eye position");
        }
    }
    note_time(message.header().simulation_time_ns());
    trainee_eye_ = eye;
    landmarks_ = *points;
    live_landmarks_ = true;
    metrics_ = message;
    measures_ = measures;
    glottis_contour_ = std::move(contour);
    live_ = keys_->runtime_parameters(message);
    return true;
}

bool SceneView::apply(const msg::SessionStatus& message) {
    if (!std::isfinite(message.load()) || !std::isfinite(message.behind_s())) {
        return reject("eti/session_status", "load or delay is not finite");
    }
    status_ = message;
    return true;
}

bool SceneView::apply(const msg::AttemptSummary& message) {
    if (!keys_) {
        return false;
    }
    std::string why;
    auto report = bus::decode_attempt(message, *keys_, why);
    if (!report) {
        return reject("eti/attempt_summary", fmt::format("attempt {}: {}", message.attempt(), why));
    }
    // The bus keeps one per attempt, and late joiners receive them all. Their time is ignored, as it lies
    // in the past.
    if (report->attempt == 0) {
        run_report_ = std::move(report);
    } else if (!attempt_report_ || report->attempt >= attempt_report_->attempt) {
        attempt_report_ = std::move(report);
    }
    return true;
}

bool SceneView::apply(const msg::ShownAnnotation& message) {
    // Far more than a server keeps: a higher slot is an error.
    constexpr std::uint32_t most_slots = 256;
    if (message.slot() >= most_slots) {
        return reject("eti/shown_annotation", fmt::format("slot {}", message.slot()));
    }
    if (message.what().kind() == msg::ANNOTATION_CLEAR) {
        annotations_.erase(message.slot());
        return true;
    }
    std::string why;
    auto annotation = bus::decode_annotation(message, why);
    if (!annotation) {
        return reject("eti/shown_annotation", why);
    }
    annotations_[message.slot()] = std::move(*annotation);
    return true;
}

void SceneView::update() {
    if (any_moved_) {
        for (std::size_t f = 0; f < frames_.size(); ++f) {
            if (moved_[f] != 0) {
                maps_[f] = frame_map(frames_[f], rest_centres_[f]);
                unskinned_[f] = 1;
            }
        }
        std::fill(moved_.begin(), moved_.end(), std::uint8_t{0});
        any_moved_ = false;
        any_unskinned_ = true;
        frames_revision_ = next_revision();
    }
    if (liquid_moved_) {
        liquid_.clear();
        for (const LiquidChunk& chunk : liquid_chunks_) {
            liquid_.insert(liquid_.end(), chunk.positions.begin(), chunk.positions.end());
        }
        liquid_revision_ = next_revision();
        liquid_moved_ = false;
    }
    if (tube_moved_ && tube_) {
        tube_->update(tube_nodes_);
        tube_moved_ = false;
    }
}

const std::map<std::string, SkinnedSurface>& SceneView::surfaces() const {
    if (any_unskinned_) {
        for (auto& [name, surface] : surfaces_) {
            surface.update(maps_, unskinned_);
        }
        std::fill(unskinned_.begin(), unskinned_.end(), std::uint8_t{0});
        any_unskinned_ = false;
    }
    return surfaces_;
}

const bus::RestSurface* SceneView::rest_surface(const std::string& name) const {
    const auto found = surfaces_.find(name);
    return found == surfaces_.end() ? nullptr : &found->second.model();
}

bool SceneView::has_all_frames() const {
    return complete() && heard_count_ == heard_.size();
}

bool SceneView::complete() const {
    return keys_ && object_count_ > 0 && arrived_.size() >= object_count_ && !rest_centres_.empty();
}

const TubeSweep* SceneView::tube() const {
    return tube_ && tube_->revision() > 0 ? &*tube_ : nullptr;
}

}  // namespace eti::view
