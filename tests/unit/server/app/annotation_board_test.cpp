// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/annotation_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "common/model/tools/tools.hpp"

namespace eti::app {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// One triangle of a tongue skinned to one frame.
patient::Patient patient_with_a_tongue() {
    patient::Patient patient;
    patient.frame_rest_centre = {Vec3f::Zero(), Vec3f(0.1f, 0.0f, 0.0f)};
    Surface surface;
    surface.name = "tongue";
    surface.tissue = Tissue::tongue;
    surface.mesh.vertices = {{0.0f, 0.0f, 0.0f}, {0.02f, 0.0f, 0.0f}, {0.0f, 0.02f, 0.0f}};
    surface.mesh.triangles = {{0, 1, 2}};
    surface.triangle_tissue = {Tissue::tongue};
    surface.skin.assign(3, {{1}, {1.0f}});
    patient.surfaces.push_back(surface);
    return patient;
}

msg::SurfacePlace place(std::uint32_t triangle, float u, float v, float height = 0.0f) {
    msg::SurfacePlace out;
    out.triangle(triangle);
    out.u(u);
    out.v(v);
    out.height(height);
    return out;
}

msg::Annotation annotation(msg::AnnotationKind kind, const std::string& text,
                           const std::vector<msg::SurfacePlace>& places = {},
                           const std::string& object = "tongue") {
    msg::Annotation out;
    out.kind(kind);
    out.sender("desk:7");
    out.text(text);
    out.object(object);
    out.places(places);
    return out;
}

class AnnotationBoardTest : public ::testing::Test {
  protected:
    AnnotationBoardTest() {
        now_.time_ns = 2'000'000'000;
        now_.frames = {FramePose{}, FramePose{Vec3f(0.1f, 0.0f, 0.0f), Quatf::Identity()}};
    }

    patient::Patient patient_ = patient_with_a_tongue();
    AnnotationBoard board_{patient_, laryngoscope_mesh(make_laryngoscope(Blade::miller_1))};
    scene::Snapshot now_;
};

TEST_F(AnnotationBoardTest, StoresNoteTextWithTime) {
    const auto taken = board_.handle(annotation(msg::ANNOTATION_NOTE, "sweep the tongue aside"), now_);
    EXPECT_EQ(taken.refusal, "");
    EXPECT_EQ(taken.event.kind, "note");
    EXPECT_EQ(taken.event.text, "desk:7: sweep the tongue aside");
    EXPECT_EQ(taken.event.time_ns, 2'000'000'000u);
    EXPECT_FALSE(taken.places);
    ASSERT_EQ(taken.shown.size(), 1u);
    EXPECT_EQ(taken.shown[0].header().simulation_time_ns(), 2'000'000'000u);
    EXPECT_EQ(taken.shown[0].what().text().to_string(), "sweep the tongue aside");
}

TEST_F(AnnotationBoardTest, RecordsPointInDeformedTissue) {
    // The frame has moved up by 10 mm and rotated by 90 deg about z, so that x points along y.
    now_.frames[1].centre = Vec3f(0.1f, 0.0f, 0.010f);
    now_.frames[1].rotation = Quatf(Eigen::AngleAxisf(90.0f * degree, Vec3f::UnitZ()));
    const auto taken =
        board_.handle(annotation(msg::ANNOTATION_POINT, "here", {place(0, 0.5f, 0.25f, 0.001f)}), now_);
    ASSERT_EQ(taken.refusal, "");
    EXPECT_EQ(taken.event.kind, "annotation");
    EXPECT_EQ(taken.event.text, "desk:7 points at tongue: here");
    ASSERT_TRUE(taken.places);
    EXPECT_EQ(taken.places->kind, "point");
    EXPECT_EQ(taken.places->object, "tongue");
    // At rest (0.010, 0.005, 0.001); about the frame's rest centre (-0.090, 0.005, 0.001), turned.
    const Vec3f expected = Vec3f(0.1f, 0.0f, 0.010f) + Vec3f(-0.005f, -0.090f, 0.001f);
    EXPECT_LT((taken.places->position.at(0) - expected).norm(), 1e-6f);
}

TEST_F(AnnotationBoardTest, MarkOnBladeMovesWithBlade) {
    now_.proxy.translation = Vec3f(0.0f, 0.0f, 0.5f);
    const auto taken =
        board_.handle(annotation(msg::ANNOTATION_POINT, "", {place(0, 0.0f, 0.0f)}, "laryngoscope"), now_);
    ASSERT_EQ(taken.refusal, "");
    const TriangleMesh mesh = laryngoscope_mesh(make_laryngoscope(Blade::miller_1));
    EXPECT_LT(
        (taken.places->position.at(0) - mesh.vertices[mesh.triangles[0][0]] - Vec3f(0.0f, 0.0f, 0.5f)).norm(),
        1e-6f);
}

TEST_F(AnnotationBoardTest, RefusesInvalidAnnotations) {
    const auto inside = place(0, 0.2f, 0.2f);
    const std::vector<std::pair<msg::Annotation, const char*>> wrong{
        {annotation(msg::ANNOTATION_NOTE, ""), "an empty note"},
        {annotation(msg::ANNOTATION_NOTE, "x", {inside}), "1 positions, expected 0 to 0"},
        {annotation(msg::ANNOTATION_POINT, ""), "0 positions, expected 1 to 1"},
        {annotation(msg::ANNOTATION_POINT, "", {inside, inside}), "2 positions"},
        {annotation(msg::ANNOTATION_STROKE, "", {inside}), "1 positions, expected 2 to 48"},
        {annotation(msg::ANNOTATION_POINT, "", {inside}, "moon"), "not a surface"},
        {annotation(msg::ANNOTATION_POINT, "", {place(1, 0.2f, 0.2f)}), "triangle 1 of 1"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0xffffffff, 0.2f, 0.2f)}), "triangle"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, 0.8f, 0.4f)}), "outside its triangle"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, -0.1f, 0.4f)}), "outside its triangle"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, nan, 0.2f)}), "outside its triangle"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, 0.2f, nan)}), "outside its triangle"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, 0.2f, 0.2f, nan)}), "100 mm"},
        {annotation(msg::ANNOTATION_POINT, "", {place(0, 0.2f, 0.2f, 0.11f)}), "100 mm"},
        {annotation(msg::ANNOTATION_STROKE, "", {inside, place(0, 1e30f, 0.2f)}), "outside its triangle"},
    };
    for (const auto& [message, why] : wrong) {
        const auto taken = board_.handle(message, now_);
        EXPECT_THAT(taken.refusal, testing::HasSubstr(why));
        EXPECT_TRUE(taken.shown.empty()) << why;
        EXPECT_FALSE(taken.places) << why;
    }
    EXPECT_EQ(board_.handle(annotation(msg::ANNOTATION_POINT, "", {inside}), now_).shown.at(0).slot(), 0u)
        << "what was refused took no place";
}

