// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/annotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/model/utf8.hpp"

namespace eti::bus {

msg::Annotation encode_annotation(const Annotation& annotation) {
    msg::Annotation message;
    message.sender(annotation.sender);
    message.kind(annotation.kind);
    message.text(annotation.text);
    message.object(annotation.object);
    const std::size_t sent = std::min(annotation.places.size(), msg::bound::Annotation_places);
    for (std::size_t i = 0; i < sent; ++i) {
        msg::SurfacePlace& place = message.places().emplace_back();
        place.triangle(annotation.places[i].triangle);
        place.u(annotation.places[i].u);
        place.v(annotation.places[i].v);
        place.height(annotation.places[i].height);
    }
    return message;
}

std::optional<Annotation> decode_annotation(const msg::ShownAnnotation& message, std::string& why) {
    const msg::Annotation& sent = message.what();
    Annotation out{message.header().simulation_time_ns(),
                   sent.kind(),
                   sent.sender().to_string(),
                   sent.text().to_string(),
                   sent.object().to_string(),
                   {}};
    if (!std::ranges::all_of(std::array{out.sender, out.text, out.object}, printable)) {
        why = "a text with control characters";
        return std::nullopt;
    }
    for (const msg::SurfacePlace& place : sent.places()) {
        out.places.push_back(from_msg(place));
        if (!out.places.back().is_valid()) {
            why = "a position outside its triangle";
            return std::nullopt;
        }
    }
    const std::size_t places = out.places.size();
    const bool fits = out.kind == msg::ANNOTATION_POINT    ? places == 1
                      : out.kind == msg::ANNOTATION_STROKE ? places >= 2
                                                           : true;
    if (!fits) {
        why = fmt::format("{} places", places);
        return std::nullopt;
    }
    return out;
}

}  // namespace eti::bus
