// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/topics.hpp"
#include "common/session/record.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Handles annotations of instructors and observers (text, points, strokes): validates them against the
/// patient, turns them into events and records, and keeps the visible marks.
class AnnotationBoard {
  public:
    /// Maximum number of visible marks; a new one replaces the oldest.
    static constexpr std::uint32_t capacity = 64;

    /// Suffix of the event text of an annotation of kind ANNOTATION_CLEAR.
    static constexpr std::string_view clear_suffix = " wipes all marks away";

    /// `patient` must outlive it. `laryngoscope`: the mesh drawn by clients, in the tool's frame.
    AnnotationBoard(const patient::Patient& patient, TriangleMesh laryngoscope);

    /// Result of an annotation.
    struct HandledAnnotation {
        std::string refusal;  ///< reason for rejection; empty if accepted
        session::EventRecord event;
        std::optional<session::AnnotationRecord> places;  ///< for points and strokes
        std::vector<msg::ShownAnnotation> shown;          ///< messages to publish
    };
    /// Handles an annotation whose texts have passed sanitized_text(); validates every number.
    [[nodiscard]] HandledAnnotation handle(const msg::Annotation& annotation, const scene::Snapshot& now);

  private:
    [[nodiscard]] const Surface* surface(const std::string& object) const;
    [[nodiscard]] std::string refusal_of(const msg::Annotation& annotation) const;
    [[nodiscard]] session::AnnotationRecord record_of(const msg::Annotation& annotation,
                                                      const scene::Snapshot& now) const;
    [[nodiscard]] std::string describe(const msg::Annotation& annotation) const;

    const patient::Patient& patient_;
    TriangleMesh laryngoscope_;
    std::uint32_t next_ = 0;  // next slot
    std::uint32_t used_ = 0;  // slots used since the last clear
    std::uint32_t number_ = 0;
};

}  // namespace eti::app