TEST_F(AnnotationBoardTest, NewestReplacesOldestWhenFull) {
    std::vector<std::uint32_t> slots;
    for (std::uint32_t i = 0; i < AnnotationBoard::capacity + 2; ++i) {
        slots.push_back(board_.handle(annotation(msg::ANNOTATION_NOTE, "n"), now_).shown.at(0).slot());
    }
    EXPECT_EQ(std::set(slots.begin(), slots.end()).size(), AnnotationBoard::capacity);
    EXPECT_EQ(slots[AnnotationBoard::capacity], slots[0]);
    EXPECT_EQ(slots[AnnotationBoard::capacity + 1], slots[1]);
}

TEST_F(AnnotationBoardTest, ClearRemovesEveryMark) {
    const auto stroke = annotation(msg::ANNOTATION_STROKE, "", {place(0, 0.1f, 0.1f), place(0, 0.2f, 0.1f)});
    std::set<std::uint32_t> shown;
    for (int i = 0; i < 3; ++i) {
        shown.insert(board_.handle(stroke, now_).shown.at(0).slot());
    }
    const auto wiped = board_.handle(annotation(msg::ANNOTATION_CLEAR, ""), now_);
    EXPECT_EQ(wiped.event.text, "desk:7 wipes all marks away");
    std::set<std::uint32_t> emptied;
    for (const msg::ShownAnnotation& one : wiped.shown) {
        EXPECT_EQ(one.what().kind(), msg::ANNOTATION_CLEAR);
        emptied.insert(one.slot());
    }
    EXPECT_EQ(emptied, shown);
    EXPECT_TRUE(board_.handle(annotation(msg::ANNOTATION_CLEAR, ""), now_).shown.empty());
    EXPECT_EQ(board_.handle(stroke, now_).event.text, "desk:7 draws on tongue");
}

}  // namespace
}  // namespace eti::app
