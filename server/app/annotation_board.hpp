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

/// What instructors and observers write, point at and draw: checked against the patient, put into words and
/// records, and kept for all to see.
class AnnotationBoard {
  public:
    /// As many marks stay; the newest takes the place of the oldest.
    static constexpr std::uint32_t most = 64;

    /// How the event of an annotation of kind ANNOTATION_CLEAR ends.
    static constexpr std::string_view wipes = " wipes all marks away";

    /// `patient` has to outlive it. `laryngoscope`: the mesh that clients draw, in the tool's frame.
    AnnotationBoard(const anatomy::Patient& patient, TriangleMesh laryngoscope);

    /// What becomes of an annotation.
    struct Taken {
        std::string refusal;  ///< why nothing; else empty
        session::EventRecord event;
        std::optional<session::AnnotationRecord> places;  ///< of points and strokes
        std::vector<msg::ShownAnnotation> shown;          ///< to be published
    };
    /// Its texts are readable() already; every number is checked here.
    [[nodiscard]] Taken take(const msg::Annotation& annotation, const scene::Snapshot& now);

  private:
    [[nodiscard]] const Surface* surface(const std::string& object) const;
    [[nodiscard]] std::string refusal_of(const msg::Annotation& annotation) const;
    [[nodiscard]] session::AnnotationRecord record_of(const msg::Annotation& annotation,
                                                      const scene::Snapshot& now) const;
    [[nodiscard]] std::string words_of(const msg::Annotation& annotation) const;

    const anatomy::Patient& patient_;
    TriangleMesh laryngoscope_;
    std::uint32_t next_ = 0;  // slot
    std::uint32_t used_ = 0;  // slots that have ever held a mark since they were wiped
    std::uint32_t number_ = 0;
};

}  // namespace eti::app
