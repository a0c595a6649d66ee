// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/annotation_board.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "common/bus/codec/annotation.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/bus/codec/scene_object.hpp"
#include "common/mesh/skinning.hpp"

namespace eti::app {

namespace {

/// Minimum and maximum number of positions of each kind.
std::pair<std::size_t, std::size_t> places_of(msg::AnnotationKind kind) {
    switch (kind) {
        case msg::ANNOTATION_POINT:
            return {1, 1};
        case msg::ANNOTATION_STROKE:
            return {2, msg::bound::Annotation_places};
        default:
            return {0, 0};
    }
}

}  // namespace

AnnotationBoard::AnnotationBoard(const patient::Patient& patient, TriangleMesh laryngoscope)
    : patient_(patient), laryngoscope_(std::move(laryngoscope)) {}

const Surface* AnnotationBoard::surface(const std::string& object) const {
    const auto found = std::ranges::find(patient_.surfaces, object, &Surface::name);
    return found == patient_.surfaces.end() ? nullptr : &*found;
}

std::string AnnotationBoard::refusal_of(const msg::Annotation& annotation) const {
    const auto [least, max_places] = places_of(annotation.kind());
    const std::size_t places = annotation.places().size();
    if (places < least || places > max_places) {
        return fmt::format("{} positions, expected {} to {}", places, least, max_places);
    }
    if (annotation.kind() == msg::ANNOTATION_NOTE && annotation.text().size() == 0) {
        return "an empty note";
    }
    if (places == 0) {
        return {};
    }
    const std::string object = annotation.object().to_string();
    const Surface* const on = surface(object);
    if (on == nullptr && object != bus::laryngoscope_object) {
        return "the object is not a surface of this patient";
    }
    const std::size_t triangles = (on != nullptr ? on->mesh : laryngoscope_).triangles.size();
    for (const msg::SurfacePlace& place : annotation.places()) {
        if (place.triangle() >= triangles) {
            return fmt::format("triangle {} of {}", place.triangle(), triangles);
        }
        if (!bus::from_msg(place).is_valid()) {
            return fmt::format("a position outside its triangle, or more than {:.0f} mm from it",
                               1e3f * SurfacePlace::farthest);
        }
    }
    return {};
}

session::AnnotationRecord AnnotationBoard::record_of(const msg::Annotation& annotation,
                                                     const scene::Snapshot& now) const {
    session::AnnotationRecord record;
    record.time_ns = now.time_ns;
    record.kind = annotation.kind() == msg::ANNOTATION_POINT ? "point" : "stroke";
    record.sender = annotation.sender().to_string();
    record.text = annotation.text().to_string();
    record.object = annotation.object().to_string();
    const Surface* const on = surface(record.object);
    const TriangleMesh& mesh = on != nullptr ? on->mesh : laryngoscope_;
    const auto corner = [&](std::uint32_t v) -> Vec3f {
        return on != nullptr
                   ? skin_point(mesh.vertices[v], on->skin[v], patient_.frame_rest_centre, now.frames)
                   : now.proxy * mesh.vertices[v];
    };
    for (const msg::SurfacePlace& sent : annotation.places()) {
        const SurfacePlace place = bus::from_msg(sent);
        const auto& [a, b, c] = mesh.triangles[place.triangle];
        record.place.push_back(place);
        record.position.push_back(point_at(place, corner(a), corner(b), corner(c)));
    }
    return record;
}

std::string AnnotationBoard::describe(const msg::Annotation& annotation) const {
    const std::string sender = annotation.sender().to_string(), text = annotation.text().to_string();
    const auto on = [&]() -> std::string {
        const std::string object = annotation.object().to_string();
        const Surface* const found = surface(object);
        return std::string(found == nullptr
                               ? object
                               : name_of(found->triangle_tissue[annotation.places().front().triangle()]));
    };
    const std::string said = text.empty() ? "" : ": " + text;
    switch (annotation.kind()) {
        case msg::ANNOTATION_POINT:
            return fmt::format("{} points at {}{}", sender, on(), said);
        case msg::ANNOTATION_STROKE:
            return fmt::format("{} draws on {}{}", sender, on(), said);
        case msg::ANNOTATION_CLEAR:
            return fmt::format("{}{}", sender, clear_suffix);
        case msg::ANNOTATION_NOTE:
            break;
    }
    return sender + said;
}

AnnotationBoard::HandledAnnotation AnnotationBoard::handle(const msg::Annotation& annotation,
                                                           const scene::Snapshot& now) {
    HandledAnnotation taken;
    taken.refusal = refusal_of(annotation);
    if (!taken.refusal.empty()) {
        return taken;
    }
    const bool note = annotation.kind() == msg::ANNOTATION_NOTE;
    taken.event = {now.time_ns, std::string(note ? session::note_event : session::annotation_event),
                   describe(annotation)};
    const auto show = [&](std::uint32_t slot) {
        msg::ShownAnnotation& shown = taken.shown.emplace_back();
        shown.header(bus::make_header(now.time_ns, ++number_));
        shown.slot(slot);
        shown.what(annotation);
    };
    if (annotation.kind() == msg::ANNOTATION_CLEAR) {
        for (std::uint32_t slot = 0; slot < used_; ++slot) {
            show(slot);
        }
        next_ = used_ = 0;
        return taken;
    }
    if (!note) {
        taken.places = record_of(annotation, now);
    }
    show(next_);
    used_ = std::max(used_, next_ + 1);
    next_ = (next_ + 1) % capacity;
    return taken;
}

}  // namespace eti::app
